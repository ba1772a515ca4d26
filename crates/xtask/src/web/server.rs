//! The files of one folder by HTTP/1.1 (RFC 9112), to this machine alone.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::process::Failure;

/// A browser opens connections that it never uses.
const PATIENCE: Duration = Duration::from_secs(10);
/// Of what is sent to us: a picture has 2.4 MB.
const LARGEST: u64 = 1 << 26;

pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    folder: PathBuf,
}

/// What a page has to say.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// What it was posted to, without the slash before it.
    pub to: String,
    /// What is after the question mark, decoded.
    pub fields: Vec<(String, String)>,
    pub body: Vec<u8>,
}

impl Server {
    /// Port 0 is any that is free.
    pub fn new(port: u16, folder: PathBuf) -> Result<Self, Failure> {
        let fail = |error| Failure::new(format!("port {port}: {error}; `--port` takes another"));
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(fail)?;
        let address = listener.local_addr().map_err(fail)?;
        Ok(Self { listener, address, folder })
    }

    pub fn address(&self, name: &str) -> String {
        format!("http://{}/{name}", self.address)
    }

    /// For ever.
    pub fn serve(&self, hear: &(dyn Fn(Message) + Sync)) {
        std::thread::scope(|scope| {
            for stream in self.listener.incoming().flatten() {
                // A browser that hangs up needs no answer.
                scope.spawn(move || answer(&stream, &self.folder, hear).is_ok());
            }
        });
    }
}

fn answer(stream: &TcpStream, folder: &Path, hear: &(dyn Fn(Message) + Sync)) -> std::io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    let mut reader = BufReader::new(stream);
    let mut line = String::new();
    reader.by_ref().take(8192).read_line(&mut line)?;
    let mut words = line.split_whitespace();
    let (method, target) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
    let mut length = 0;
    loop {
        let mut header = String::new();
        if reader.by_ref().take(8192).read_line(&mut header)? == 0 || header.trim().is_empty() {
            break;
        }
        if let Some((name, value)) = header.split_once(':')
            && name.eq_ignore_ascii_case("content-length")
        {
            length = value.trim().parse().unwrap_or(0);
        }
    }
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    let name = path.trim_start_matches('/');
    match method {
        "GET" => match file(folder, name) {
            Some(bytes) => send(stream, "200 OK", kind(name), &bytes),
            None => send(stream, "404 Not Found", "text/plain", b"there is no such page"),
        },
        "POST" if length <= LARGEST => {
            let mut body = Vec::new();
            reader.take(length).read_to_end(&mut body)?;
            hear(Message { to: name.to_owned(), fields: fields(query), body });
            send(stream, "200 OK", "text/plain", b"")
        }
        "POST" => send(stream, "413 Content Too Large", "text/plain", b""),
        _ => send(stream, "405 Method Not Allowed", "text/plain", b""),
    }
}

fn send(mut stream: &TcpStream, status: &str, kind: &str, body: &[u8]) -> std::io::Result<()> {
    let length = body.len();
    // What was built anew is to be seen at once.
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n"
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(body)
}

/// A file of the folder itself; nothing else can be named.
fn file(folder: &Path, name: &str) -> Option<Vec<u8>> {
    let name = if name.is_empty() { "index.html" } else { name };
    let is_plain = name.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"._-".contains(&byte));
    if is_plain && !name.starts_with('.') { std::fs::read(folder.join(name)).ok() } else { None }
}

fn kind(name: &str) -> &'static str {
    match name.rsplit_once('.') {
        Some((_, "js")) => "text/javascript",
        Some((_, "wasm")) => "application/wasm",
        _ => "text/html; charset=utf-8",
    }
}

/// `a=1&b=two+words` (URL standard, application/x-www-form-urlencoded).
fn fields(query: &str) -> Vec<(String, String)> {
    let pairs = query.split('&').filter_map(|pair| pair.split_once('='));
    pairs.map(|(name, value)| (decoded(name), decoded(value))).collect()
}

fn decoded(text: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'+' => b' ',
            b'%' => {
                let digits: Vec<_> = rest.by_ref().take(2).collect();
                let number =
                    std::str::from_utf8(&digits).ok().and_then(|digits| u8::from_str_radix(digits, 16).ok());
                number.unwrap_or(b'?')
            }
            _ => byte,
        });
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;
    use std::sync::mpsc::channel;

    /// What the server answers, and what it heard.
    fn asked(request: &str) -> (String, Option<Message>) {
        let folder = std::env::temp_dir().join(format!("translume-web-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("a.js"), "let a;").unwrap();
        let server = Server::new(0, folder).unwrap();
        assert!(server.address("a.js").starts_with("http://127.0.0.1:"));
        let mut stream = TcpStream::connect(server.address).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let (sender, receiver) = channel();
        let sender = Mutex::new(sender);
        let (end, _) = server.listener.accept().unwrap();
        answer(&end, &server.folder, &|message| sender.lock().unwrap().send(message).unwrap()).unwrap();
        drop(end);
        let mut reply = String::new();
        stream.read_to_string(&mut reply).unwrap();
        (reply, receiver.try_recv().ok())
    }

    #[test]
    fn files_of_the_folder_are_served_and_no_others() {
        let (reply, _) = asked("GET /a.js?x HTTP/1.1\r\nHost: here\r\n\r\n");
        assert!(reply.starts_with("HTTP/1.1 200 OK\r\nContent-Type: text/javascript\r\n"), "{reply}");
        assert!(reply.ends_with("\r\n\r\nlet a;"), "{reply}");
        for name in ["b.js", "../Cargo.toml", "/etc/passwd", "%2e%2e/a.js", ".profile"] {
            let (reply, _) = asked(&format!("GET /{name} HTTP/1.1\r\n\r\n"));
            assert!(reply.starts_with("HTTP/1.1 404"), "{name}: {reply}");
        }
    }

    #[test]
    fn what_is_posted_is_heard_whole() {
        let (reply, message) =
            asked("POST /drawn?adapter=a%20b+c&ms=4.5 HTTP/1.1\r\ncontent-length: 3\r\n\r\nabcd");
        assert!(reply.starts_with("HTTP/1.1 200"), "{reply}");
        let fields = [("adapter", "a b c"), ("ms", "4.5")].map(|(a, b)| (a.to_owned(), b.to_owned()));
        let expected = Message { to: "drawn".to_owned(), fields: fields.to_vec(), body: b"abc".to_vec() };
        assert_eq!(message, Some(expected));
        let (reply, message) = asked("POST /drawn HTTP/1.1\r\nContent-Length: 999999999\r\n\r\n");
        assert!(reply.starts_with("HTTP/1.1 413") && message.is_none(), "{reply}");
        assert!(asked("PUT /a.js HTTP/1.1\r\n\r\n").0.starts_with("HTTP/1.1 405"));
    }
}
