//! `cargo xtask demo`: pictures of a translucent creature, from a fresh checkout.

use crate::driver;
use crate::process::{Failure, Outcome, cargo, run as run_command, takes_no_arguments, workspace};

struct Picture {
    what: &'static str,
    file: &'static str,
    /// What follows `translume`; `-o FILE` is added.
    arguments: &'static str,
}

const PICTURES: [Picture; 2] = [
    Picture {
        what: "a still, 768 × 768",
        file: "out/creature.png",
        arguments: "render creature --medium jade --size 768",
    },
    Picture {
        what: "a morph of 48 frames, 384 × 384 (animated PNG: a browser plays it)",
        file: "out/creature-morph.png",
        arguments: "render creature --medium jade --size 384 --atlas 256 --shadow 1024 --frames 48",
    },
];

pub fn run(arguments: &[String]) -> Outcome {
    takes_no_arguments("demo", arguments)?;
    driver::ensure()?;
    run_command(&mut cargo(&["build", "--release", "-p", "translume-demo"]))?;

    let directory = workspace().join("out");
    std::fs::create_dir_all(&directory)
        .map_err(|error| Failure::new(format!("{} cannot be made: {error}", directory.display())))?;
    for picture in &PICTURES {
        run_command(&mut cargo(&words(picture)))?;
    }

    println!();
    for picture in &PICTURES {
        println!("{}  {}", workspace().join(picture.file).display(), picture.what);
    }
    println!("More: cargo run --release -p translume-demo -- --help");
    Ok(())
}

/// `cargo run` knows where the binary lies, whatever the target directory is.
fn words(picture: &Picture) -> Vec<&str> {
    let mut words = vec!["run", "--release", "--quiet", "-p", "translume-demo", "--"];
    words.extend(picture.arguments.split_whitespace());
    words.extend(["-o", picture.file]);
    words
}
