//! A folder to work in, and the command.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub struct Desk(tempfile::TempDir);

impl Desk {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn file(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        std::fs::write(self.path(name), content).unwrap();
        self.path(name).to_str().unwrap().to_owned()
    }

    /// Names of all files that start with `stem`.
    pub fn files(&self, stem: &str) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .filter(|name| name.starts_with(stem))
            .collect()
    }
}

pub fn translume(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_translume")).args(arguments).env("RUST_LOG", "off").output().unwrap()
}

pub fn render(desk: &Desk, arguments: &[&str]) -> Output {
    let output = desk.path("out.png");
    let mut all = vec!["render"];
    all.extend_from_slice(arguments);
    all.extend_from_slice(&["-o", output.to_str().unwrap()]);
    translume(&all)
}

/// Exit status 2, one line that holds every word, and no picture.
pub fn check_refusal(desk: &Desk, output: &Output, words: &[&str]) -> Result<(), String> {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    // Mesa complains about a missing XDG_RUNTIME_DIR in lines of its own.
    let lines: Vec<_> = text.lines().filter(|line| line.starts_with("translume: ")).collect();
    if output.status.code() != Some(2) {
        return Err(format!("exit status {:?}: {text}", output.status));
    }
    if text.contains("panicked") || lines.len() != 1 {
        return Err(format!("not one clear line: {text}"));
    }
    if let Some(word) = words.iter().find(|word| !lines[0].contains(**word)) {
        return Err(format!("\"{word}\" is missing from: {}", lines[0]));
    }
    if desk.files("out").is_empty() && desk.files(".tmp").is_empty() {
        Ok(())
    } else {
        Err("a picture was left behind".to_owned())
    }
}

pub fn refused(desk: &Desk, arguments: &[&str], words: &[&str]) {
    check_refusal(desk, &render(desk, arguments), words)
        .unwrap_or_else(|problem| panic!("{arguments:?}: {problem}"));
}

pub fn read_exr(path: &Path) -> (usize, Vec<[f32; 3]>) {
    let image = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size, _| (size.width(), vec![[0.0_f32; 3]; size.area()]),
        |(width, pixels), at, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels[at.y() * *width + at.x()] = [r, g, b];
        },
    )
    .unwrap();
    image.layer_data.channel_data.pixels
}
