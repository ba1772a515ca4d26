//! Installing a Vulkan driver where we know how, and saying how everywhere else.

use std::io::IsTerminal;
use std::path::Path;
use std::process::Command;

use crate::process::{Failure, Outcome, run, works};

/// Set to 1, nothing is installed: we say what is missing and go on.
pub const NO_INSTALL: &str = "TRANSLUME_NO_INSTALL=1";

const PACKAGES: [&str; 2] = ["libvulkan1", "mesa-vulkan-drivers"];

pub fn forbidden() -> bool {
    std::env::var_os("TRANSLUME_NO_INSTALL").is_some_and(|value| !value.is_empty() && value != "0")
}

/// Installs the Vulkan loader and Mesa's drivers, lavapipe among them. `root` holds `etc/os-release`.
pub fn vulkan(root: &Path) -> Outcome {
    let os_release = std::fs::read_to_string(root.join("etc/os-release")).unwrap_or_default();
    let family = Family::of(&os_release);
    if forbidden() {
        println!("{NO_INSTALL}: going on without. To install it: {}", family.advice());
        return Ok(());
    }
    match (family, Authority::ours()) {
        (Family::Debian, Some(authority)) => apt(authority),
        _ => Err(Failure::new(format!(
            "install a Vulkan driver and try again ({NO_INSTALL} goes on without it): {}",
            family.advice()
        ))),
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Family {
    Debian,
    Fedora,
    Arch,
    Alpine,
    Suse,
    Unknown,
}

impl Family {
    /// From the text of `/etc/os-release`: what the system is (`ID`), then what it resembles (`ID_LIKE`).
    fn of(os_release: &str) -> Self {
        let words = ["ID", "ID_LIKE"].into_iter().flat_map(|key| value(os_release, key).split_whitespace());
        words.map(Self::named).find(|family| *family != Self::Unknown).unwrap_or(Self::Unknown)
    }

    fn named(id: &str) -> Self {
        match id {
            "debian" | "ubuntu" => Self::Debian,
            "fedora" | "rhel" | "centos" => Self::Fedora,
            "arch" => Self::Arch,
            "alpine" => Self::Alpine,
            "suse" | "opensuse" => Self::Suse,
            _ => Self::Unknown,
        }
    }

    fn advice(self) -> &'static str {
        match self {
            Self::Debian => "sudo apt-get install libvulkan1 mesa-vulkan-drivers",
            Self::Fedora => "sudo dnf install vulkan-loader mesa-vulkan-drivers",
            Self::Arch => "sudo pacman -S --needed vulkan-icd-loader vulkan-swrast",
            Self::Alpine => "sudo apk add vulkan-loader mesa-vulkan-swrast",
            Self::Suse => "sudo zypper install libvulkan1 libvulkan_lvp",
            Self::Unknown => "the Vulkan loader and Mesa's lavapipe, from your distribution",
        }
    }
}

/// The value of `KEY=value` or `KEY="value"`; empty when absent.
fn value<'a>(os_release: &'a str, key: &str) -> &'a str {
    let of_line = |line: &'a str| line.trim().strip_prefix(key)?.strip_prefix('=');
    os_release.lines().find_map(of_line).unwrap_or_default().trim_matches(['"', '\''])
}

/// How we may become root.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Authority {
    Root,
    SudoSilent,
    SudoAsks,
}

impl Authority {
    fn ours() -> Option<Self> {
        let uid = Command::new("id").arg("-u").output().map(|output| output.stdout).unwrap_or_default();
        let is_root = uid.trim_ascii() == b"0";
        let has_sudo = !is_root && works(Command::new("sudo").arg("-V"));
        let silent = has_sudo && works(Command::new("sudo").args(["-n", "true"]));
        Self::choose(is_root, silent, has_sudo && std::io::stdin().is_terminal())
    }

    fn choose(is_root: bool, sudo_is_silent: bool, can_ask: bool) -> Option<Self> {
        match (is_root, sudo_is_silent, can_ask) {
            (true, ..) => Some(Self::Root),
            (_, true, _) => Some(Self::SudoSilent),
            (.., true) => Some(Self::SudoAsks),
            _ => None,
        }
    }

    /// `apt-get` as root. sudo clears the environment, hence `env`.
    fn apt_get(self, arguments: &[&str]) -> Command {
        let prefix: &[&str] = match self {
            Self::Root => &[],
            Self::SudoSilent => &["sudo", "-n"],
            Self::SudoAsks => &["sudo"],
        };
        let fixed = ["env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "-o", "DPkg::Lock::Timeout=120"];
        let mut words = prefix.iter().chain(&fixed).chain(arguments);
        let mut command = Command::new(words.next().unwrap_or(&"env"));
        command.args(words);
        command
    }
}

fn apt(authority: Authority) -> Outcome {
    let install = [&["install", "-y", "--no-install-recommends"], &PACKAGES[..]].concat();
    twice(|| {
        // A broken source of the user's fails the update although ours are up to date: let the installation tell.
        let _ = run(&mut authority.apt_get(&["update"]));
        run(&mut authority.apt_get(&install))
    })
}

/// Mirrors fail now and then.
fn twice(mut attempt: impl FnMut() -> Outcome) -> Outcome {
    attempt().or_else(|failure| {
        println!("{}; once more", failure.message);
        attempt()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_family_is_read_from_os_release() {
        let debian = "PRETTY_NAME=\"Debian GNU/Linux 12 (bookworm)\"\nVERSION_ID=\"12\"\nID=debian\n";
        let ubuntu = "NAME=\"Ubuntu\"\nID=ubuntu\nID_LIKE=debian\n";
        let mint = "ID=linuxmint\nID_LIKE=\"ubuntu debian\"\n";
        let rocky = "NAME=\"Rocky Linux\"\nID=\"rocky\"\nID_LIKE=\"rhel centos fedora\"\n";
        let tumbleweed = "ID=\"opensuse-tumbleweed\"\nID_LIKE=\"opensuse suse\"\n";
        let expected = [
            (debian, Family::Debian),
            (ubuntu, Family::Debian),
            (mint, Family::Debian),
            (rocky, Family::Fedora),
            ("ID=fedora\n", Family::Fedora),
            ("ID='arch'\n", Family::Arch),
            ("ID=alpine\n", Family::Alpine),
            (tumbleweed, Family::Suse),
            ("ID=nixos\n", Family::Unknown),
            ("", Family::Unknown),
        ];
        for (text, family) in expected {
            assert_eq!(Family::of(text), family, "{text}");
        }
    }

    #[test]
    fn a_key_that_only_resembles_id_is_not_read() {
        for text in ["VERSION_ID=debian", "IDENTITY=debian", "#ID=debian", "NAME=debian"] {
            assert_eq!(Family::of(text), Family::Unknown, "{text}");
        }
    }

    #[test]
    fn root_comes_before_sudo_and_a_question_comes_last() {
        assert_eq!(Authority::choose(true, true, true), Some(Authority::Root));
        assert_eq!(Authority::choose(false, true, true), Some(Authority::SudoSilent));
        assert_eq!(Authority::choose(false, false, true), Some(Authority::SudoAsks));
        assert_eq!(Authority::choose(false, false, false), None);
    }

    #[test]
    fn the_advice_for_debian_names_what_we_install() {
        assert!(Family::Debian.advice().ends_with(&PACKAGES.join(" ")));
    }

    #[test]
    fn a_failure_is_retried_once() {
        for (failures, succeeds) in [(0, true), (1, true), (2, false)] {
            let mut left = failures;
            let outcome = twice(|| match left {
                0 => Ok(()),
                _ => {
                    left -= 1;
                    Err(Failure::new("mirror"))
                }
            });
            assert_eq!(outcome.is_ok(), succeeds, "{failures} failures");
        }
    }
}
