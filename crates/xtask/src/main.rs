//! Project chores: `cargo xtask demo | web | test | ci | bench | package`. Standard library only, so that it builds in seconds.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a command-line tool talks to its terminal")]

mod ci;
mod demo;
mod driver;
mod install;
mod package;
mod process;
mod test;
mod web;

use std::process::ExitCode;

use process::{Failure, Outcome};

struct Chore {
    name: &'static str,
    summary: &'static str,
    run: fn(&[String]) -> Outcome,
}

const CHORES: [Chore; 7] = [
    Chore {
        name: "demo",
        summary: "render a still and an animation of a jade creature into out/",
        run: demo::run,
    },
    Chore {
        name: "web",
        summary: "build pages for a browser and serve them; --test compares a picture with a browser's",
        run: web::run,
    },
    Chore {
        name: "test",
        summary: "cargo test --workspace; further arguments go to cargo test",
        run: test::test,
    },
    Chore {
        name: "ci",
        summary: "what CI runs: fmt, clippy, doc, deny, typos, test, with times",
        run: ci::run_all,
    },
    Chore {
        name: "bench",
        summary: "Criterion runs of translume-benches; further arguments go to cargo bench",
        run: test::bench,
    },
    Chore {
        name: "package",
        summary: "pack every published crate, and build and run a project from the packages alone",
        run: package::package,
    },
    Chore { name: "help", summary: "this text", run: |_| help() },
];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match dispatch(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("xtask: {}", failure.message);
            ExitCode::from(failure.status)
        }
    }
}

fn dispatch(arguments: &[String]) -> Outcome {
    let (name, rest) = match arguments.split_first() {
        None => ("", arguments),
        Some((name, _)) if name == "--help" || name == "-h" => ("help", arguments),
        Some((name, rest)) => (name.as_str(), rest),
    };
    match CHORES.iter().find(|chore| chore.name == name) {
        Some(chore) => (chore.run)(rest),
        None => Err(Failure { message: complaint(name), status: 2 }),
    }
}

fn complaint(name: &str) -> String {
    let line = if name.is_empty() { "no command given".into() } else { format!("unknown command `{name}`") };
    format!("{line}\n\n{}", help_text())
}

fn help() -> Outcome {
    print!("{}", help_text());
    Ok(())
}

fn help_text() -> String {
    let lines: String =
        CHORES.iter().map(|chore| format!("  {:<8} {}\n", chore.name, chore.summary)).collect();
    format!(
        "cargo xtask COMMAND\n\n{lines}\n\
         demo, test, ci and bench need a graphics driver. On Debian and Ubuntu a missing Vulkan driver is\n\
         installed with apt-get; TRANSLUME_NO_INSTALL=1 only says what is missing and goes on without it.\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(line: &str) -> Vec<String> {
        line.split_whitespace().map(str::to_owned).collect()
    }

    #[test]
    fn help_lists_every_command() {
        let text = help_text();
        for chore in &CHORES {
            assert!(text.contains(&format!("  {:<8} {}", chore.name, chore.summary)), "{}", chore.name);
        }
        assert!(!text.contains("  deploy"), "the check above must be able to miss a command");
    }

    #[test]
    fn an_unknown_command_gets_one_line_and_the_help() {
        let failure = dispatch(&words("deploy --now")).unwrap_err();
        assert_eq!(failure.status, 2);
        assert!(failure.message.starts_with("unknown command `deploy`\n\n"));
        assert!(failure.message.ends_with(&help_text()));
        assert_eq!(dispatch(&[]).unwrap_err().status, 2);
    }

    #[test]
    fn help_succeeds_under_each_of_its_names() {
        for line in ["help", "--help", "-h"] {
            assert!(dispatch(&words(line)).is_ok(), "{line}");
        }
    }
}
