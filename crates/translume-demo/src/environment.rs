//! Light from an equirectangular map in a file.

use crate::error::Error;
use crate::files;
use glam::{Mat3, Vec3};
use image::ImageDecoder as _;
use serde::{Deserialize, Serialize};
use std::io::{BufRead, Seek};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use translume::{EnvironmentLight, EnvironmentMap, Light};

/// 16,384 × 8,192: a header alone must not fill the memory.
const MAX_PIXELS: usize = 1 << 27;

/// An environment as a scene describes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Environment {
    /// OpenEXR or Radiance; see [`EnvironmentMap`] for where its pixels are.
    pub file: PathBuf,
    /// Factor of radiance.
    #[serde(default = "one")]
    pub scale: f32,
    /// Turn about +y, anticlockwise seen from above.
    #[serde(default)]
    pub rotation_deg: f32,
    /// Whether suns and lamps become lights of their own.
    #[serde(default = "yes")]
    pub split: bool,
    #[serde(default = "yes")]
    pub shadow: bool,
}

fn one() -> f32 {
    1.0
}

fn yes() -> bool {
    true
}

impl Environment {
    /// One that a scene names by its file alone.
    pub fn new(file: PathBuf) -> Self {
        Self { file, scale: one(), rotation_deg: 0.0, split: yes(), shadow: yes() }
    }

    /// All pixels, as the reference takes them; the map turns by whole columns.
    pub fn twin(&self) -> Result<translume_reference::Light, Error> {
        let map = self.read()?;
        let (width, turn) = (map.width() as usize, f64::from(self.rotation_deg) / 360.0);
        let columns = (turn * width as f64).round().rem_euclid(width as f64) as usize;
        let mut pixels: Vec<_> =
            map.pixels().iter().map(|rgb| rgb.map(|c| f64::from(c) * f64::from(self.scale))).collect();
        pixels.chunks_exact_mut(width).for_each(|row| row.rotate_left(columns));
        match translume_reference::EnvironmentMap::new(width, map.height() as usize, pixels) {
            Some(map) => {
                Ok(translume_reference::Light::Environment { map: Arc::new(map), shadow: self.shadow })
            }
            None => {
                Err(Error::Environment { path: self.file.clone(), problem: "holds no pixels".to_owned() })
            }
        }
    }

    /// Reads the file, once the other numbers are known to be fine.
    fn read(&self) -> Result<EnvironmentMap, Error> {
        let fail = |problem| Err(Error::Environment { path: self.file.clone(), problem });
        if !(0.0..=f32::MAX).contains(&self.scale) {
            return fail(format!("the scale is {}, but must be finite and not negative", self.scale));
        }
        if !self.rotation_deg.is_finite() {
            return fail(format!("a rotation by {} degrees is none", self.rotation_deg));
        }
        read(&self.file)
    }

    /// As the library takes it: the suns, if they are split off, and the harmonics.
    pub fn lights(&self) -> Result<Vec<Light>, Error> {
        let map = self.read()?;
        let (suns, sky) = if self.split { map.split_peaks() } else { (Vec::new(), map.project()) };
        let turn = Mat3::from_rotation_y(self.rotation_deg.to_radians());
        let scaled = |rgb: [f32; 3]| rgb.map(|c| c * self.scale);
        let mut lights: Vec<_> = suns
            .into_iter()
            .map(|mut sun| {
                sun.to_light = (turn * Vec3::from(sun.to_light)).to_array();
                sun.irradiance = scaled(sun.irradiance);
                sun.shadow = self.shadow;
                Light::Directional(sun)
            })
            .collect();
        let coefficients = sky.turned(turn.to_cols_array_2d()).coefficients.map(scaled);
        lights.push(Light::Environment(EnvironmentLight { coefficients, shadow: self.shadow }));
        Ok(lights)
    }
}

/// Reads the first RGB layer of an OpenEXR file, or a Radiance file, as its ending says.
fn read(path: &Path) -> Result<EnvironmentMap, Error> {
    let fail = |problem| Error::Environment { path: path.to_owned(), problem };
    let ending = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
    let (width, height, pixels) = match ending.as_deref().and_then(|ending| ending.to_str()) {
        Some("exr") => read_exr(path),
        Some("hdr") => read_hdr(path),
        _ => Err("unknown kind of environment map; the name must end in .exr or .hdr".to_owned()),
    }
    .map_err(fail)?;
    EnvironmentMap::new(width, height, pixels).map_err(|error| fail(error.to_string()))
}

type Pixels = (u32, u32, Vec<[f32; 3]>);

fn read_exr(path: &Path) -> Result<Pixels, String> {
    use exr::math::Vec2;
    use exr::prelude::{ReadChannels as _, ReadLayers as _};
    let file = open(path)?;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size: Vec2<usize>, _| {
                (size, vec![[0.0; 3]; if size.area() <= MAX_PIXELS { size.area() } else { 0 }])
            },
            |(size, pixels): &mut (Vec2<usize>, Vec<[f32; 3]>), at, (r, g, b): (f32, f32, f32)| {
                if let Some(pixel) = pixels.get_mut(at.y() * size.width() + at.x()) {
                    *pixel = [r, g, b];
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(file)
        .map_err(|error| format!("is not an OpenEXR picture with channels R, G and B: {error}"))?;
    let (size, pixels) = image.layer_data.channel_data.pixels;
    check_size(size.width(), size.height())?;
    Ok((size.width() as u32, size.height() as u32, pixels))
}

fn read_hdr(path: &Path) -> Result<Pixels, String> {
    let mut file = open(path)?;
    let fail = |problem: String| format!("is not a Radiance picture: {problem}");
    // Files begin with #?RADIANCE or #?RGBE; the decoder's strict mode knows only one.
    if !file.fill_buf().map_err(|error| fail(error.to_string()))?.starts_with(b"#?") {
        return Err(fail("it does not begin with #?RADIANCE".to_owned()));
    }
    let decoder =
        image::codecs::hdr::HdrDecoder::new_nonstrict(file).map_err(|error| fail(error.to_string()))?;
    let (width, height) = decoder.dimensions();
    check_size(width as usize, height as usize)?;
    let image = image::DynamicImage::from_decoder(decoder).map_err(|error| fail(error.to_string()))?;
    Ok((width, height, image.into_rgb32f().pixels().map(|pixel| pixel.0).collect()))
}

fn open(path: &Path) -> Result<impl BufRead + Seek + Send, String> {
    files::open(path).map_err(|error| format!("cannot be read: {error}"))
}

fn check_size(width: usize, height: usize) -> Result<(), String> {
    if width.saturating_mul(height) <= MAX_PIXELS {
        return Ok(());
    }
    Err(format!("has {width} × {height} pixels, but at most {MAX_PIXELS} are read; make it smaller"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;

    fn refused(name: &str, content: &[u8], words: &[&str]) {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join(name);
        std::fs::write(&path, content).unwrap();
        let message = read(&path).unwrap_err().to_string();
        for word in [name].iter().chain(words) {
            assert!(message.contains(word) && !message.contains('\n'), "{word}: {message}");
        }
    }

    fn exr(path: &Path, pixels: &[[f32; 3]; 8]) {
        exr::prelude::write_rgb_file(path, 4, 2, |x, y| {
            let [r, g, b] = pixels[y * 4 + x];
            (r, g, b)
        })
        .unwrap();
    }

    fn hdr(path: &Path, pixels: &[[f32; 3]; 8]) {
        let pixels = pixels.map(image::Rgb);
        image::codecs::hdr::HdrEncoder::new(File::create(path).unwrap()).encode(&pixels, 4, 2).unwrap();
    }

    #[test]
    fn both_formats_are_read() {
        let directory = tempfile::tempdir().unwrap();
        // Powers of two, because Radiance keeps eight bits.
        let pixels: [[f32; 3]; 8] = std::array::from_fn(|k| [1.0, 0.5, 0.25].map(|c| c * (k as f32).exp2()));
        let write = [("sky.EXR", exr as fn(&Path, &_)), ("sky.hdr", hdr)];
        for (name, write) in write {
            let path = directory.path().join(name);
            write(&path, &pixels);
            let map = read(&path).unwrap();
            assert_eq!((map.width(), map.height(), map.pixels()), (4, 2, &pixels[..]), "{name}");
            let mut other = pixels;
            other[6][1] *= 2.0;
            write(&path, &other);
            assert_ne!(read(&path).unwrap().pixels(), pixels);
        }
        // The other first line, as many tools write it.
        let path = directory.path().join("sky.hdr");
        let bytes = std::fs::read(&path).unwrap();
        let body = bytes.strip_prefix(b"#?RADIANCE").unwrap();
        std::fs::write(&path, [b"#?RGBE", body].concat()).unwrap();
        assert_eq!(read(&path).unwrap().pixels()[5], pixels[5]);
    }

    #[test]
    fn bad_maps_are_named() {
        refused("letter.exr", b"dear sky", &["OpenEXR"]);
        refused("letter.hdr", b"dear sky", &["Radiance"]);
        refused("letter.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\ndear sky\n", &["Radiance"]);
        refused("cut.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\nab", &["Radiance"]);
        refused("huge.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 30000 +X 60000\n", &["60000 × 30000"]);
        refused("empty.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 0 +X 16\n", &["16 × 0"]);
        refused("sky.png", b"\x89PNG", &[".exr or .hdr"]);
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("nan.exr");
        let mut pixels = [[1.0; 3]; 8];
        pixels[6][2] = f32::NAN;
        exr(&path, &pixels);
        let message = read(&path).unwrap_err().to_string();
        assert!(message.contains("nan.exr") && message.contains("column 2, row 1"), "{message}");
        let bytes = std::fs::read(&path).unwrap();
        refused("cut.exr", &bytes[..bytes.len() / 2], &["OpenEXR"]);
        // A header that promises 10¹² pixels.
        let mut huge = bytes.clone();
        let name = b"dataWindow\0box2i\0";
        let window = bytes.windows(name.len()).position(|part| part == name).unwrap() + name.len() + 4;
        huge[window + 8..window + 16].copy_from_slice(&[0x3f, 0x42, 0x0f, 0, 0x3f, 0x42, 0x0f, 0]);
        refused("huge.exr", &huge, &[]);
        // Grey alone is no colour.
        let channels =
            exr::prelude::SpecificChannels::build().with_channel("Y").with_pixel_fn(|_| (1.0_f32,));
        let grey = exr::prelude::Image::from_channels((2, 1), channels);
        let path = directory.path().join("grey.exr");
        exr::prelude::WritableImage::write(&grey).to_file(&path).unwrap();
        refused("grey.exr", &std::fs::read(&path).unwrap(), &["channels R, G and B"]);
        assert!(read(&directory.path().join("gone.exr")).unwrap_err().to_string().contains("cannot be read"));
    }

    #[test]
    fn a_rotation_turns_sun_and_sky() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("sun.exr");
        // One bright pixel of 64 × 32 just past the middle: +x, a little towards +z and down.
        exr::prelude::write_rgb_file(&path, 64, 32, |x, y| match (x, y) {
            (32, 16) => (5e3_f32, 5e3, 5e3),
            _ => (x as f32, 1.0, 1.0),
        })
        .unwrap();
        let plain = Environment { scale: 2.0, ..Environment::new(path) };
        let turned = Environment { rotation_deg: 90.0, shadow: false, ..plain.clone() };
        let split = |environment: &Environment| match environment.lights().unwrap()[..] {
            [Light::Directional(sun), Light::Environment(sky)] => (sun, sky),
            ref other => panic!("{other:?}"),
        };
        let ((sun, sky), (turned_sun, turned_sky)) = (split(&plain), split(&turned));
        assert!(sun.to_light[0] > 0.99 && sun.shadow && sky.shadow);
        // +x becomes −z.
        assert!(turned_sun.to_light[2] < -0.99 && !turned_sun.shadow && !turned_sky.shadow);
        let apart = |a: [f32; 3], b: [f32; 3]| (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max);
        let [ahead, left] = [sky, turned_sky].map(|sky| sky.radiance([0.0, 0.0, -1.0]));
        let source = sky.radiance([1.0, 0.0, 0.0]);
        assert!(apart(left, source) < 1e-3 && apart(ahead, source) > 1.0, "{ahead:?} {left:?} {source:?}");
        let unscaled = split(&Environment { scale: 1.0, ..plain.clone() });
        assert_eq!(sun.irradiance, unscaled.0.irradiance.map(|c| 2.0 * c));
        assert_eq!(Environment { split: false, ..plain.clone() }.lights().unwrap().len(), 1);
        for (scale, rotation_deg) in [(-1.0, 0.0), (f32::INFINITY, 0.0), (1.0, f32::NAN)] {
            let message =
                Environment { scale, rotation_deg, ..plain.clone() }.lights().unwrap_err().to_string();
            assert!(message.contains("sun.exr"), "{message}");
        }
    }
}
