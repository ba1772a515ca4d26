//! An environment map as a light.
//!
//! Its brightest pixels are suns with a ray each. The rest is dim enough to sample. Unoccluded, it is a sum over pixels,
//! merged where there are many; half of the rays that test for occlusion follow the cosine and half the map, with the
//! balance heuristic (Veach and Guibas 1995), because a bright window covers few directions and a dim wall many.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use glam::DVec3;

use super::strata::hemisphere;
use super::{Emitter, Ray, Receiver};
use crate::EnvironmentMap;
use crate::rgb::{accumulate, mean, scale};

/// Pixels merge until this many rows are left, twice as many columns: blocks of 1.4°. Measured on maps of noise the sum
/// is within 1e-4 (see the tests).
const ROWS: usize = 128;

/// Rays² times the share of the map's power from which on a pixel has a ray of its own.
const SUN: f64 = 4.0;

/// A map made ready.
pub(super) struct Surroundings {
    suns: Vec<Patch>,
    /// The map without the suns, and merged.
    rest: EnvironmentMap,
    merged: Vec<Patch>,
    /// Power of the rest up to the end of each row, and within each row up to the end of each pixel.
    rows: Vec<f64>,
    pixels: Vec<f64>,
    shadow: bool,
}

/// A small part of the sky.
struct Patch {
    direction: DVec3,
    /// Radiance · solid angle.
    light: [f64; 3],
}

impl Surroundings {
    pub fn new(map: &EnvironmentMap, rays: u32, shadow: bool) -> Self {
        let [width, height] = map.size();
        let power = |column: usize, row: usize| mean(map.pixel(column, row)) * map.solid_angle(row);
        let cells = || (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        let total: f64 = cells().map(|(column, row)| power(column, row)).sum();
        let threshold = SUN / f64::from(rays.max(1)).powi(2) * total;
        let is_sun = |(column, row): (usize, usize)| power(column, row) > threshold;
        let suns = cells().filter(|&cell| is_sun(cell)).map(|(column, row)| Patch {
            direction: map.direction(column, row).into(),
            light: scale(map.pixel(column, row), map.solid_angle(row)),
        });
        let rest = cells().map(|cell| if is_sun(cell) { [0.0; 3] } else { map.pixel(cell.0, cell.1) });
        let rest = map.with_pixels(rest.collect());
        let powers: Vec<f64> =
            cells().map(|(column, row)| mean(rest.pixel(column, row)) * rest.solid_angle(row)).collect();
        let rows = running(powers.chunks(width).map(|row| row.iter().sum()));
        let pixels = powers.chunks(width).flat_map(|row| running(row.iter().copied())).collect();
        Self { suns: suns.collect(), merged: merged(&rest), rest, rows, pixels, shadow }
    }

    /// Light that enters from the rest if nothing is in the way.
    fn open(&self, receiver: &Receiver<'_>) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for patch in &self.merged {
            accumulate(&mut sum, patch.light, receiver.share(patch.direction));
        }
        sum
    }

    fn rays(&self, receiver: &Receiver<'_>) -> impl Iterator<Item = Ray> {
        let side = receiver.strata.side();
        let by_map = side / 2;
        let normal = receiver.at.normal;
        let around = receiver.strata.grid(side - by_map, 0).map(move |point| hemisphere(normal, point));
        let bright = receiver.strata.grid(by_map, side - by_map).map(|point| self.direction(point));
        let share = f64::from(by_map) / f64::from(side);
        let power = self.rows[self.rows.len() - 1];
        around.chain(bright).map(move |direction| {
            let light = self.rest.radiance(direction.to_array());
            let cosine = normal.dot(direction).max(0.0) * FRAC_1_PI;
            let density = (1.0 - share) * cosine + share * mean(light) / power;
            let weight = receiver.share(direction);
            let weight = if weight > 0.0 { weight / density } else { 0.0 };
            Ray { direction, distance: f64::INFINITY, weight: scale(light, weight) }
        })
    }

    /// A direction with density proportional to the rest's radiance.
    fn direction(&self, [u, v]: [f64; 2]) -> DVec3 {
        let [width, height] = self.rest.size();
        let (row, down) = pick(&self.rows, v);
        let (column, along) = pick(&self.pixels[row * width..][..width], u);
        let edge = |row: usize| (PI * row as f64 / height as f64).cos();
        let y = edge(row) + down * (edge(row + 1) - edge(row));
        let across = (1.0 - y * y).max(0.0).sqrt();
        let phi = TAU * (column as f64 + along) / width as f64;
        DVec3::new(-phi.cos() * across, y, -phi.sin() * across)
    }
}

impl Emitter for Surroundings {
    fn entering(&self, receiver: &Receiver<'_>) -> [f64; 3] {
        let open = self.open(receiver);
        let visible =
            if self.shadow && open != [0.0; 3] { receiver.visible(self.rays(receiver)) } else { [1.0; 3] };
        let mut sum = std::array::from_fn(|k| open[k] * visible[k]);
        for sun in &self.suns {
            let share = receiver.share(sun.direction);
            if share > 0.0 && !(self.shadow && receiver.blocked(sun.direction, f64::INFINITY)) {
                accumulate(&mut sum, sun.light, share);
            }
        }
        sum
    }
}

/// Blocks of pixels that are not black, each in the mean direction of its light.
fn merged(map: &EnvironmentMap) -> Vec<Patch> {
    let [width, height] = map.size();
    let (tall, wide) = ((height / ROWS).max(1), (width / (2 * ROWS)).max(1));
    let starts = (0..height).step_by(tall).flat_map(|row| (0..width).step_by(wide).map(move |c| (c, row)));
    let block = |(left, top): (usize, usize)| {
        let (mut light, mut direction) = ([0.0; 3], DVec3::ZERO);
        for row in top..(top + tall).min(height) {
            for column in left..(left + wide).min(width) {
                let each = scale(map.pixel(column, row), map.solid_angle(row));
                accumulate(&mut light, each, 1.0);
                direction += DVec3::from(map.direction(column, row)) * mean(each);
            }
        }
        Patch { direction: direction.normalize_or_zero(), light }
    };
    starts.map(block).filter(|patch| patch.light != [0.0; 3]).collect()
}

fn running(values: impl Iterator<Item = f64>) -> Vec<f64> {
    values
        .scan(0.0, |sum, value| {
            *sum += value;
            Some(*sum)
        })
        .collect()
}

/// The entry of a running sum that a share of the total falls into, never one that adds nothing, and how far into it.
fn pick(sums: &[f64], share: f64) -> (usize, f64) {
    let target = share * sums[sums.len() - 1];
    let index = sums.partition_point(|&sum| sum <= target).min(sums.len() - 1);
    let before = if index == 0 { 0.0 } else { sums[index - 1] };
    (index, (target - before) / (sums[index] - before))
}
