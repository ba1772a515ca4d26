//! A Chromium without a window, with WebGPU on the processor, so that a picture is the same on every machine.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use crate::process::{Failure, works};

const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// The browser's software driver, which programs can take too.
const DRIVER: &str = "vk_swiftshader_icd.json";
/// Where it lies where the browser's name is only that of a script.
const FOLDERS: [&str; 4] =
    ["/usr/lib/chromium", "/usr/lib/chromium-browser", "/usr/lib64/chromium-browser", "/opt/google/chrome"];

/// Ends when it is dropped.
pub struct Browser(Child);

/// The driver that the browser draws with, unless `VK_DRIVER_FILES` names one.
pub fn driver() -> Result<PathBuf, Failure> {
    if let Some(named) = std::env::var_os("VK_DRIVER_FILES").filter(|named| !named.is_empty()) {
        return Ok(named.into());
    }
    let named = std::env::var("CHROMIUM").ok().and_then(|name| std::fs::canonicalize(name).ok());
    let beside = named.as_deref().and_then(Path::parent).into_iter();
    let mut files = beside.chain(FOLDERS.map(Path::new)).map(|folder| folder.join(DRIVER));
    files.find(|file| file.is_file()).ok_or_else(|| {
        Failure::new(format!(
            "the browser's driver {DRIVER} is in none of {}; set VK_DRIVER_FILES to it, as other rasterisers draw other outlines",
            FOLDERS.join(", ")
        ))
    })
}

impl Browser {
    /// `CHROMIUM` names another than those that are usual.
    pub fn open(address: &str, profile: &Path) -> Result<Self, Failure> {
        let named = std::env::var("CHROMIUM").ok();
        let names: Vec<&str> = named.as_deref().map_or(NAMES.to_vec(), |name| vec![name]);
        let name = names.iter().copied().find(|name| works(Command::new(name).arg("--version"))).ok_or_else(|| {
            let names = names.join(", ");
            Failure::new(format!(
                "no Chromium is called {names}; install one (Debian: `apt-get install chromium`), or set CHROMIUM to its path"
            ))
        })?;
        // Without the sandbox, which root and containers do not have; the page is our own.
        let child = Command::new(name)
            .args(["--headless=new", "--no-sandbox", "--no-first-run", "--window-size=1280,800"])
            .args(["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader"])
            // The canvas takes what WebGPU draws only where the page is composed by Vulkan too.
            .args(["--enable-features=Vulkan", "--use-vulkan=swiftshader", "--use-angle=swiftshader"])
            .arg("--ignore-gpu-blocklist")
            .arg(format!("--user-data-dir={}", profile.display()))
            .arg(address)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn();
        child.map(Self).map_err(|error| Failure::new(format!("{name} did not start: {error}")))
    }

    /// Whether it is still there.
    pub fn runs(&mut self) -> bool {
        matches!(self.0.try_wait(), Ok(None))
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It may have ended.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
