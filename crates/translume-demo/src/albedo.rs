//! A texture of albedo: what a body gives back of the light differs from place to place.

use crate::error::Error;
use crate::files;
use crate::picture::linear;
use image::{ImageFormat, ImageReader};
use std::path::{Path, PathBuf};
use translume::{Body, Variation, wgpu};
use translume_mesh::{Atlas, Mesh};

/// A picture that repeats over the plane of a mesh's own texture coordinates.
pub struct Albedo {
    width: usize,
    height: usize,
    /// 8-bit sRGB, row by row from v = 0.
    pixels: Vec<[u8; 3]>,
}

impl Albedo {
    /// Reads a PNG or JPEG for a mesh that has texture coordinates.
    pub fn open(path: &Path, mesh: &Mesh) -> Result<Self, Error> {
        let fail = |problem: String| Error::Texture { path: path.to_owned(), problem };
        if mesh.uvs.is_empty() {
            let problem = "an albedo texture lies on texture coordinates, and the model has none; give one that has, or remove the texture";
            return Err(Error::Texture { path: PathBuf::from(&mesh.name), problem: problem.to_owned() });
        }
        let unreadable = |error| fail(format!("cannot be read: {error}"));
        let reader = ImageReader::new(files::open(path).map_err(unreadable)?)
            .with_guessed_format()
            .map_err(unreadable)?;
        if !matches!(reader.format(), Some(ImageFormat::Png | ImageFormat::Jpeg)) {
            return Err(fail("is neither a PNG nor a JPEG; convert it to one of them".to_owned()));
        }
        let image = reader.decode().map_err(|error| fail(format!("cannot be decoded: {error}")))?.into_rgb8();
        let (width, height) = (image.width() as usize, image.height() as usize);
        Ok(Self { width, height, pixels: image.pixels().map(|pixel| pixel.0).collect() })
    }

    /// Linear, bilinear between the centres of pixels.
    fn sample(&self, [u, v]: [f32; 2]) -> [f32; 3] {
        let (columns, across) = neighbours(u, self.width);
        let (rows, down) = neighbours(v, self.height);
        let row = |row: usize| {
            let [a, b] = columns.map(|column| self.pixels[row * self.width + column].map(level));
            mix(a, b, across)
        };
        let [a, b] = rows.map(row);
        mix(a, b, down)
    }

    /// Of every texel of the atlas.
    pub fn variations(&self, mesh: &Mesh, atlas: &Atlas) -> Vec<Variation> {
        let texels = atlas.texels.iter();
        texels
            .map(|texel| {
                let uv = texel.interpolate(mesh.uvs[texel.triangle as usize]);
                Variation { albedo: self.sample(uv), ..Variation::default() }
            })
            .collect()
    }
}

/// The two pixels around a place of a period of `count` pixels, and how far the place is from the first to the second.
fn neighbours(place: f32, count: usize) -> ([usize; 2], f32) {
    let place = place.rem_euclid(1.0) * count as f32 - 0.5;
    let first = place.floor();
    let at = (first as i64).rem_euclid(count as i64) as usize;
    ([at, (at + 1) % count], place - first)
}

fn level(byte: u8) -> f32 {
    linear(f32::from(byte) / 255.0)
}

/// Within 0..=1 even where rounding would leave it.
fn mix(a: [f32; 3], b: [f32; 3], share: f32) -> [f32; 3] {
    std::array::from_fn(|k| (a[k] + (b[k] - a[k]) * share).clamp(0.0, 1.0))
}

/// Gives a body the texture in a file, or takes it away.
pub fn apply(
    body: &mut Body,
    queue: &wgpu::Queue,
    file: Option<&Path>,
    (mesh, atlas): (&Mesh, &Atlas),
) -> Result<(), Error> {
    let albedo = file.map(|file| Albedo::open(file, mesh)).transpose()?;
    let variations = albedo.map(|albedo| albedo.variations(mesh, atlas));
    Ok(body.set_variation(queue, variations.as_deref())?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use translume_mesh::{AtlasOptions, ChartSource, builtin};

    /// Columns of the texture.
    const WIDTH: u32 = 64;

    /// Red for u < 0.5, then white.
    fn half_red(directory: &Path, name: &str) -> PathBuf {
        let path = directory.join(name);
        let colour =
            |x, _| if x < WIDTH / 2 { image::Rgb([255, 0, 0]) } else { image::Rgb([255_u8, 255, 255]) };
        image::RgbImage::from_fn(WIDTH, 8, colour).save(&path).unwrap();
        path
    }

    /// A cube whose texture coordinates are x and y, moved by so much.
    fn cube(shift: f32) -> Mesh {
        let mut mesh = builtin::cuboid([0.0; 3], [1.0; 3], [4; 3]);
        let uv = |v: u32| [mesh.positions[v as usize][0] + shift, mesh.positions[v as usize][1]];
        mesh.uvs = mesh.triangles.iter().map(|triangle| triangle.map(uv)).collect();
        mesh
    }

    /// Texels away from where colours meet, and how many of them are red where x < 0.5 and white beyond.
    fn right(shift: f32) -> (usize, usize) {
        let directory = tempfile::tempdir().unwrap();
        let mesh = cube(shift);
        let options = AtlasOptions { size: 64, charts: ChartSource::Unwrap, ..Default::default() };
        let atlas = Atlas::build(&mesh, &options, |_| true).unwrap();
        let albedo = Albedo::open(&half_red(directory.path(), "half.png"), &mesh).unwrap();
        let variations = albedo.variations(&mesh, &atlas);
        assert_eq!(variations.len(), atlas.texels.len());
        let (mut count, mut good) = (0, 0);
        for (texel, variation) in atlas.texels.iter().zip(&variations) {
            let corners = mesh.triangles[texel.triangle as usize].map(|v| mesh.positions[v as usize]);
            let x = texel.interpolate(corners)[0];
            // Pixels of both colours are mixed within a pixel of where they meet, which is also where the texture repeats.
            let margin = 1.0 / WIDTH as f32;
            if [0.0, 0.5, 1.0].iter().all(|edge: &f32| (x - edge).abs() > margin) && (0.0..1.0).contains(&x) {
                let wanted = if x < 0.5 { [1.0, 0.0, 0.0] } else { [1.0; 3] };
                count += 1;
                good += usize::from(variation.albedo == wanted);
            }
        }
        (count, good)
    }

    #[test]
    fn texels_have_the_colour_of_their_place() {
        let (count, good) = right(0.0);
        assert!(count > 500 && good == count, "{good} of {count}");
        let (count, good) = right(3.0);
        assert_eq!(good, count, "the texture repeats");
        let (count, good) = right(0.25);
        // A quarter of the texture further, a half of the texels differ: those of two of four quarters.
        assert!(good < count * 3 / 4, "a wrong place must be noticed: {good} of {count}");
    }

    #[test]
    fn samples_are_linear_between_centres() {
        let albedo = Albedo { width: 2, height: 1, pixels: vec![[0; 3], [255; 3]] };
        // Places are powers of two: exact but for sRGB's own rounding.
        for (u, wanted) in [(0.25, 0.0), (0.75, 1.0), (0.5, 0.5), (0.0, 0.5), (-0.25, 1.0), (1.25, 0.0)] {
            assert!((albedo.sample([u, 7.3])[0] - wanted).abs() < 1e-6, "{u}");
        }
        let grey = Albedo { width: 1, height: 1, pixels: vec![[188; 3]] };
        // 188 is the byte of half the light, to half a step: 0.5 · 2.4 / 188.
        assert!((grey.sample([0.1, 0.9])[1] - 0.5).abs() < 0.0065);
    }

    #[test]
    fn what_cannot_be_read_is_said_in_words() {
        let directory = tempfile::tempdir().unwrap();
        let refused = |name: &str, mesh: &Mesh, words: &[&str]| {
            let message = Albedo::open(&directory.path().join(name), mesh).err().unwrap().to_string();
            assert!(words.iter().all(|word| message.contains(word)), "{message}");
        };
        let mesh = cube(0.0);
        refused("gone.png", &mesh, &["gone.png", "cannot be read"]);
        std::fs::write(directory.path().join("letter.png"), "dear texture").unwrap();
        refused("letter.png", &mesh, &["letter.png", "PNG"]);
        std::fs::write(directory.path().join("cut.jpg"), b"\xff\xd8\xff\xe0\0\x10JFIF\0").unwrap();
        refused("cut.jpg", &mesh, &["cut.jpg", "cannot be decoded"]);
        half_red(directory.path(), "half.png");
        refused("half.png", &Mesh { uvs: Vec::new(), ..mesh.clone() }, &["box", "texture coordinates"]);
        let path = half_red(directory.path(), "half.jpg");
        let [r, g, b] = Albedo::open(&path, &mesh).unwrap().sample([0.25, 0.5]);
        // Quantised: 2 % were never seen in a flat area.
        assert!(r > 0.98 && g < 0.02 && b < 0.02, "{r} {g} {b}");
    }
}
