//! The bytes behind a glTF document: the chunk of a GLB, data URIs and files beside the document.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use gltf::buffer::Source;

use super::{LoadError, read_file};

/// The bytes of one buffer. Buffers that name the same file share it.
pub(super) struct Buffer {
    file: Rc<Vec<u8>>,
    length: usize,
}

impl Buffer {
    pub(super) fn bytes(&self) -> &[u8] {
        self.file.get(..self.length).unwrap_or_default()
    }
}

/// Loads every buffer, each cut to its stated length, and says how many bytes of other files were read.
pub(super) fn load(
    path: &Path,
    document: &gltf::Document,
    blob: Option<Vec<u8>>,
) -> Result<(Vec<Buffer>, usize), LoadError> {
    let mut loader = Loader { path, blob, files: HashMap::new(), read: 0 };
    let buffers = document.buffers().map(|buffer| loader.load(&buffer)).collect::<Result<_, _>>()?;
    Ok((buffers, loader.read))
}

struct Loader<'a> {
    path: &'a Path,
    blob: Option<Vec<u8>>,
    files: HashMap<PathBuf, Rc<Vec<u8>>>,
    read: usize,
}

impl Loader<'_> {
    fn load(&mut self, buffer: &gltf::Buffer<'_>) -> Result<Buffer, LoadError> {
        let path = self.path;
        let error = |reason: String| LoadError::Gltf {
            file: path.display().to_string(),
            element: format!("buffers[{}]", buffer.index()),
            reason,
        };
        let length = buffer.length();
        let file = match buffer.source() {
            Source::Bin => Rc::new(self.blob.take().ok_or_else(|| error("there is no binary chunk".into()))?),
            Source::Uri(uri) => match uri.strip_prefix("data:") {
                Some(data) => Rc::new(decode_data_uri(data).map_err(error)?),
                None => self.file(&beside(path, uri).map_err(error)?)?,
            },
        };
        if file.len() < length {
            let there = file.len();
            return Err(error(format!("it should hold {length} bytes, but there are {there}")));
        }
        Ok(Buffer { file, length })
    }

    fn file(&mut self, path: &Path) -> Result<Rc<Vec<u8>>, LoadError> {
        // One file has many names: a.bin, ./a.bin. Where it has none, reading it says so.
        let name = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        if let Some(file) = self.files.get(&name) {
            return Ok(Rc::clone(file));
        }
        let file = Rc::new(read_file(path)?);
        self.read += file.len();
        self.files.insert(name, Rc::clone(&file));
        Ok(file)
    }
}

/// The file that a relative reference (RFC 3986) names, seen from the document.
fn beside(path: &Path, uri: &str) -> Result<PathBuf, String> {
    let relative = percent_decode(uri).ok_or_else(|| format!("its URI {uri:?} is malformed"))?;
    if relative.contains(':') || relative.starts_with(['/', '\\']) {
        return Err(format!("its URI {uri:?} is not relative to the document"));
    }
    Ok(path.parent().unwrap_or(Path::new("")).join(relative))
}

fn percent_decode(uri: &str) -> Option<String> {
    let mut parts = uri.split('%');
    let mut bytes = parts.next()?.as_bytes().to_vec();
    for part in parts {
        bytes.push(u8::from_str_radix(part.get(..2)?, 16).ok()?);
        bytes.extend_from_slice(&part.as_bytes()[2..]);
    }
    String::from_utf8(bytes).ok()
}

/// The part of a data URI after `data:` (RFC 2397).
fn decode_data_uri(data: &str) -> Result<Vec<u8>, String> {
    let (media_type, text) = data.split_once(',').ok_or("its data URI has no comma")?;
    if !media_type.ends_with(";base64") {
        return Err("its data URI is not in base64".into());
    }
    decode_base64(text.as_bytes()).ok_or_else(|| "its data URI is malformed base64".into())
}

/// Base 64 of RFC 4648, section 4; padding may be missing.
fn decode_base64(text: &[u8]) -> Option<Vec<u8>> {
    let padding = text.iter().rev().take_while(|&&c| c == b'=').count();
    let digits = &text[..text.len() - padding];
    if padding > 2 || digits.len() % 4 == 1 {
        return None;
    }
    let mut bytes = Vec::with_capacity(digits.len() / 4 * 3 + 2);
    for group in digits.chunks(4) {
        let mut bits = 0_u32;
        for &digit in group {
            bits = bits << 6 | base64_digit(digit)?;
        }
        bits <<= 6 * (4 - group.len());
        bytes.extend_from_slice(&bits.to_be_bytes()[1..group.len()]);
    }
    Some(bytes)
}

fn base64_digit(c: u8) -> Option<u32> {
    let value = match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => return None,
    };
    Some(u32::from(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_matches_the_vectors_of_rfc_4648() {
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg", "foob"),
            ("Zm9vYmFy", "foobar"),
        ] {
            assert_eq!(decode_base64(text.as_bytes()).unwrap(), bytes.as_bytes(), "{text}");
        }
        assert_eq!(decode_base64(b"++//").unwrap(), [0xfb, 0xef, 0xff]);
    }

    #[test]
    fn malformed_base64_is_refused() {
        for text in ["Z", "Zg===", "Z!==", "Zm9vY", "Zg=g"] {
            assert_eq!(decode_base64(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn uris_stay_relative() {
        let model = Path::new("models/fox.gltf");
        assert_eq!(beside(model, "fox%20data.bin").unwrap(), Path::new("models/fox data.bin"));
        for uri in ["/etc/passwd", "http://example.com/a.bin", "file:a.bin", "%2Fa.bin", "a%2"] {
            beside(model, uri).unwrap_err();
        }
    }
}
