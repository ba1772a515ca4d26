//! Several pictures on their way into files: frame by frame, so that a long film fits into memory, and all or nothing.

use crate::error::Error;
use crate::picture::{Format, Output, Picture, readable_by_all};
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use tempfile::{NamedTempFile, TempDir};

/// A PNG of one picture or several, which is in place once it is finished.
pub struct Film {
    path: PathBuf,
    frames: u32,
    added: u32,
    frame_seconds: f32,
    writer: Option<png::Writer<BufWriter<File>>>,
    /// After the writer, which still writes when it is dropped.
    file: NamedTempFile,
}

impl Film {
    /// So many frames are to be added.
    pub fn new(path: &Path, directory: &Path, frames: u32, frame_seconds: f32) -> Result<Self, Error> {
        let file = NamedTempFile::new_in(directory).map_err(|error| unwritable(path, error))?;
        Ok(Self { path: path.to_owned(), frames, added: 0, frame_seconds, writer: None, file })
    }

    /// The next frame, as large as the others.
    pub fn add(&mut self, picture: &Picture) -> Result<(), Error> {
        let writer = match self.writer.take() {
            Some(writer) => writer,
            None => self.header(picture)?,
        };
        self.added += 1;
        let result = self.writer.insert(writer).write_image_data(&picture.to_srgb());
        result.map_err(|error| unwritable(&self.path, error))
    }

    fn header(&self, Picture { width, height, .. }: &Picture) -> Result<png::Writer<BufWriter<File>>, Error> {
        let start = || -> Result<_, png::EncodingError> {
            let file = self.file.as_file().try_clone()?;
            let mut encoder = png::Encoder::new(BufWriter::new(file), *width, *height);
            encoder.set_color(png::ColorType::Rgb);
            encoder.set_depth(png::BitDepth::Eight);
            encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
            if self.frames > 1 {
                encoder.set_animated(self.frames, 0)?;
                let (numerator, denominator) = delay(self.frame_seconds);
                encoder.set_frame_delay(numerator, denominator)?;
            }
            encoder.write_header()
        };
        start().map_err(|error| unwritable(&self.path, error))
    }

    /// Fails where frames are missing.
    pub fn finish(self) -> Result<(), Error> {
        let Self { added, frames, .. } = self;
        if added != frames {
            let problem = format!("{added} frames came, not {frames}; give them all");
            return Err(Error::Output { path: self.path, problem });
        }
        if let Some(writer) = self.writer {
            writer.finish().map_err(|error| unwritable(&self.path, error))?;
        }
        put(self.file, &self.path)
    }
}

/// Seconds as a fraction of 16-bit numbers: in steps of 0.1 ms while they fit, else in whole seconds, up to 18 hours.
fn delay(seconds: f32) -> (u16, u16) {
    let fine = (seconds * 1e4).round();
    if fine <= f32::from(u16::MAX) { (fine as u16, 10_000) } else { (seconds.round() as u16, 1) }
}

/// Puts a file that is whole in its place.
pub fn put(file: NamedTempFile, path: &Path) -> Result<(), Error> {
    readable_by_all(file.as_file()).map_err(|error| unwritable(path, error))?;
    file.persist(path).map_err(|error| unwritable(path, error.error))?;
    Ok(())
}

fn unwritable(path: &Path, error: impl std::fmt::Display) -> Error {
    Error::Output { path: path.to_owned(), problem: format!("cannot be written: {error}") }
}

/// Pictures in numbered files, which are in place once they are finished.
pub struct Numbered {
    names: Names,
    written: Vec<PathBuf>,
    waiting: TempDir,
    pub format: Format,
}

/// Names with a number in them.
#[derive(Clone, Debug, PartialEq)]
struct Names {
    directory: PathBuf,
    before: String,
    digits: usize,
    after: String,
}

/// Whether the name says where its number is: `%d`, or `%04d` with four digits.
pub fn is_pattern(path: &Path) -> bool {
    path.file_name().is_some_and(|name| split(&name.to_string_lossy()).is_some())
}

/// What is before and after the number, and its least digits.
fn split(name: &str) -> Option<(&str, usize, &str)> {
    let starts = name.match_indices('%').map(|(start, _)| start);
    starts.into_iter().find_map(|start| {
        let (digits, after) = name[start + 1..].split_once('d')?;
        let is_number = digits.len() <= 2 && digits.bytes().all(|byte| byte.is_ascii_digit());
        is_number.then(|| (&name[..start], digits.parse().unwrap_or(1), after))
    })
}

impl Names {
    /// As the path's pattern says, else with an underscore and four digits before the ending.
    fn new(path: &Path) -> Self {
        let part = |part: Option<&std::ffi::OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
        let directory = path.parent().unwrap_or(Path::new("")).to_owned();
        if let Some((before, digits, after)) = split(&part(path.file_name())) {
            return Self { directory, before: before.to_owned(), digits, after: after.to_owned() };
        }
        let (before, after) = (part(path.file_stem()) + "_", format!(".{}", part(path.extension())));
        Self { directory, before, digits: 4, after }
    }

    fn path(&self, k: usize) -> PathBuf {
        let Self { directory, before, digits, after } = self;
        directory.join(format!("{before}{k:0digits$}{after}"))
    }
}

impl Numbered {
    /// So many frames are to be added; no file may be there under any of their names.
    pub fn new(path: &Path, frames: u32) -> Result<Self, Error> {
        let output = Output::new(path)?;
        let names = Names::new(path);
        if let Some(path) = (0..frames as usize).map(|k| names.path(k)).find(|path| path.exists()) {
            let problem = "is there already; choose another name or move it away".to_owned();
            return Err(Error::Output { path, problem });
        }
        let waiting = TempDir::new_in(&output.directory).map_err(|error| unwritable(path, error))?;
        Ok(Self { names, written: Vec::new(), waiting, format: output.format })
    }

    /// The next frame.
    pub fn add(&mut self, picture: &Picture) -> Result<(), Error> {
        let path = self.names.path(self.written.len());
        let waiting = self.waiting.path().join(path.file_name().unwrap_or_default());
        Output::new(&waiting)?.write(std::slice::from_ref(picture))?;
        self.written.push(path);
        Ok(())
    }

    /// The first file's name.
    pub fn finish(self) -> Result<PathBuf, Error> {
        for (k, path) in self.written.iter().enumerate() {
            let waiting = self.waiting.path().join(path.file_name().unwrap_or_default());
            if let Err(error) = std::fs::rename(waiting, path) {
                // Some would be worse than none; what cannot be removed either is as good as it gets.
                self.written[..k].iter().for_each(|path| drop(std::fs::remove_file(path)));
                return Err(unwritable(path, error));
            }
        }
        Ok(self.names.path(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(level: f32) -> Picture {
        Picture { width: 4, height: 3, pixels: vec![[level; 3]; 12] }
    }

    fn count(directory: &TempDir) -> usize {
        std::fs::read_dir(directory.path()).unwrap().count()
    }

    #[test]
    fn delays_are_fractions() {
        assert_eq!(delay(1.0 / 24.0), (417, 10_000));
        assert_eq!(delay(90.2), (90, 1));
    }

    #[test]
    fn a_film_has_its_frames_and_their_time() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("film.png");
        let mut film = Film::new(&path, directory.path(), 3, 0.1).unwrap();
        [0.1, 0.2, 0.3].iter().for_each(|level| film.add(&grey(*level)).unwrap());
        film.finish().unwrap();
        let mut reader =
            png::Decoder::new(std::io::BufReader::new(File::open(&path).unwrap())).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let mut first = || {
            reader.next_frame(&mut bytes).unwrap();
            bytes[0]
        };
        let levels = [first(), first(), first()];
        assert!(levels.is_sorted() && levels[0] < levels[2], "{levels:?}");
        let info = reader.info();
        assert_eq!(info.animation_control.unwrap().num_frames, 3);
        assert_eq!(info.frame_control.unwrap().delay_num, 1000);
    }

    #[test]
    fn nothing_is_left_of_a_film_that_is_given_up() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("film.png");
        let mut film = Film::new(&path, directory.path(), 3, 0.1).unwrap();
        film.add(&grey(0.1)).unwrap();
        assert_eq!(count(&directory), 1, "it is being written");
        drop(film);
        assert_eq!(count(&directory), 0);
        let mut film = Film::new(&path, directory.path(), 3, 0.1).unwrap();
        film.add(&grey(0.1)).unwrap();
        assert!(film.finish().is_err(), "two frames are missing");
        assert_eq!(count(&directory), 0);
    }

    #[test]
    fn numbers_are_where_the_name_says() {
        let name = |path: &str, k| Names::new(Path::new(path)).path(k).display().to_string();
        assert_eq!(name("a/b.png", 7), "a/b_0007.png");
        assert_eq!(name("a/b%d.exr", 7), "a/b7.exr");
        assert_eq!(name("b-%03d-x.png", 7), "b-007-x.png");
        assert_eq!(name("b%02d.png", 123), "b123.png");
        assert!(is_pattern(Path::new("50%_%4d.png")) && !is_pattern(Path::new("50%.png")));
        assert!(!is_pattern(Path::new("%d/a.png")) && !is_pattern(Path::new("5%odd.png")));
    }

    #[test]
    fn numbered_files_are_all_there_or_none() {
        let directory = tempfile::tempdir().unwrap();
        for ending in ["png", "exr"] {
            let path = directory.path().join(format!("a.{ending}"));
            let mut numbered = Numbered::new(&path, 2).unwrap();
            numbered.add(&grey(0.1)).unwrap();
            drop(numbered);
            assert_eq!(count(&directory), 0);
        }
        let path = directory.path().join("a.png");
        let mut numbered = Numbered::new(&path, 2).unwrap();
        [0.1, 0.2].iter().for_each(|level| numbered.add(&grey(*level)).unwrap());
        assert_eq!(numbered.finish().unwrap(), directory.path().join("a_0000.png"));
        assert!(directory.path().join("a_0001.png").exists() && count(&directory) == 2);
        let words = Numbered::new(&path, 2).err().unwrap().to_string();
        assert!(words.contains("a_0000.png: is there already"), "{words}");
        assert!(Numbered::new(&directory.path().join("b_%d.png"), 2).is_ok());
    }
}
