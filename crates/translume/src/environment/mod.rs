//! Light from everywhere: an equirectangular map, nine spherical harmonics that hold what is smooth in it, and the suns that nine
//! cannot hold.

mod cube;
mod grid;
mod harmonics;
mod peaks;
#[cfg(test)]
mod tests;

pub use harmonics::EnvironmentLight;

use crate::Error;
use grid::Grid;

/// Equirectangular map of radiance, linear RGB, constant in each pixel.
///
/// y is up: row 0 touches +y, the last row −y. With u from 0 to 1 along a row, v from 0 to 1 downwards, θ = πv and φ = 2πu, light comes
/// from the direction (−cos φ sin θ, cos θ, −sin φ sin θ): u = 0 is −x, 0.25 is −z, 0.5 is +x, 0.75 is +z.
///
/// ```
/// use translume::{EnvironmentMap, Light};
///
/// // A grey sky over a dark ground, with one bright pixel for a sun.
/// let mut pixels = vec![[0.4_f32; 3]; 32 * 8];
/// pixels.extend(vec![[0.05; 3]; 32 * 8]);
/// pixels[5 * 32 + 7] = [900.0, 800.0, 600.0];
/// let map = EnvironmentMap::new(32, 16, pixels)?;
/// let (suns, sky) = map.split_peaks();
/// assert_eq!(suns.len(), 1);
/// let lights: Vec<Light> = suns.into_iter().map(Light::Directional).chain([Light::Environment(sky)]).collect();
/// # Ok::<(), translume::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentMap {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 3]>,
}

impl EnvironmentMap {
    /// `pixels`: row by row from the top, finite and not negative.
    ///
    /// # Errors
    /// [`Error::Environment`] if there are no pixels or not width × height of them, or names the column and row of a bad one.
    pub fn new(width: u32, height: u32, pixels: Vec<[f32; 3]>) -> Result<Self, Error> {
        if width == 0 || height == 0 {
            return Err(Error::Environment {
                problem: format!("{width} × {height} pixels are none"),
                remedy: "give at least one pixel",
            });
        }
        if pixels.len() as u64 != u64::from(width) * u64::from(height) {
            return Err(Error::Environment {
                problem: format!("{} pixels for {width} × {height}", pixels.len()),
                remedy: "give width × height pixels, row by row from the top",
            });
        }
        let possible = |pixel: &[f32; 3]| pixel.iter().all(|c| (0.0..=f32::MAX).contains(c));
        if let Some(bad) = pixels.iter().position(|pixel| !possible(pixel)) {
            let (column, row) = (bad % width as usize, bad / width as usize);
            return Err(Error::Environment {
                problem: format!("the pixel in column {column}, row {row} is {:?}", pixels[bad]),
                remedy: "radiance is finite and not negative",
            });
        }
        Ok(Self { width, height, pixels })
    }

    /// Pixels in a row.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Radiance of every pixel, row by row from the top.
    #[must_use]
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// The whole map as spherical harmonics. Every pixel is integrated in closed form, so the only loss is what lies above order 2:
    /// under a smooth sky a fraction of a percent of the irradiance, under a sun several percent (see [`split_peaks`](Self::split_peaks)).
    #[must_use]
    pub fn project(&self) -> EnvironmentLight {
        harmonics::project(&Grid::new(self.width, self.height), &self.pixels)
    }
}
