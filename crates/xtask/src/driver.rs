//! Is there a Vulkan driver that can work on this machine?
//!
//! wgpu needs the loader and one driver (ICD). A manifest alone proves little: distributions install those of Intel
//! and AMD on machines that have neither. What counts is a software driver, or a hardware driver and a device.
//! Search order: Khronos, "Architecture of the Vulkan Loader Interfaces", "Driver Discovery on Linux".

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::install;
use crate::process::{Failure, Outcome};

const LOADER: &str = "libvulkan.so.1";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Missing {
    Loader,
    Driver,
}

impl Missing {
    fn describe(self) -> &'static str {
        match self {
            Self::Loader => "the Vulkan loader (libvulkan.so.1)",
            Self::Driver => "a Vulkan driver: lavapipe, or one for a graphics card that is present",
        }
    }
}

/// Makes sure that wgpu will find an adapter, installing a driver where we know how.
pub fn ensure() -> Outcome {
    if !cfg!(target_os = "linux") {
        println!("Graphics driver: Metal and Direct3D 12 come with the system.");
        return Ok(());
    }
    let machine = Machine::this();
    let missing = survey(&machine).missing();
    if missing.is_empty() {
        return Ok(());
    }
    let list: Vec<_> = missing.iter().copied().map(Missing::describe).collect();
    println!("Missing: {}", list.join("; and "));
    if machine.driver_files.is_some() && missing == [Missing::Driver] && !install::forbidden() {
        let message =
            "VK_DRIVER_FILES or VK_ICD_FILENAMES names no driver that works here; unset or correct it";
        return Err(Failure::new(message));
    }
    install::vulkan(Path::new("/"))?;

    if install::forbidden() || survey(&Machine::this()).missing().is_empty() {
        return Ok(());
    }
    let message = "there is still no usable Vulkan driver after the installation";
    Err(Failure::new(format!("{message}; {} goes on without this check", install::NO_INSTALL)))
}

/// Where to look. Tests look into a directory of their own instead of `/`.
struct Machine {
    root: PathBuf,
    /// What `ldconfig -p` prints: libraries in places of the administrator's choosing.
    linker_cache: String,
    library_path: Vec<PathBuf>,
    /// `VK_DRIVER_FILES`; when set, the loader looks nowhere else.
    driver_files: Option<Vec<PathBuf>>,
    manifest_dirs: Vec<PathBuf>,
}

impl Machine {
    fn this() -> Self {
        let list =
            |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(|value| split(&value));
        let home = std::env::var_os("HOME").map(PathBuf::from);
        let of_user = |name, default: &str| list(name).or_else(|| Some(vec![home.as_ref()?.join(default)]));
        let bases = [
            of_user("XDG_CONFIG_HOME", ".config"),
            of_user("XDG_DATA_HOME", ".local/share"),
            list("XDG_CONFIG_DIRS"),
            list("XDG_DATA_DIRS"),
        ];
        let manifests = |base: PathBuf| base.join("vulkan/icd.d");
        let mut machine = Self::at("/");
        machine.linker_cache = linker_cache();
        machine.library_path = list("LD_LIBRARY_PATH").unwrap_or_default();
        machine.driver_files = list("VK_DRIVER_FILES").or_else(|| list("VK_ICD_FILENAMES"));
        machine.manifest_dirs.extend(bases.into_iter().flatten().flatten().map(manifests));
        machine
    }

    /// The standard places under `root`, without anything from the environment.
    fn at(root: impl Into<PathBuf>) -> Self {
        let bases = ["/etc/xdg", "/usr/local/etc", "/etc", "/usr/local/share", "/usr/share"];
        Self {
            root: root.into(),
            linker_cache: String::new(),
            library_path: Vec::new(),
            driver_files: None,
            manifest_dirs: bases.map(|base| Path::new(base).join("vulkan/icd.d")).to_vec(),
        }
    }

    fn path(&self, path: &Path) -> PathBuf {
        self.root.join(path.strip_prefix("/").unwrap_or(path))
    }

    fn has_library(&self, name: &str) -> bool {
        let triplet = format!("{}-linux-gnu", std::env::consts::ARCH);
        let places = ["usr/lib", "usr/lib64", "lib", "lib64", "usr/local/lib", "usr/local/lib64"];
        let standard =
            places.iter().flat_map(|place| [self.root.join(place), self.root.join(place).join(&triplet)]);
        self.linker_cache.lines().any(|line| line.trim_start().starts_with(&format!("{name} (")))
            || standard.chain(self.library_path.clone()).any(|directory| directory.join(name).exists())
    }

    fn manifests(&self) -> Vec<Manifest> {
        let places = self.driver_files.as_ref().unwrap_or(&self.manifest_dirs);
        let mut files: Vec<PathBuf> = places.iter().flat_map(|place| files_at(&self.path(place))).collect();
        files.retain(|file| file.extension().is_some_and(|extension| extension == "json"));
        files.iter().map(|file| self.read_manifest(file)).collect()
    }

    fn read_manifest(&self, file: &Path) -> Manifest {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let text = std::fs::read_to_string(file).unwrap_or_default();
        let library_exists = library_path(&text).is_some_and(|library| match Path::new(&library) {
            path if path.is_absolute() => self.path(path).exists(),
            path if path.components().count() > 1 => file.with_file_name("").join(path).exists(),
            _ => self.has_library(&library),
        });
        Manifest { name, library_exists }
    }
}

/// One driver (ICD) manifest.
#[derive(Debug)]
struct Manifest {
    name: String,
    library_exists: bool,
}

#[derive(Debug, Default)]
struct Found {
    loader: bool,
    manifests: Vec<Manifest>,
    /// A node under `/dev/dri` that we may open.
    render_node: bool,
    nvidia_device: bool,
}

impl Found {
    fn missing(&self) -> Vec<Missing> {
        let driver = self.manifests.iter().any(|manifest| self.can_work(manifest));
        [(self.loader, Missing::Loader), (driver, Missing::Driver)]
            .into_iter()
            .filter_map(|(present, what)| (!present).then_some(what))
            .collect()
    }

    fn can_work(&self, manifest: &Manifest) -> bool {
        let name = &manifest.name;
        let software = name.starts_with("lvp_icd") || name.contains("swiftshader");
        let device = if name.contains("nvidia") { self.nvidia_device } else { self.render_node };
        manifest.library_exists && (software || device)
    }
}

fn survey(machine: &Machine) -> Found {
    let opens = |node: &PathBuf| std::fs::File::options().read(true).write(true).open(node).is_ok();
    let nodes = files_at(&machine.path(Path::new("/dev/dri")));
    let is_render =
        |node: &PathBuf| node.file_name().is_some_and(|name| name.to_string_lossy().starts_with("renderD"));
    Found {
        loader: machine.has_library(LOADER),
        manifests: machine.manifests(),
        render_node: nodes.iter().any(|node| is_render(node) && opens(node)),
        nvidia_device: (0..16).any(|index| opens(&machine.root.join(format!("dev/nvidia{index}")))),
    }
}

/// The files of a directory, or the file itself.
fn files_at(path: &Path) -> Vec<PathBuf> {
    match std::fs::read_dir(path) {
        Ok(entries) => entries.flatten().map(|entry| entry.path()).collect(),
        Err(_) if path.exists() => vec![path.to_owned()],
        Err(_) => Vec::new(),
    }
}

fn split(paths: &OsStr) -> Vec<PathBuf> {
    std::env::split_paths(paths).filter(|path| !path.as_os_str().is_empty()).collect()
}

/// The value of `library_path`. A manifest is a few lines of JSON with one such key.
fn library_path(manifest: &str) -> Option<String> {
    let value = manifest.split_once("\"library_path\"")?.1.trim_start().strip_prefix(':')?;
    let (text, _) = value.trim_start().strip_prefix('"')?.split_once('"')?;
    Some(text.replace("\\/", "/"))
}

/// Empty where there is no `ldconfig`, as on Alpine; Debian keeps it out of a user's PATH.
fn linker_cache() -> String {
    ["ldconfig", "/sbin/ldconfig"]
        .iter()
        .find_map(|program| Command::new(program).arg("-p").output().ok())
        .map(|output| String::from_utf8_lossy(&output.stdout).into_owned())
        .unwrap_or_default()
}

/// The paths are those of Linux; elsewhere nothing is searched.
#[cfg(test)]
#[cfg(target_os = "linux")]
mod tests;
