//! Directions chosen by the radiance of a map.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::EnvironmentMap;
use crate::rgb::mean;

/// A density over directions, proportional to a map's mean radiance.
pub(crate) struct Density {
    /// Power up to the end of each row.
    rows: Vec<f64>,
    /// Within each row, power up to the end of each pixel.
    pixels: Vec<Vec<f64>>,
}

impl Density {
    pub fn new(map: &EnvironmentMap) -> Self {
        let [width, height] = map.size();
        let power = |column: usize, row: usize| mean(map.pixel(column, row)) * map.solid_angle(row);
        let pixels: Vec<Vec<f64>> =
            (0..height).map(|row| running((0..width).map(|column| power(column, row)))).collect();
        Self { rows: running(pixels.iter().map(|row| row[width - 1])), pixels }
    }

    /// Mean radiance times solid angle of the whole map.
    pub fn power(&self) -> f64 {
        self.rows[self.rows.len() - 1]
    }

    /// The direction that belongs to a point of the unit square. The map must not be black.
    pub fn direction(&self, [u, v]: [f64; 2]) -> DVec3 {
        let (row, down) = pick(&self.rows, v);
        let (column, along) = pick(&self.pixels[row], u);
        let edge = |row: usize| (PI * row as f64 / self.rows.len() as f64).cos();
        let y = edge(row) + down * (edge(row + 1) - edge(row));
        let across = (1.0 - y * y).max(0.0).sqrt();
        let phi = TAU * (column as f64 + along) / self.pixels[row].len() as f64;
        DVec3::new(-phi.cos() * across, y, -phi.sin() * across)
    }
}

pub(crate) fn running(values: impl Iterator<Item = f64>) -> Vec<f64> {
    values
        .scan(0.0, |sum, value| {
            *sum += value;
            Some(*sum)
        })
        .collect()
}

/// The entry of a running sum that a share of the total falls into, never one that adds nothing, and how far into it.
pub(crate) fn pick(sums: &[f64], share: f64) -> (usize, f64) {
    let target = share * sums[sums.len() - 1];
    let index = sums.partition_point(|&sum| sum <= target).min(sums.len() - 1);
    let before = if index == 0 { 0.0 } else { sums[index - 1] };
    (index, (target - before) / (sums[index] - before))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lights::strata::Strata;

    #[test]
    fn directions_follow_the_map() {
        let mut pixels = vec![[0.0; 3]; 8 * 4];
        (pixels[1], pixels[2 * 8 + 6]) = ([1.0; 3], [3.0; 3]);
        let two = EnvironmentMap::new(8, 4, pixels).expect("as many pixels as it says");
        let density = Density::new(&two);
        let first = Strata::new(64, DVec3::ZERO, 0)
            .points()
            .map(|point| two.radiance(density.direction(point).to_array())[0])
            .inspect(|&radiance| assert!(radiance > 0.0, "only lit pixels are looked at"))
            .filter(|&radiance| radiance == 1.0)
            .count();
        let expected = two.solid_angle(0) / (two.solid_angle(0) + 3.0 * two.solid_angle(2));
        // One row of 64 is split between the two pixels.
        assert!((first as f64 / 4096.0 - expected).abs() < 1.0 / 64.0, "{first} {expected}");
    }

    #[test]
    fn nothing_black_is_picked() {
        let sums = [0.0, 1.0, 1.0, 4.0];
        assert_eq!(pick(&sums, 0.0), (1, 0.0));
        assert_eq!(pick(&sums, 0.25), (3, 0.0));
        assert_eq!(pick(&sums, 0.625), (3, 0.5));
    }
}
