//! Suns and lamps in an environment map become directional lights: nine harmonics cannot hold them, and they cast shadows with edges.

use super::grid::Grid;
use super::{EnvironmentLight, EnvironmentMap, harmonics};
use crate::DirectionalLight;
use glam::DVec3;
use std::collections::BTreeSet;

/// A peak is brighter than this many times the mean luminance of the map.
const BRIGHTNESS: f64 = 8.0;
/// Of a peak at most, sr: a disc of 20°.
const SOLID_ANGLE: f64 = 0.1;
/// Length of the power-weighted mean direction, at least: rules out what is long and thin.
const CONCENTRATION: f64 = 0.99;
/// Share of the map's flux that a peak has to bring.
const SHARE: f64 = 0.01;
const MAX_PEAKS: usize = 8;

struct Peak {
    pixels: Vec<usize>,
    /// What stays in its pixels.
    level: [f32; 3],
    /// ∫ (L − level) dω.
    irradiance: [f64; 3],
    direction: DVec3,
}

impl EnvironmentMap {
    /// The small bright features of the map as directional lights with shadows, brightest first, and the rest as harmonics.
    ///
    /// A peak is a group of pixels above 8 times the map's mean luminance that touch by edge or corner (across u = 0 and at the poles
    /// too). It covers at most 0.1 sr; the mean of its directions, weighted by power, has a length of at least 0.99; and it brings at
    /// least 1 % of the map's flux. The brightest 8 are taken.
    ///
    /// A light carries ∫ (L − level) dω, where level is the mean radiance of the pixels around the group (of the group itself in a
    /// channel where that is less). In the rest the group's pixels have that level: nothing is lost and nothing counts twice.
    #[must_use]
    pub fn split_peaks(&self) -> (Vec<DirectionalLight>, EnvironmentLight) {
        let grid = Grid::new(self.width, self.height);
        let luminances = (0..self.pixels.len()).map(|pixel| (grid.moments(pixel)[0], self.luminance(pixel)));
        let flux: f64 = luminances.map(|(solid_angle, luminance)| solid_angle * luminance).sum();
        let threshold = BRIGHTNESS * flux / (4.0 * std::f64::consts::PI);
        let groups = self.groups(&grid, threshold).into_iter();
        let mut peaks: Vec<_> = groups.filter_map(|group| self.peak(&grid, group)).collect();
        peaks.retain(|peak| luminance(peak.irradiance) >= SHARE * flux);
        peaks.sort_by(|a, b| luminance(b.irradiance).total_cmp(&luminance(a.irradiance)));
        peaks.truncate(MAX_PEAKS);
        let mut rest = self.pixels.clone();
        for peak in &peaks {
            peak.pixels.iter().for_each(|&pixel| rest[pixel] = peak.level);
        }
        (peaks.iter().map(Peak::light).collect(), harmonics::project(&grid, &rest))
    }

    fn luminance(&self, pixel: usize) -> f64 {
        luminance(self.pixels[pixel].map(f64::from))
    }

    /// Connected pixels above a luminance.
    fn groups(&self, grid: &Grid, threshold: f64) -> Vec<Vec<usize>> {
        let mut unseen: Vec<_> =
            (0..self.pixels.len()).map(|pixel| self.luminance(pixel) > threshold).collect();
        let mut groups = Vec::new();
        for first in 0..self.pixels.len() {
            if !std::mem::take(&mut unseen[first]) {
                continue;
            }
            let mut group = vec![first];
            let mut done = 0;
            while done < group.len() {
                let near = neighbours(grid, group[done]);
                group.extend(near.filter(|&pixel| std::mem::take(&mut unseen[pixel])));
                done += 1;
            }
            groups.push(group);
        }
        groups
    }

    fn peak(&self, grid: &Grid, pixels: Vec<usize>) -> Option<Peak> {
        let solid_angle: f64 = pixels.iter().map(|&pixel| grid.moments(pixel)[0]).sum();
        let (power, direction) = self.power(grid, &pixels, 0.0);
        if solid_angle > SOLID_ANGLE || direction.length() < CONCENTRATION * luminance(power) {
            return None;
        }
        let ring = ring(grid, &pixels);
        let ring_angle: f64 = ring.iter().map(|&pixel| grid.moments(pixel)[0]).sum();
        let (around, _) = self.power(grid, &ring, 0.0);
        let level = std::array::from_fn(|c| (around[c] / ring_angle).min(power[c] / solid_angle) as f32);
        // Rounding of the level may leave less than nothing.
        let irradiance = std::array::from_fn(|c| (power[c] - f64::from(level[c]) * solid_angle).max(0.0));
        let (_, direction) = self.power(grid, &pixels, luminance(level.map(f64::from)));
        Some(Peak { pixels, level, irradiance, direction })
    }

    /// ∫ L dω, and ∫ (luminance − `level`)·direction dω.
    fn power(&self, grid: &Grid, pixels: &[usize], level: f64) -> ([f64; 3], DVec3) {
        let mut power = [0.0; 3];
        let mut direction = DVec3::ZERO;
        for &pixel in pixels {
            let [solid_angle, y, z, x, ..] = grid.moments(pixel);
            direction += (self.luminance(pixel) - level) * DVec3::new(x, y, z);
            power = std::array::from_fn(|c| power[c] + solid_angle * f64::from(self.pixels[pixel][c]));
        }
        (power, direction)
    }
}

impl Peak {
    fn light(&self) -> DirectionalLight {
        DirectionalLight {
            to_light: self.direction.normalize().as_vec3().to_array(),
            irradiance: self.irradiance.map(|c| c as f32),
            shadow: true,
            region: None,
        }
    }
}

/// ITU-R BT.709.
fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Pixels that share an edge or a corner with this one. All pixels of the first row meet at a pole, and all of the last. May repeat
/// itself, and holds the pixel too.
fn neighbours(grid: &Grid, pixel: usize) -> impl Iterator<Item = usize> {
    let (width, height) = (grid.width(), grid.height());
    let (column, row) = (pixel % width, pixel / width);
    (row.saturating_sub(1)..(row + 2).min(height)).flat_map(move |near| {
        let at_pole = near == row && (row == 0 || row + 1 == height);
        let columns = if at_pole { 0..width } else { column + width - 1..column + width + 2 };
        columns.map(move |k| near * width + k % width)
    })
}

/// Pixels around a group.
fn ring(grid: &Grid, group: &[usize]) -> Vec<usize> {
    let inside: BTreeSet<_> = group.iter().copied().collect();
    let near: BTreeSet<_> = group.iter().flat_map(|&pixel| neighbours(grid, pixel)).collect();
    near.difference(&inside).copied().collect()
}
