//! Spherical harmonics up to order 2: projection, rotation, and irradiance through a smooth surface.

use super::grid::Grid;
use crate::boundary::Boundary;
use glam::{DMat3, DVec3};

/// Light from everywhere, as nine spherical harmonics of radiance.
///
/// ```
/// use translume::{EnvironmentLight, EnvironmentMap};
///
/// let white = EnvironmentMap::new(8, 4, vec![[1.0; 3]; 32])?.project();
/// // Radiance 1 from everywhere is an irradiance of π, whichever way a surface faces.
/// let irradiance = white.irradiance(1.0, [0.0, 1.0, 0.0]);
/// assert!((irradiance[0] - std::f32::consts::PI).abs() < 1e-3);
/// # Ok::<(), translume::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentLight {
    /// RGB coefficients L of the real orthonormal harmonics, so that the radiance from a unit direction (x, y, z) is the sum of
    ///
    /// | index | band l, order m | harmonic |
    /// | --- | --- | --- |
    /// | 0 | 0, 0 | 0.282095 |
    /// | 1, 2, 3 | 1, −1 to 1 | 0.488603 · y, z, x |
    /// | 4, 5 | 2, −2 and −1 | 1.092548 · xy, yz |
    /// | 6 | 2, 0 | 0.315392 · (3z² − 1) |
    /// | 7 | 2, 1 | 1.092548 · xz |
    /// | 8 | 2, 2 | 0.546274 · (x² − y²) |
    ///
    /// each times its coefficient. x, y, z are the world's axes. There is no Condon–Shortley sign.
    pub coefficients: [[f32; 3]; 9],
    /// Whether the body occludes it.
    pub shadow: bool,
}

/// Makes the polynomials 1, y, z, x, xy, yz, 3z² − 1, xz, x² − y² orthonormal over the sphere.
const NORMS: [f64; 9] = [
    0.282_094_791_773_878_14,
    0.488_602_511_902_919_9,
    0.488_602_511_902_919_9,
    0.488_602_511_902_919_9,
    1.092_548_430_592_079_2,
    1.092_548_430_592_079_2,
    0.315_391_565_252_520_05,
    1.092_548_430_592_079_2,
    0.546_274_215_296_039_6,
];

const BANDS: [usize; 9] = [0, 1, 1, 1, 2, 2, 2, 2, 2];

impl Default for EnvironmentLight {
    /// Darkness.
    fn default() -> Self {
        Self { coefficients: [[0.0; 3]; 9], shadow: true }
    }
}

impl EnvironmentLight {
    /// The same light, turned: what came from direction d comes from `turn`·d.
    ///
    /// `turn`: a rotation, column-major. Exact: band 1 is a vector and band 2 a symmetric matrix without trace, and both turn as such.
    #[must_use]
    pub fn turned(&self, turn: [[f32; 3]; 3]) -> Self {
        let turn = DMat3::from_cols_array_2d(&turn.map(|column| column.map(f64::from)));
        let mut light = *self;
        for channel in 0..3 {
            let factors = std::array::from_fn(|k| f64::from(self.coefficients[k][channel]) * NORMS[k]);
            for (k, factor) in turned_factors(turn, factors).into_iter().enumerate() {
                light.coefficients[k][channel] = (factor / NORMS[k]) as f32;
            }
        }
        light
    }

    /// Irradiance inside a surface, ∫ L·F_t·cos dω, as the GPU computes it, never negative.
    ///
    /// `eta`: index of refraction inside over outside, above 0. `normal`: unit length.
    #[must_use]
    pub fn irradiance(&self, eta: f32, normal: [f32; 3]) -> [f32; 3] {
        irradiance(&self.through(&Boundary { eta, slant: [0.0; 3], on_surface: false }), normal)
    }

    /// Radiance from a unit direction as far as nine harmonics know it; negative where they swing below zero.
    #[must_use]
    pub fn radiance(&self, direction: [f32; 3]) -> [f32; 3] {
        let harmonics = polynomials(direction.map(f64::from));
        std::array::from_fn(|channel| {
            let term = |k: usize| f64::from(self.coefficients[k][channel]) * NORMS[k] * harmonics[k];
            (0..9).map(term).sum::<f64>() as f32
        })
    }

    /// Factors (RGB, 0) of the polynomials 1, y, z, x, xy, yz, 3z² − 1, xz, x² − y² of a normal whose sum is the irradiance inside
    /// the surface. `shaders/shared/environment.wgsl` sums them.
    ///
    /// By the theorem of Funk and Hecke a convolution with a lobe around the normal scales band l by the lobe's a_l, [`Boundary::lobe`]
    /// (Ramamoorthi and Hanrahan 2001, there for the plain cosine).
    pub(crate) fn through(&self, boundary: &Boundary) -> [[f32; 4]; 9] {
        let lobe = boundary.lobe();
        std::array::from_fn(|k| {
            let factor =
                |c: usize| (f64::from(self.coefficients[k][c]) * lobe[BANDS[k]][c] * NORMS[k]) as f32;
            [factor(0), factor(1), factor(2), 0.0]
        })
    }
}

/// Projects radiance, constant in each pixel, row by row.
pub(super) fn project(grid: &Grid, pixels: &[[f32; 3]]) -> EnvironmentLight {
    let mut sums = [[0.0_f64; 3]; 9];
    for (pixel, radiance) in pixels.iter().enumerate() {
        for (sum, moment) in sums.iter_mut().zip(grid.moments(pixel)) {
            for channel in 0..3 {
                sum[channel] += moment * f64::from(radiance[channel]);
            }
        }
    }
    let coefficients = std::array::from_fn(|k| sums[k].map(|sum| (sum * NORMS[k]) as f32));
    EnvironmentLight { coefficients, ..Default::default() }
}

/// The sum of `environment_irradiance` in WGSL. `factors`: of [`EnvironmentLight::through`].
pub(super) fn irradiance(factors: &[[f32; 4]; 9], normal: [f32; 3]) -> [f32; 3] {
    let values = polynomials(normal.map(f64::from));
    std::array::from_fn(|channel| {
        let sum: f64 =
            factors.iter().zip(values).map(|(factor, value)| f64::from(factor[channel]) * value).sum();
        sum.max(0.0) as f32
    })
}

fn polynomials([x, y, z]: [f64; 3]) -> [f64; 9] {
    [1.0, y, z, x, x * y, y * z, 3.0 * z * z - 1.0, x * z, x * x - y * y]
}

/// Factors of the polynomials after a turn: v ↦ Rv and M ↦ RMRᵀ.
fn turned_factors(turn: DMat3, [constant, y, z, x, xy, yz, zz, xz, xx_yy]: [f64; 9]) -> [f64; 9] {
    let vector = turn * DVec3::new(x, y, z);
    // 3z² − 1 is 2z² − x² − y² on the sphere.
    let form = DMat3::from_cols(
        DVec3::new(xx_yy - zz, 0.5 * xy, 0.5 * xz),
        DVec3::new(0.5 * xy, -xx_yy - zz, 0.5 * yz),
        DVec3::new(0.5 * xz, 0.5 * yz, 2.0 * zz),
    );
    let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = (turn * form * turn.transpose()).to_cols_array_2d();
    [constant, vector.y, vector.z, vector.x, 2.0 * xy, 2.0 * yz, 0.5 * zz, 2.0 * xz, 0.5 * (xx - yy)]
}
