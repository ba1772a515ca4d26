//! Loads a file in a thread of its own and says what went wrong.

use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Duration;

use translume_mesh::load::load;

/// No file here has an excuse to take longer, on a slow machine and without optimisation.
pub const LONGEST: Duration = Duration::from_secs(5);

/// Bytes that the memory of the process may ever grow by.
pub const MOST: usize = 1 << 30;

/// Tests that measure hold this, so that they do not take memory and time from each other.
pub fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A file: its name, and what makes up its bytes.
pub struct Row {
    pub name: &'static str,
    pub bytes: Box<dyn Fn() -> Vec<u8>>,
}

pub fn row<T: Into<Vec<u8>>>(name: &'static str, bytes: impl Fn() -> T + 'static) -> Row {
    Row { name, bytes: Box::new(move || bytes().into()) }
}

/// Writes a file into a folder that goes away, and hands over its path.
pub fn with_file<T>(name: &str, bytes: &[u8], use_it: impl FnOnce(&Path) -> T) -> T {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    use_it(&path)
}

/// Panics with the names of all files that are not refused as they should be.
pub fn refuse_all(rows: &[Row]) {
    let wrong: Vec<String> = rows
        .iter()
        .filter_map(|row| {
            with_file(row.name, &(row.bytes)(), |path| verdict(path, the_loader, LONGEST).err())
        })
        .collect();
    assert!(wrong.is_empty(), "{} of {} files:\n{}", wrong.len(), rows.len(), wrong.join("\n"));
}

/// What the loader says: triangles, or the error's text.
pub fn the_loader(path: &Path) -> Result<usize, String> {
    load(path).map(|loaded| loaded.mesh.triangles.len()).map_err(|error| error.to_string())
}

/// `Ok` with the error's text where a loader refuses a file in time, without panic, and within memory.
pub fn verdict(
    path: &Path,
    load: fn(&Path) -> Result<usize, String>,
    longest: Duration,
) -> Result<String, String> {
    static START: OnceLock<Memory> = OnceLock::new();
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    let start = START.get_or_init(Memory::peak);
    let before = Memory::peak();
    let outcome = in_thread(path, load, longest).map_err(|what| format!("{name}: {what}"))?;
    let after = Memory::peak();
    if after.above(start) > MOST && after.above(&before) > MOST / 64 {
        return Err(format!("{name}: took {} MiB", after.above(start) >> 20));
    }
    // By its name alone, or in its folder, as one beside it that it refers to.
    let folder = path.parent().unwrap().display().to_string();
    match outcome {
        Ok(triangles) => Err(format!("{name}: was loaded, {triangles} triangles")),
        Err(text) if !text.contains(&name) && !text.contains(&folder) => {
            Err(format!("{name}: is not named in {text:?}"))
        }
        Err(text) if text.len() > 1000 => Err(format!("{name}: a message of {} bytes", text.len())),
        Err(text) => Ok(text),
    }
}

fn in_thread(
    path: &Path,
    load: fn(&Path) -> Result<usize, String>,
    longest: Duration,
) -> Result<Result<usize, String>, String> {
    let (send, receive) = channel();
    let path = path.to_owned();
    std::thread::spawn(move || {
        let outcome = std::panic::catch_unwind(|| load(&path));
        send.send(outcome.map_err(|_| "panicked".to_owned()))
    });
    receive.recv_timeout(longest).unwrap_or_else(|error| match error {
        RecvTimeoutError::Timeout => Err(format!("was not done after {longest:?}")),
        RecvTimeoutError::Disconnected => Err("ended its thread".into()),
    })
}

/// Peaks of this process in bytes, resident and virtual; 0 where the system does not tell.
#[derive(Default)]
struct Memory {
    resident: usize,
    virtual_memory: usize,
}

impl Memory {
    fn peak() -> Self {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let peak = |name: &str| {
            let line = status.lines().find_map(|line| line.strip_prefix(name)).unwrap_or_default();
            let kib: usize = line.split_whitespace().next().and_then(|n| n.parse().ok()).unwrap_or_default();
            kib << 10
        };
        Self { resident: peak("VmHWM:"), virtual_memory: peak("VmPeak:") }
    }

    fn above(&self, before: &Self) -> usize {
        let resident = self.resident.saturating_sub(before.resident);
        resident.max(self.virtual_memory.saturating_sub(before.virtual_memory))
    }
}

fn noticed(load: fn(&Path) -> Result<usize, String>, expected: &str) {
    noticed_within(LONGEST, load, expected);
}

fn noticed_within(longest: Duration, load: fn(&Path) -> Result<usize, String>, expected: &str) {
    let error = with_file("a.obj", b"", |path| verdict(path, load, longest).unwrap_err());
    assert!(error.starts_with(expected), "{expected}: {error}");
}

/// A loader that does what a loader must not do is noticed.
#[test]
fn the_harness_notices_what_it_must() {
    let _alone = alone();
    noticed(|_| Ok(4), "a.obj: was loaded, 4 triangles");
    noticed(|_| panic!("as it must not"), "a.obj: panicked");
    noticed_within(
        LONGEST / 10,
        |path| {
            std::thread::sleep(LONGEST / 5);
            Err(path.display().to_string())
        },
        "a.obj: was not done after 500ms",
    );
    noticed(|_| Err("some file is wrong".into()), "a.obj: is not named in \"some file is wrong\"");
    noticed(|path| Err(path.display().to_string().repeat(100)), "a.obj: a message of");
    with_file("a.obj", b"", |path| verdict(path, the_loader, LONGEST).unwrap());
}

/// A loader that takes too much memory is noticed. To come last: peaks stay.
pub fn the_harness_notices_hunger() {
    if cfg!(target_os = "linux") {
        noticed(
            |path| {
                let reserved = Vec::<u8>::with_capacity(2 * MOST);
                Err(format!("{} {}", path.display(), reserved.capacity()))
            },
            "a.obj: took ",
        );
    }
}
