//! Files by their names: those of the disk, or in a browser, which shows none, those that the user has handed over.

#[cfg(target_arch = "wasm32")]
pub use handed::{hand_over, open, read};
#[cfg(not(target_arch = "wasm32"))]
pub use std::fs::read;

use std::io;
use std::path::Path;

/// Opens a file for reading.
#[cfg(not(target_arch = "wasm32"))]
pub fn open(path: &Path) -> io::Result<io::BufReader<std::fs::File>> {
    std::fs::File::open(path).map(io::BufReader::new)
}

/// A whole file in words.
pub fn read_to_string(path: &Path) -> io::Result<String> {
    String::from_utf8(read(path)?).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
}

#[cfg(target_arch = "wasm32")]
mod handed {
    use std::cell::RefCell;
    use std::collections::HashMap;
    use std::io::{Cursor, Error, ErrorKind, Result};
    use std::path::{Path, PathBuf};

    thread_local! {
        /// Until the page is closed: a scene may ask for them again and again.
        static FILES: RefCell<HashMap<PathBuf, Vec<u8>>> = RefCell::default();
    }

    /// Takes the place of one that had the same name.
    pub fn hand_over(path: PathBuf, bytes: Vec<u8>) {
        FILES.with_borrow_mut(|files| files.insert(path, bytes));
    }

    pub fn read(path: &Path) -> Result<Vec<u8>> {
        let missing = "the page does not have it; drop it onto the page";
        let bytes = FILES.with_borrow(|files| files.get(path).cloned());
        bytes.ok_or_else(|| Error::new(ErrorKind::NotFound, missing))
    }

    pub fn open(path: &Path) -> Result<Cursor<Vec<u8>>> {
        read(path).map(Cursor::new)
    }
}
