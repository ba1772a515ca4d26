//! `cargo xtask web`: pages with Translume compiled to WebAssembly, served on loopback; `--test` compares a browser's picture with ours.

mod browser;
mod compare;
mod server;

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::process::{Failure, Outcome, cargo, run as run_command, workspace};
use server::Server;

const TARGET: &str = "wasm32-unknown-unknown";
const PORT: u16 = 8080;

/// A program and the page that starts it.
struct Page {
    package: &'static str,
    program: &'static str,
    html: &'static str,
}

const PAGES: [Page; 2] = [
    Page { package: "translume-demo", program: "translume", html: "crates/translume-demo/index.html" },
    Page { package: "translume-web", program: "minimal-web", html: "examples/web/minimal.html" },
];

pub fn run(arguments: &[String]) -> Outcome {
    match arguments {
        [] => serve(PORT),
        [word, port] if word == "--port" => match port.parse() {
            Ok(port) => serve(port),
            Err(_) => Err(usage(&format!("`{port}` is no port"))),
        },
        [word] if word == "--test" => compare::run(&build()?),
        [word, ..] => Err(usage(&format!("unknown argument `{word}`"))),
    }
}

fn usage(problem: &str) -> Failure {
    Failure { message: format!("web: {problem}; use: cargo xtask web [--port NUMBER | --test]"), status: 2 }
}

fn serve(port: u16) -> Outcome {
    let server = Server::new(port, build()?)?;
    for page in &PAGES {
        println!("{}", server.address(&page.name()));
    }
    println!("Open it in a browser with WebGPU; Ctrl-C ends.");
    server.serve(&|_| {});
    Ok(())
}

impl Page {
    fn name(&self) -> String {
        Path::new(self.html).file_name().unwrap_or_default().to_string_lossy().into_owned()
    }
}

/// Builds all pages; the folder they lie in.
fn build() -> Result<PathBuf, Failure> {
    let version = bindgen_version()?;
    let missing: Vec<_> = [missing_target(), missing_bindgen(&version)].into_iter().flatten().collect();
    if !missing.is_empty() {
        return Err(Failure::new(missing.join("\n")));
    }
    let (target, pages) = (workspace().join("target"), workspace().join("target/web"));
    let fail =
        |error: std::io::Error| Failure::new(format!("{} cannot be written: {error}", pages.display()));
    std::fs::create_dir_all(&pages).map_err(fail)?;
    for page in &PAGES {
        let words = ["build", "--release", "--target", TARGET, "-p", page.package, "--bin", page.program];
        run_command(cargo(&words).arg("--target-dir").arg(&target))?;
        let program = target.join(TARGET).join("release").join(page.program).with_extension("wasm");
        run_command(
            bindgen().args(["--target", "web", "--no-typescript", "--out-dir"]).args([&pages, &program]),
        )?;
        std::fs::copy(workspace().join(page.html), pages.join(page.name())).map_err(fail)?;
        let size = std::fs::metadata(pages.join(format!("{}_bg.wasm", page.program))).map_err(fail)?.len();
        println!("{}: {:.1} MB of WebAssembly", page.program, size as f64 / 1e6);
    }
    Ok(pages)
}

fn bindgen() -> Command {
    Command::new("wasm-bindgen")
}

/// Says how the standard library comes, where it is not there.
fn missing_target() -> Option<String> {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(rustc).args(["--print", "target-libdir", "--target", TARGET]).output().ok()?;
    let folder = PathBuf::from(String::from_utf8_lossy(&output.stdout).trim());
    (!folder.is_dir()).then(|| {
        format!("the standard library for {TARGET} is missing; `rustup target add {TARGET}` brings it")
    })
}

fn missing_bindgen(version: &str) -> Option<String> {
    let remedy = format!("`cargo install wasm-bindgen-cli --version {version}` brings it");
    let Ok(output) = bindgen().arg("--version").output() else {
        return Some(format!("the program wasm-bindgen is missing; {remedy}"));
    };
    let found = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    (found.split_whitespace().nth(1) != Some(version))
        .then(|| format!("{found} is installed, but the library is {version}; {remedy}"))
}

/// The version of the library, which that of the program must equal.
fn bindgen_version() -> Result<String, Failure> {
    let path = workspace().join("Cargo.lock");
    let lock = std::fs::read_to_string(&path)
        .map_err(|error| Failure::new(format!("{} cannot be read: {error}", path.display())))?;
    locked(&lock, "wasm-bindgen")
        .ok_or_else(|| Failure::new(format!("{} names no wasm-bindgen", path.display())))
}

/// The version of a package in a lock file.
fn locked(lock: &str, package: &str) -> Option<String> {
    let name = format!("name = \"{package}\"");
    let (_, after) = lock.split_once(&format!("{name}\n"))?;
    let version = after.lines().next()?.strip_prefix("version = \"")?.strip_suffix('"')?;
    Some(version.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_locked_version_is_that_of_the_package_alone() {
        let lock = "[[package]]\nname = \"wasm-bindgen-futures\"\nversion = \"0.4.1\"\n\n\
            [[package]]\nname = \"wasm-bindgen\"\nversion = \"0.2.9\"\n";
        assert_eq!(locked(lock, "wasm-bindgen").as_deref(), Some("0.2.9"));
        assert_eq!(locked(lock, "bindgen"), None);
        assert!(bindgen_version().unwrap().starts_with("0.2."));
    }

    #[test]
    fn every_page_starts_its_program() {
        for page in &PAGES {
            let html = std::fs::read_to_string(workspace().join(page.html)).unwrap();
            assert!(html.contains(&format!("./{}.js", page.program)), "{}", page.html);
        }
    }

    #[test]
    fn what_is_not_understood_is_named() {
        for words in [&["--open"][..], &["--port", "http"], &["--test", "now"]] {
            let words: Vec<_> = words.iter().map(|word| (*word).to_owned()).collect();
            let failure = run(&words).unwrap_err();
            assert_eq!(failure.status, 2);
            assert!(failure.message.contains(words.last().unwrap()), "{}", failure.message);
        }
    }
}
