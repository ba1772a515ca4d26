//! Integrals over the pixels of an equirectangular map, in closed form.

use std::f64::consts::{PI, TAU};

/// The integral of a polynomial over a pixel is a sum of products of one number of its row and one of its column.
pub(super) struct Grid {
    /// ∫ sin, sin·cos, sin², sin²·cos, sin³, sin·cos² dθ.
    rows: Vec<[f64; 6]>,
    /// ∫ 1, cos, sin, cos², sin², cos·sin dφ.
    columns: Vec<[f64; 6]>,
}

impl Grid {
    pub(super) fn new(width: u32, height: u32) -> Self {
        Self { rows: intervals(height, PI, polar), columns: intervals(width, TAU, azimuthal) }
    }

    pub(super) fn width(&self) -> usize {
        self.columns.len()
    }

    pub(super) fn height(&self) -> usize {
        self.rows.len()
    }

    /// ∫ 1, y, z, x, xy, yz, 3z² − 1, xz, x² − y² dω over a pixel; the first is its solid angle, sr.
    pub(super) fn moments(&self, pixel: usize) -> [f64; 9] {
        let [s, sc, ss, ssc, sss, scc] = self.rows[pixel / self.width()];
        let [one, cos, sin, cos_cos, sin_sin, cos_sin] = self.columns[pixel % self.width()];
        [
            s * one,
            sc * one,
            -ss * sin,
            -ss * cos,
            -ssc * cos,
            -ssc * sin,
            3.0 * sss * sin_sin - s * one,
            sss * cos_sin,
            sss * cos_cos - scc * one,
        ]
    }
}

/// Differences of primitives over `count` equal parts of 0..`end`.
fn intervals(count: u32, end: f64, primitives: fn(f64) -> [f64; 6]) -> Vec<[f64; 6]> {
    let at = |k: u32| primitives(end * f64::from(k) / f64::from(count));
    (0..count)
        .map(|k| {
            let (low, high) = (at(k), at(k + 1));
            std::array::from_fn(|m| high[m] - low[m])
        })
        .collect()
}

fn polar(angle: f64) -> [f64; 6] {
    let (sin, cos) = angle.sin_cos();
    let cube = cos.powi(3) / 3.0;
    [-cos, 0.5 * sin * sin, 0.5 * (angle - sin * cos), sin.powi(3) / 3.0, cube - cos, -cube]
}

fn azimuthal(angle: f64) -> [f64; 6] {
    let (sin, cos) = angle.sin_cos();
    [angle, sin, -cos, 0.5 * (angle + sin * cos), 0.5 * (angle - sin * cos), 0.5 * sin * sin]
}
