//! Pictures: from samples to pixels, and to files that are either whole or not there.

use crate::error::Error;
use crate::film::{Film, put};
use std::io::Write;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A picture, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    pub width: u32,
    pub height: u32,
    /// Linear: radiance, or what is left of it after tone mapping.
    pub pixels: Vec<[f32; 3]>,
}

/// What happens to a sample before samples are averaged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Develop {
    /// Nothing: radiance over black.
    Radiance,
    /// Tone mapping over the backdrop. Averaging what is mapped, not what is to be mapped, keeps bright edges smooth.
    Display {
        /// Stops.
        exposure: f32,
    },
}

/// What a picture is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Png,
    Exr,
}

/// Linear grey behind the body in a PNG, in the middle and at the rim.
pub const BACKDROP: [f32; 2] = [0.075, 0.045];

impl Format {
    /// Samples along each side of a pixel that suit this kind of file: an EXR is compared, pixel centre by pixel centre.
    pub fn samples(self) -> u32 {
        match self {
            Self::Png => 2,
            Self::Exr => 1,
        }
    }

    /// What becomes of samples for this kind of file.
    pub fn develop(self, exposure: f32) -> Develop {
        match self {
            Self::Png => Develop::Display { exposure },
            Self::Exr => Develop::Radiance,
        }
    }
}

impl Develop {
    /// `place`: from the middle of the picture, ±1 at its edges.
    fn apply(self, [r, g, b, coverage]: [f32; 4], place: [f32; 2]) -> [f32; 3] {
        match self {
            Self::Radiance => [r, g, b],
            Self::Display { exposure } => {
                let rim = (0.5 * (place[0] * place[0] + place[1] * place[1])).min(1.0);
                let backdrop = BACKDROP[0] + (BACKDROP[1] - BACKDROP[0]) * rim;
                neutral([r, g, b].map(|c| c * exposure.exp2() + backdrop * (1.0 - coverage)))
            }
        }
    }
}

impl Picture {
    /// Develops samples (radiance, coverage) and averages `side`² of them a pixel.
    pub fn from_samples(samples: &[[f32; 4]], samples_wide: u32, side: u32, develop: Develop) -> Self {
        let width = samples_wide / side;
        let height = samples.len() as u32 / samples_wide / side;
        let weight = 1.0 / (side * side) as f32;
        let pixel = |x: u32, y: u32| {
            let mut sum = [0.0; 3];
            for row in y * side..(y + 1) * side {
                for column in x * side..(x + 1) * side {
                    let place = [2.0 * x as f32 / width as f32 - 1.0, 2.0 * y as f32 / height as f32 - 1.0];
                    let sample = develop.apply(samples[(row * samples_wide + column) as usize], place);
                    sum = std::array::from_fn(|k| sum[k] + sample[k] * weight);
                }
            }
            sum
        };
        let pixels =
            (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
        Self { width, height, pixels }
    }

    /// From 8-bit sRGB, row by row, three bytes a pixel.
    pub fn from_bytes(width: u32, bytes: &[u8]) -> Self {
        let pixels: Vec<[f32; 3]> =
            bytes.as_chunks::<3>().0.iter().map(|rgb| rgb.map(|c| linear(f32::from(c) / 255.0))).collect();
        Self { width, height: pixels.len() as u32 / width.max(1), pixels }
    }

    /// 8-bit sRGB.
    pub fn to_srgb(&self) -> Vec<u8> {
        let pixels = self.pixels.iter().enumerate();
        pixels
            .flat_map(|(index, pixel)| {
                let noise = dither(index as u32 % self.width, index as u32 / self.width);
                pixel.map(|c| (srgb(c) * 255.0 + noise).clamp(0.0, 255.0) as u8)
            })
            .collect()
    }
}

/// Khronos PBR Neutral tone mapper (Khronos Group 2024): leaves colours below 0.8 as they are and desaturates what is brighter.
fn neutral(colour: [f32; 3]) -> [f32; 3] {
    const START: f32 = 0.8 - 0.04;
    const DESATURATION: f32 = 0.15;
    let least = colour.into_iter().fold(f32::INFINITY, f32::min).max(0.0);
    let offset = if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let colour = colour.map(|c| c.max(0.0) - offset);
    let peak = colour.into_iter().fold(0.0, f32::max);
    if peak < START {
        return colour;
    }
    let room = 1.0 - START;
    let new_peak = 1.0 - room * room / (peak + room - START);
    let whiteness = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    colour.map(|c| c * new_peak / peak * (1.0 - whiteness) + new_peak * whiteness)
}

/// IEC 61966-2-1.
fn srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The inverse of [`srgb`].
pub fn linear(srgb: f32) -> f32 {
    if srgb <= 0.040_45 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
}

/// One rounding step of interleaved gradient noise (Jimenez 2014), so that smooth light does not show bands of 8 bits.
fn dither(x: u32, y: u32) -> f32 {
    (52.982_918 * (0.067_110_56 * x as f32 + 0.005_837_15 * y as f32).fract()).fract()
}

/// A picture's file, checked before the work begins and put in place when the work is done.
pub struct Output {
    path: PathBuf,
    pub directory: PathBuf,
    pub format: Format,
    /// How long a frame of an animation is shown, seconds.
    pub frame_seconds: f32,
}

impl Output {
    /// Checks the name's ending and that the directory is there.
    pub fn new(path: &Path) -> Result<Self, Error> {
        let fail = |problem: &str| Err(Error::Output { path: path.to_owned(), problem: problem.to_owned() });
        let ending = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
        let format = match ending.as_deref().and_then(|ending| ending.to_str()) {
            Some("png") => Format::Png,
            Some("exr") => Format::Exr,
            _ => return fail("unknown kind of picture; the name must end in .png or .exr"),
        };
        let directory = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
            _ => PathBuf::from("."),
        };
        if !directory.is_dir() {
            return fail("its directory does not exist; make it first");
        }
        if path.is_dir() {
            return fail("is a directory; name a file");
        }
        Ok(Self { path: path.to_owned(), directory, format, frame_seconds: 1.0 / 24.0 })
    }

    /// Writes one picture, or an animation of several.
    pub fn write(&self, frames: &[Picture]) -> Result<(), Error> {
        match self.format {
            Format::Png => {
                let mut film = self.film(frames.len() as u32)?;
                frames.iter().try_for_each(|frame| film.add(frame))?;
                film.finish()
            }
            Format::Exr => {
                let fail = |problem: String| Error::Output { path: self.path.clone(), problem };
                let mut file = NamedTempFile::new_in(&self.directory)
                    .map_err(|error| fail(format!("cannot be written: {error}")))?;
                write_exr(&mut file, &frames[0]).map_err(|error| fail(error.to_string()))?;
                put(file, &self.path)
            }
        }
    }

    /// A PNG of so many frames, which come one by one.
    pub fn film(&self, frames: u32) -> Result<Film, Error> {
        if self.format != Format::Png {
            let problem = "only a PNG can be animated; name a .png, or numbered files as name_%04d.exr";
            return Err(Error::Output { path: self.path.clone(), problem: problem.to_owned() });
        }
        Film::new(&self.path, &self.directory, frames, self.frame_seconds)
    }
}

/// Temporary files belong to their owner alone; a picture is like any other file.
pub fn readable_by_all(file: &std::fs::File) -> std::io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        file.set_permissions(std::fs::Permissions::from_mode(0o644))?;
    }
    file.sync_all()
}

fn write_exr(file: &mut NamedTempFile, picture: &Picture) -> exr::error::UnitResult {
    use exr::prelude::{Image, SpecificChannels, WritableImage as _};
    let size = (picture.width as usize, picture.height as usize);
    let channels = SpecificChannels::rgb(|position: exr::math::Vec2<usize>| {
        let [r, g, b] = picture.pixels[position.y() * size.0 + position.x()];
        (r, g, b)
    });
    let mut bytes = std::io::Cursor::new(Vec::new());
    Image::from_channels(size, channels).write().to_buffered(&mut bytes)?;
    Ok(file.write_all(bytes.get_ref())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(level: f32) -> Picture {
        Picture { width: 4, height: 3, pixels: vec![[level; 3]; 12] }
    }

    #[test]
    fn samples_are_averaged() {
        let samples = [[0.0; 4], [2.0; 4], [4.0; 4], [6.0; 4]];
        let one = Picture { width: 1, height: 1, pixels: vec![[3.0; 3]] };
        assert_eq!(Picture::from_samples(&samples, 2, 2, Develop::Radiance), one);
        assert_eq!(Picture::from_samples(&samples, 2, 1, Develop::Radiance).height, 2);
        let display = Picture::from_samples(&samples, 2, 2, Develop::Display { exposure: 0.0 });
        assert!(display.pixels[0].iter().all(|c| *c < 1.0));
    }

    #[test]
    fn dark_colours_pass_the_tone_mapper_and_bright_ones_stay_below_white() {
        for level in [0.1, 0.3, 0.6] {
            let [r, g, b] = neutral([level + 0.04, level, level]);
            assert!(r > g && (g - b).abs() < 1e-6 && (r - level).abs() < 1e-6);
        }
        for level in [1.0, 10.0, 1e6] {
            assert!(neutral([level, 0.5, 0.0]).iter().all(|c| (0.0..=1.0).contains(c)));
        }
    }

    #[test]
    fn files_are_whole_or_absent() {
        let directory = tempfile::tempdir().unwrap();
        for name in ["grey.png", "grey.exr"] {
            let path = directory.path().join(name);
            Output::new(&path).unwrap().write(&[grey(0.25)]).unwrap();
            assert!(std::fs::metadata(&path).unwrap().len() > 50);
        }
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 2, "no temporary file stays behind");
        assert!(Output::new(&directory.path().join("grey.bmp")).is_err());
        assert!(Output::new(&directory.path().join("nowhere/grey.png")).is_err());
    }

    #[test]
    fn exr_keeps_every_bit() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.exr");
        let mut picture = grey(0.0);
        picture.pixels[5] = [1.5, 70_000.0, 1e-7];
        Output::new(&path).unwrap().write(std::slice::from_ref(&picture)).unwrap();
        let read = exr::prelude::read_first_rgba_layer_from_file(
            &path,
            |size, _| vec![[0.0_f32; 4]; size.area()],
            |pixels, at, (r, g, b, a): (f32, f32, f32, f32)| pixels[at.y() * 4 + at.x()] = [r, g, b, a],
        )
        .unwrap();
        assert_eq!(read.layer_data.channel_data.pixels[5][..3], picture.pixels[5][..3]);
    }
}
