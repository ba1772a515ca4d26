//! `translume report`: measures the library against the CPU reference and writes tables and a plot.

mod axis;
mod bench;
mod csv;
mod date;
mod flicker;
mod frontier;
mod gather;
mod method;
mod plot;
mod scatter;
mod scenes;
mod subject;
mod table;
mod transport;
mod trials;
mod twin;

use crate::cli::{self, Report};
use crate::error::Error;
use std::path::Path;

/// Index of refraction of every subject: skin, milk, wax.
const IOR: f32 = 1.3;

pub fn run(arguments: &Report) -> Result<(), Error> {
    match arguments.suite.as_deref() {
        None | Some(cli::ALL) => frontier::run(arguments),
        Some("gather") => gather::run(arguments),
        Some("scatter") => scatter::run(arguments),
        Some("transport") => transport::run(arguments),
        Some(other) => Err(Error::Option {
            option: "--suite",
            problem: format!(
                "no suite is called \"{other}\"; known are {}, gather, scatter, transport",
                cli::ALL
            ),
        }),
    }
}

/// Makes the folder and finds out whether files can be made in it: before the work rather than after.
fn prepare_folder(folder: &Path) -> Result<(), Error> {
    let attempt = std::fs::create_dir_all(folder).and_then(|()| tempfile::tempfile_in(folder));
    attempt.map(drop).map_err(|error| Error::Output {
        path: folder.to_owned(),
        problem: format!("cannot hold a report: {error}; name a directory that can be written"),
    })
}

fn write(folder: &Path, name: &str, content: &str) -> Result<(), Error> {
    let path = folder.join(name);
    std::fs::write(&path, content)
        .map_err(|error| Error::Output { problem: format!("cannot be written: {error}"), path })
}
