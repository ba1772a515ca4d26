//! Who waits for a file, and how it is read meanwhile.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::LoadError;
use crate::progress::Progress;

/// Bytes between two reports.
const STEP: usize = 1 << 20;

/// Hears how far a file has come, and may say that it is no longer wanted.
pub(super) struct Listener<'a> {
    pub file: &'a str,
    pub progress: &'a dyn Fn(Progress) -> bool,
}

impl Listener<'_> {
    pub fn tell(&self, stage: &'static str, done: usize, total: Option<usize>) -> Result<(), LoadError> {
        if (self.progress)(Progress { stage, done, total }) {
            Ok(())
        } else {
            Err(LoadError::Cancelled { file: self.file.into() })
        }
    }

    /// Reports the parsing of bytes, if `done` has passed `next`, where the next report is due.
    pub fn tell_parsed(&self, done: usize, total: usize, next: &mut usize) -> Result<(), LoadError> {
        if done < *next {
            return Ok(());
        }
        *next = done + STEP;
        self.tell("parsing", done, Some(total))
    }

    /// The whole of a regular file: devices and pipes may never end.
    pub fn read(&self, path: &Path) -> Result<Vec<u8>, LoadError> {
        let error = |reason: String| LoadError::Read { file: self.file.into(), reason };
        let metadata = std::fs::metadata(path).map_err(|e| error(e.to_string()))?;
        if !metadata.is_file() {
            return Err(error("it is not a regular file".into()));
        }
        let mut file = File::open(path).map_err(|e| error(e.to_string()))?;
        let total = usize::try_from(metadata.len()).map_err(|e| error(e.to_string()))?;
        let mut bytes = Vec::new();
        bytes.try_reserve_exact(total).map_err(|e| error(e.to_string()))?;
        loop {
            self.tell("reading", bytes.len(), Some(total))?;
            let read = file.by_ref().take(STEP as u64).read_to_end(&mut bytes);
            if read.map_err(|e| error(e.to_string()))? == 0 {
                return Ok(bytes);
            }
        }
    }
}
