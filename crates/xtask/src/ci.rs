//! `cargo xtask ci`: every check a change must pass. A failed step does not keep the later ones from running.

use std::process::Command;
use std::time::Instant;

use crate::process::{Outcome, cargo, run, takes_no_arguments, works};
use crate::test;

struct Step {
    name: &'static str,
    /// Answers with success where the tool is installed.
    probe: fn() -> Command,
    check: fn() -> Outcome,
}

const STEPS: [Step; 6] = [
    Step {
        name: "fmt",
        probe: || cargo(&["fmt", "--version"]),
        check: || run(&mut cargo(&["fmt", "--all", "--check"])),
    },
    Step {
        name: "clippy",
        probe: || cargo(&["clippy", "--version"]),
        check: || run(&mut cargo(&["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])),
    },
    Step {
        name: "doc",
        probe: || cargo(&["--version"]),
        check: || run(cargo(&["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings")),
    },
    Step {
        name: "deny",
        probe: || cargo(&["deny", "--version"]),
        check: || run(&mut cargo(&["deny", "check", "licenses", "bans", "sources"])),
    },
    Step { name: "typos", probe: || typos(&["--version"]), check: || run(&mut typos(&[])) },
    Step { name: "test", probe: || cargo(&["--version"]), check: || test::test(&[]) },
];

enum Verdict {
    Done(Outcome),
    Skipped,
}

pub fn run_all(arguments: &[String]) -> Outcome {
    takes_no_arguments("ci", arguments)?;
    let mut table = String::new();
    let mut outcome = Ok(());
    for step in &STEPS {
        println!("\n== {} ==", step.name);
        let start = Instant::now();
        let verdict = take(step);
        let seconds = start.elapsed().as_secs_f64();
        let word = word(&verdict);
        println!("== {}: {word}, {seconds:.0} s ==", step.name);
        table += &format!("{:<7} {seconds:>6.0} s  {word}\n", step.name);
        if let Verdict::Done(result) = verdict {
            outcome = outcome.and(result);
        }
    }
    println!("\n{table}");
    outcome
}

fn take(step: &Step) -> Verdict {
    if works(&mut (step.probe)()) { Verdict::Done((step.check)()) } else { Verdict::Skipped }
}

fn word(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Done(Ok(())) => "ok",
        Verdict::Done(Err(_)) => "FAILED",
        Verdict::Skipped => "skipped: not installed",
    }
}

fn typos(arguments: &[&str]) -> Command {
    let mut command = Command::new("typos");
    command.args(arguments).current_dir(crate::process::workspace());
    command
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::process::Failure;

    fn step(probe: fn() -> Command, check: fn() -> Outcome) -> &'static str {
        word(&take(&Step { name: "step", probe, check }))
    }

    #[test]
    fn a_step_is_taken_when_its_tool_is_there() {
        let present = || cargo(&["--version"]);
        assert_eq!(step(present, || Ok(())), "ok");
        assert_eq!(step(present, || Err(Failure::new("broken"))), "FAILED");
        assert_eq!(step(|| Command::new("no-such-tool"), || Ok(())), "skipped: not installed");
    }
}
