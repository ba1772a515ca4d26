//! `cargo xtask package`: packs every crate that is published, and builds and runs a project that knows nothing but the packages.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::driver;
use crate::process::{Failure, Outcome, cargo, run, takes_no_arguments, workspace};

/// Before whatever depends on them.
const CRATES: [&str; 7] = [
    "translume-shaders",
    "translume-mesh",
    "translume-reference",
    "translume",
    "translume-twin",
    "translume-rivals",
    "translume-demo",
];
/// Of all of them.
const VERSION: &str = env!("CARGO_PKG_VERSION");

pub fn package(arguments: &[String]) -> Outcome {
    takes_no_arguments("package", arguments)?;
    driver::ensure()?;
    let packages = CRATES.iter().flat_map(|name| ["--package", name]);
    let words: Vec<&str> = ["package", "--no-verify", "--allow-dirty"].into_iter().chain(packages).collect();
    run(&mut cargo(&words))?;

    let folder = workspace().join("target").join("package").join("scratch");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(folder.join("src")).map_err(|error| failure(&folder, &error))?;
    for name in CRATES {
        let archive = workspace().join("target/package").join(format!("{name}-{VERSION}.crate"));
        run(Command::new("tar").arg("-xzf").arg(archive).current_dir(&folder))?;
    }
    // The tutorial is the program, and it must find all it needs in the packages.
    write(
        &folder.join("src/main.rs"),
        &fs::read(workspace().join("examples/minimal.rs")).unwrap_or_default(),
    )?;
    write(&folder.join("Cargo.toml"), manifest().as_bytes())?;
    write(&folder.join("Cargo.lock"), &fs::read(workspace().join("Cargo.lock")).unwrap_or_default())?;
    run(cargo(&["run"]).current_dir(&folder))?;
    println!("built from packages alone: {}", folder.join("out/exitance.png").display());
    Ok(())
}

fn manifest() -> String {
    let patches: String =
        CRATES.iter().map(|name| format!("{name} = {{ path = \"{name}-{VERSION}\" }}\n")).collect();
    format!(
        "[package]\nname = \"scratch\"\nedition = \"2024\"\n\n[workspace]\n\n[dependencies]\n\
         image = {{ version = \"0.25\", default-features = false, features = [\"png\"] }}\npollster = \"1\"\n\
         translume = \"{VERSION}\"\ntranslume-mesh = \"{VERSION}\"\ntranslume-demo = \"{VERSION}\"\n\n\
         [patch.crates-io]\n{patches}\n[profile.dev]\nopt-level = 1\n"
    )
}

fn write(path: &Path, content: &[u8]) -> Outcome {
    fs::write(path, content).map_err(|error| failure(path, &error))
}

fn failure(path: &Path, error: &std::io::Error) -> Failure {
    Failure::new(format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Crates of the workspace that may be published.
    fn published() -> Vec<String> {
        let folders = ["crates", "."].map(|place| fs::read_dir(workspace().join(place)).unwrap());
        let manifests = folders.into_iter().flatten().map(|entry| entry.unwrap().path().join("Cargo.toml"));
        let texts = manifests.filter_map(|path| fs::read_to_string(path).ok());
        let published = texts.filter(|text| !text.contains("publish = false"));
        let name = |text: String| {
            let line = text.lines().find_map(|line| line.strip_prefix("name = "));
            line.map(|name| name.trim_matches('"').to_owned())
        };
        published.filter_map(name).collect()
    }

    #[test]
    fn every_published_crate_is_packed() {
        let mut expected = published();
        expected.sort();
        let mut names = CRATES.to_vec();
        names.sort_unstable();
        assert_eq!(names, expected);
    }
}
