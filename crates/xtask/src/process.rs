//! Child processes: where they run, what they are told, and how their failure becomes ours.

use std::ffi::OsStr;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};

/// Why a chore stopped, and the exit status that says so.
#[derive(Debug)]
pub struct Failure {
    pub message: String,
    pub status: u8,
}

pub type Outcome = Result<(), Failure>;

impl Failure {
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), status: 1 }
    }
}

/// The workspace, from the checkout that is running: a shared target directory may hold another one's binary.
pub fn workspace() -> PathBuf {
    let manifest =
        std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
    let crate_dir = PathBuf::from(manifest);
    crate_dir.ancestors().nth(2).map_or_else(|| crate_dir.clone(), Path::to_owned)
}

/// `cargo` of the toolchain that started us, in the workspace.
pub fn cargo(arguments: &[&str]) -> Command {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(program);
    command.args(arguments).current_dir(workspace());
    give_runtime_dir(&mut command);
    command
}

/// Mesa warns on every start when `XDG_RUNTIME_DIR` is unset, as it is in containers.
fn give_runtime_dir(command: &mut Command) {
    if !cfg!(target_os = "linux") || std::env::var_os("XDG_RUNTIME_DIR").is_some() {
        return;
    }
    // Beside our own executable: a directory of this user, and gone after `cargo clean`.
    let Ok(executable) = std::env::current_exe() else { return };
    let directory = executable.with_file_name("xdg-runtime");
    if std::fs::create_dir_all(&directory).is_ok() {
        command.env("XDG_RUNTIME_DIR", directory);
    }
}

/// Chores that take no arguments say so instead of ignoring them.
pub fn takes_no_arguments(chore: &str, arguments: &[String]) -> Outcome {
    match arguments.first() {
        None => Ok(()),
        Some(first) => {
            Err(Failure { message: format!("{chore} takes no arguments, but got `{first}`"), status: 2 })
        }
    }
}

/// Shows the command, runs it on our terminal and waits for it.
pub fn run(command: &mut Command) -> Outcome {
    let line = shown(command);
    println!("$ {line}");
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(Failure { message: format!("`{line}` failed: {status}"), status: code(status) }),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            Err(Failure { message: format!("`{line}`: program not found; install it"), status: 127 })
        }
        Err(error) => Err(Failure::new(format!("`{line}` did not start: {error}"))),
    }
}

/// Whether the command can be started and succeeds; shows nothing.
pub fn works(command: &mut Command) -> bool {
    let quiet = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    quiet.status().is_ok_and(|status| status.success())
}

fn shown(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_stem().unwrap_or(command.get_program());
    let words: Vec<_> =
        std::iter::once(program).chain(command.get_args()).map(OsStr::to_string_lossy).collect();
    words.join(" ")
}

/// A child that was killed by a signal has no status of its own.
fn code(status: ExitStatus) -> u8 {
    status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_workspace_is_where_its_manifest_lists_members() {
        let manifest = std::fs::read_to_string(workspace().join("Cargo.toml")).unwrap();
        assert!(manifest.contains("members = ["));
    }

    #[test]
    fn the_status_of_the_child_is_handed_on() {
        assert!(run(cargo(&["--version"]).stdout(Stdio::null())).is_ok());
        // Cargo documents 101 for its own errors.
        let failure = run(cargo(&["no-such-command"]).stderr(Stdio::null())).unwrap_err();
        assert_eq!(failure.status, 101);
    }

    #[test]
    fn a_missing_program_is_named() {
        let failure = run(&mut Command::new("no-such-program")).unwrap_err();
        assert_eq!(failure.status, 127);
        assert!(failure.message.contains("no-such-program"), "{}", failure.message);
        assert!(!works(&mut Command::new("no-such-program")));
    }
}
