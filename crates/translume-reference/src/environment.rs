//! Light from infinitely far away, as a picture of all directions.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::fresnel::transmittance;
use crate::rgb::accumulate;

/// An equirectangular map of constant radiance in each pixel, W/(m² sr), y up.
///
/// With u from 0 to 1 along a row and v from 0 to 1 down the rows, a direction has the polar angle θ = πv from +y and the
/// azimuth φ = 2πu: (−cos φ sin θ, cos θ, −sin φ sin θ). So row 0 touches +y, and u = 0, ¼, ½, ¾ are −x, −z, +x, +z.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentMap {
    width: usize,
    height: usize,
    pixels: Vec<[f64; 3]>,
}

impl EnvironmentMap {
    /// A map of `width`·`height` pixels, row after row, each 0 or more. `None` if there are none or another number.
    #[must_use]
    pub fn new(width: usize, height: usize, pixels: Vec<[f64; 3]>) -> Option<Self> {
        let count = width.checked_mul(height)?;
        (count > 0 && count == pixels.len()).then_some(Self { width, height, pixels })
    }

    /// Radiance from a direction of any length but zero.
    #[must_use]
    pub fn radiance(&self, direction: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = direction;
        let u = (-z).atan2(-x) / TAU;
        let v = x.hypot(z).atan2(y) / PI;
        let cell = |at: f64, count: usize| ((at * count as f64) as usize).min(count - 1);
        // atan2 gives the second half of the row as negative; a tiny one becomes 1, which is the last column.
        let column = cell(if u < 0.0 { u + 1.0 } else { u }, self.width);
        self.pixels[cell(v, self.height) * self.width + column]
    }

    /// Unit vector to the middle of a pixel.
    #[must_use]
    pub fn direction(&self, column: usize, row: usize) -> [f64; 3] {
        let phi = TAU * (column as f64 + 0.5) / self.width as f64;
        let theta = PI * (row as f64 + 0.5) / self.height as f64;
        [-phi.cos() * theta.sin(), theta.cos(), -phi.sin() * theta.sin()]
    }

    /// Solid angle of each pixel of a row, sr.
    #[must_use]
    pub fn solid_angle(&self, row: usize) -> f64 {
        let step = PI / self.height as f64;
        // cos a − cos b as a product, which keeps its digits at the poles.
        let band = 2.0 * (step * (row as f64 + 0.5)).sin() * (0.5 * step).sin();
        band * TAU / self.width as f64
    }

    /// Irradiance that enters a surface with a unit normal if nothing is in the way: Σ L F_t cos⁺ dω over all pixels,
    /// each taken at its middle, W/m².
    #[must_use]
    pub fn irradiance(&self, eta: f64, normal: [f64; 3]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (direction, light) in self.lit_pixels() {
            let cos = direction.dot(normal.into());
            if cos > 0.0 {
                accumulate(&mut sum, light, transmittance(eta, cos) * cos);
            }
        }
        sum
    }

    pub(crate) fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    pub(crate) fn pixel(&self, column: usize, row: usize) -> [f64; 3] {
        self.pixels[row * self.width + column]
    }

    /// A map of the same size.
    pub(crate) fn with_pixels(&self, pixels: Vec<[f64; 3]>) -> Self {
        Self { pixels, ..*self }
    }

    /// The middle of every pixel that is not black, with its radiance times solid angle.
    fn lit_pixels(&self) -> impl Iterator<Item = (DVec3, [f64; 3])> {
        self.pixels.iter().enumerate().filter(|(_, pixel)| **pixel != [0.0; 3]).map(|(k, &pixel)| {
            let (column, row) = (k % self.width, k / self.width);
            (self.direction(column, row).into(), crate::rgb::scale(pixel, self.solid_angle(row)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fresnel::hemispherical_transmittance;
    use crate::testing::assert_rel;

    /// A number per pixel in every channel.
    fn map(width: usize, height: usize, value: impl Fn(usize, usize) -> f64) -> EnvironmentMap {
        let pixels = (0..width * height).map(|k| [value(k % width, k / width); 3]).collect();
        EnvironmentMap::new(width, height, pixels).expect("as many pixels as it says")
    }

    #[test]
    fn wrong_counts_are_refused() {
        assert!(EnvironmentMap::new(2, 2, vec![[1.0; 3]; 4]).is_some());
        assert!(EnvironmentMap::new(2, 2, vec![[1.0; 3]; 3]).is_none());
        assert!(EnvironmentMap::new(0, 2, Vec::new()).is_none());
        assert!(EnvironmentMap::new(usize::MAX, 2, vec![[1.0; 3]; 4]).is_none());
    }

    #[test]
    fn axes_lie_where_the_convention_says() {
        let numbers = map(4, 2, |column, row| (10 * row + column) as f64);
        let at = |direction| numbers.radiance(direction)[0];
        // Columns 0..4 begin at −x, −z, +x and +z; a little past the axis lies inside.
        assert_eq!(at([-1.0, 0.5, -0.1]), 0.0);
        assert_eq!(at([0.1, 0.5, -1.0]), 1.0);
        assert_eq!(at([1.0, 0.5, 0.1]), 2.0);
        assert_eq!(at([-0.1, 0.5, 1.0]), 3.0);
        assert_eq!(at([-1.0, -0.5, -0.1]), 10.0, "below the horizon is the second row");
        assert_eq!(at([-1.0, 0.5, 0.1]), 3.0, "just before −x the row ends: a mirrored map has 0 here");
        // The seam and the poles are some pixel of the map.
        for direction in [[-1.0, 0.0, 0.0], [-1.0, 1e-3, -0.0], [-1.0, 0.0, 1e-300], [0.0, 1.0, 0.0]] {
            assert!(at(direction) >= 0.0);
        }
        assert!(at([0.0, -1.0, 0.0]) >= 10.0);
    }

    #[test]
    fn middles_are_inside_their_pixels() {
        let numbers = map(7, 5, |column, row| (10 * row + column) as f64);
        for (column, row) in (0..5).flat_map(|row| (0..7).map(move |column| (column, row))) {
            let direction = numbers.direction(column, row);
            assert_eq!(numbers.radiance(direction)[0], (10 * row + column) as f64);
            let mirrored = [direction[0], direction[1], -direction[2]];
            // The middle column, 3, is its own mirror image.
            assert_eq!(numbers.radiance(mirrored)[0] == (10 * row + column) as f64, column == 3);
        }
    }

    #[test]
    fn pixels_cover_the_sphere() {
        for (width, height) in [(1, 1), (2, 1), (8, 4), (64, 32)] {
            let map = map(width, height, |_, _| 1.0);
            let total: f64 = (0..height).map(|row| map.solid_angle(row) * width as f64).sum();
            assert_rel(total, 4.0 * PI, 1e-14, "rounding");
        }
        // The polar band of a quarter turn each: 2π(1 − cos 45°).
        let quarters = map(8, 4, |_, _| 1.0);
        assert_rel(quarters.solid_angle(0) * 8.0, TAU * (1.0 - 0.5f64.sqrt()), 1e-14, "polar band");
        assert!((quarters.solid_angle(0) / quarters.solid_angle(1) - 1.0).abs() > 0.1, "rows differ");
    }

    #[test]
    fn constant_map_is_a_constant_sky() {
        let constant = map(256, 128, |_, _| 2.0);
        for eta in [1.0, 1.3, 1.5] {
            for normal in [DVec3::Y, DVec3::X, DVec3::new(0.3, -0.5, 0.7).normalize()] {
                let exact = 2.0 * PI * hemispherical_transmittance(eta);
                // Midpoints of pixels of 1/40 rad, and of a kink at the horizon: measured 7.5e-5 at most.
                assert_rel(constant.irradiance(eta, normal.to_array())[1], exact, 2e-4, "constant map");
            }
        }
        let brighter = map(256, 128, |_, row| if row < 3 { 2.2 } else { 2.0 });
        let light = brighter.irradiance(1.0, [0.0, 1.0, 0.0])[0];
        assert!((light / TAU - 1.0).abs() > 2e-4, "10 % more in three polar rows must be noticed");
    }

    #[test]
    fn bright_pixel_lights_its_side() {
        // Column 5 of 16 is between −z and +x, above the horizon.
        let sun = map(16, 8, |column, row| f64::from(u8::from((column, row) == (5, 2))));
        let lit = |normal: [f64; 3]| sun.irradiance(1.0, normal)[0] > 0.0;
        assert!(lit([0.0, 0.0, -1.0]) && lit([1.0, 0.0, 0.0]) && lit([0.0, 1.0, 0.0]));
        assert!(!lit([0.0, 0.0, 1.0]) && !lit([-1.0, 0.0, 0.0]) && !lit([0.0, -1.0, 0.0]));
        let direction = sun.direction(5, 2);
        assert_rel(sun.irradiance(1.0, direction)[0], sun.solid_angle(2), 1e-14, "facing it");
    }
}
