//! An environment map as a light.
//!
//! Its brightest pixels are suns with a ray each. The rest is dim enough to sample. Unoccluded, it is a sum over pixels,
//! merged where there are many; half of the rays that test for occlusion follow the cosine and half the map, with the
//! balance heuristic (Veach and Guibas 1995), because a bright window covers few directions and a dim wall many.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::density::Density;
use super::strata::hemisphere;
use super::{Emitter, Ray, Receiver};
use crate::EnvironmentMap;
use crate::rgb::{accumulate, mean, product, scale};

/// Pixels merge until this many rows are left, twice as many columns: blocks of 1.4°. Measured on maps of tinted noise the
/// sum is within 1e-4 (see the tests), on three unrelated channels of four decades within 2e-4.
const ROWS: usize = 128;

/// Rays² times the share of the map's power from which on a pixel has a ray of its own.
const SUN: f64 = 4.0;

/// A map made ready.
pub(super) struct Surroundings {
    suns: Vec<Patch>,
    /// The map without the suns, and merged.
    rest: EnvironmentMap,
    merged: Vec<Patch>,
    density: Density,
    shadow: bool,
}

/// A small part of the sky.
struct Patch {
    /// Mean of the directions in it, by light: its length falls short of 1 so that cosines come out as their mean.
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
        let density = Density::new(&rest);
        Self { suns: suns.collect(), merged: merged(&rest), density, rest, shadow }
    }

    /// Light that enters from the rest if nothing is in the way.
    fn open(&self, receiver: &Receiver<'_>) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for patch in &self.merged {
            accumulate(&mut sum, product(patch.light, receiver.share(patch.direction)), 1.0);
        }
        sum
    }

    fn rays(&self, receiver: &Receiver<'_>) -> impl Iterator<Item = Ray> {
        let side = receiver.strata.side();
        let by_map = side / 2;
        let normal = receiver.at.normal;
        let around = receiver.strata.grid(side - by_map, 0).map(move |point| hemisphere(normal, point));
        let bright = receiver.strata.grid(by_map, side - by_map).map(|point| self.density.direction(point));
        let share = f64::from(by_map) / f64::from(side);
        let power = self.density.power();
        around.chain(bright).map(move |direction| {
            let light = self.rest.radiance(direction.to_array());
            let cosine = normal.dot(direction).max(0.0) * FRAC_1_PI;
            let density = (1.0 - share) * cosine + share * mean(light) / power;
            let share = receiver.share(direction);
            let weight = if share == [0.0; 3] { share } else { scale(product(light, share), 1.0 / density) };
            Ray { direction, distance: f64::INFINITY, weight }
        })
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
            if share != [0.0; 3] && !(self.shadow && receiver.blocked(sun.direction, f64::INFINITY)) {
                accumulate(&mut sum, product(sun.light, share), 1.0);
            }
        }
        sum
    }
}

/// Blocks of pixels that are not black.
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
        Patch { direction: direction / mean(light), light }
    };
    starts.map(block).filter(|patch| patch.light != [0.0; 3]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lights::strata::Strata;
    use crate::testing::{assert_rel, entering, half_roof, nothing, ring, wall};
    use crate::{Light, Surface};
    use std::f64::consts::{PI, TAU};
    use std::sync::Arc;

    const UP: [f64; 3] = [0.0, 1.0, 0.0];

    fn map(width: usize, height: usize, value: impl Fn(usize, usize) -> [f64; 3]) -> EnvironmentMap {
        let pixels = (0..width * height).map(|k| value(k % width, k / width)).collect();
        EnvironmentMap::new(width, height, pixels).expect("as many pixels as it says")
    }

    /// Noise over four decades with half a decade of tint, and a sun.
    fn noise(width: usize, height: usize) -> EnvironmentMap {
        let points: Vec<_> =
            Strata::new((width * height).isqrt() as u32 + 1, DVec3::ZERO, 0).points().collect();
        let random = |k: usize, axis: usize| (points[k % points.len()][axis] * 1e3).fract();
        map(width, height, |column, row| {
            let k = row * width + column;
            let sun = if (column, row) == (width / 3, height / 4) { (width * height) as f64 } else { 0.0 };
            [(k, 1), (k + 7, 0), (k + 7, 1)]
                .map(|(tint, axis)| 10.0f64.powf(4.0 * random(k, 0) + 0.5 * random(tint, axis) - 3.0) + sun)
        })
    }

    fn surroundings(map: &EnvironmentMap, shadow: bool) -> Light {
        Light::Environment { map: Arc::new(map.clone()), shadow }
    }

    fn at_origin(surface: &Surface, map: &EnvironmentMap, eta: f64, rays: u32) -> [f64; 3] {
        entering(surface, &surroundings(map, true), eta, rays, [0.0; 3], UP)
    }

    #[test]
    fn merged_pixels_are_the_sum_over_all() {
        for (width, height, tolerance) in [(64, 32, 1e-12), (512, 256, 1e-4), (700, 400, 1e-4)] {
            let map = noise(width, height);
            let mut worst = 0.0f64;
            for k in 0..12 {
                let (height, turn) = (f64::from(k) / 6.0 - 0.95, f64::from(k) * 2.4);
                let normal = [turn.cos(), height, turn.sin()];
                let normal = DVec3::from(normal).normalize().to_array();
                let exact = map.irradiance(1.3, normal);
                let light = entering(&nothing(), &surroundings(&map, false), 1.3, 16, [0.0; 3], normal);
                worst = (0..3).map(|c| (light[c] / exact[c] - 1.0).abs()).fold(worst, f64::max);
            }
            // Without merging, rounding; blocks of 1.4°: measured 4e-5 at most.
            assert!(worst < tolerance, "{width}·{height}: {worst:e}");
            assert!(width == 64 || worst > 1e-12, "blocks must have been merged here");
        }
    }

    #[test]
    fn constant_map_is_a_sky_behind_whatever_it_is() {
        let constant = map(64, 32, |_, _| [2.0, 1.0, 0.5]);
        let sky = Light::Ambient { radiance: [2.0, 1.0, 0.5], axis: UP, half_angle: PI, shadow: true };
        for surface in [nothing(), wall(), ring([0.0, 1.0], 1.0), ring([0.7, 1e6], 1.0)] {
            let exact = entering(&surface, &sky, 1.3, 64, [0.0; 3], UP);
            let light = at_origin(&surface, &constant, 1.3, 32);
            for c in 0..3 {
                // Rims as on the sky; the map's pixels cost 0.1 %. Measured 1.4 % at most.
                assert_rel(light[c], exact[c], 0.02, "constant map");
            }
        }
    }

    #[test]
    fn window_half_hidden_is_half() {
        // 30 · 20 pixels around −z and 45°, symmetric about the plane x = 0 the wall hides half of.
        let inside =
            |column: usize, row: usize| (113..143).contains(&(column + 64)) && (22..42).contains(&row);
        let window = map(256, 128, |column, row| if inside(column, row) { [1.0; 3] } else { [1e-4; 3] });
        let open = at_origin(&nothing(), &window, 1.3, 1)[0];
        // Half the 256 rays look at the window: measured 0.7 %.
        assert_rel(at_origin(&wall(), &window, 1.3, 16)[0], 0.5 * open, 0.03, "half");
    }

    #[test]
    fn sun_has_a_hard_edge() {
        let sun = map(64, 32, |column, row| [f64::from(u8::from((column, row) == (10, 9))); 3]);
        let to_sun = sun.direction(10, 9);
        // Where the sun stands behind the edge of a roof at height 1.
        let edge = to_sun[0] / to_sun[1];
        let open = sun.irradiance(1.3, UP)[0];
        for offset in [1e-9, 1e-3, 0.3] {
            assert_rel(at_origin(&half_roof(edge + offset, 1.0), &sun, 1.3, 4)[0], open, 1e-12, "lit");
            assert_eq!(at_origin(&half_roof(edge - offset, 1.0), &sun, 1.3, 4)[0], 0.0);
        }
        let one_ray = at_origin(&half_roof(edge - 1e-9, 1.0), &sun, 1.3, 1)[0];
        assert!(one_ray > 0.0, "one ray for the whole sky cannot find the sun");
    }

    /// Turning the map by whole columns and all else with it changes nothing; turning it the other way does.
    #[test]
    fn map_and_scene_turn_together() {
        let bright = |column: usize, row: usize| if (column, row) == (21, 8) { 300.0 } else { 1.0 };
        let original =
            map(64, 32, |column, row| [bright(column, row) + 0.1 * (column as f64 - 20.0).abs(); 3]);
        let turn = TAU * 8.0 / 64.0;
        let shifted = |by: usize| map(64, 32, |column, row| original.pixel((column + by) % 64, row));
        let (sin, cos) = turn.sin_cos();
        let about_y = |[x, y, z]: [f64; 3]| [x * cos - z * sin, y, x * sin + z * cos];
        let turned =
            Surface::flat(wall().positions.iter().map(|&p| about_y(p)).collect(), wall().triangles.clone());
        let normal = DVec3::new(-0.6, 0.4, 0.7).normalize().to_array();
        let shaded = |surface: &Surface, map: &EnvironmentMap, normal| {
            entering(surface, &surroundings(map, true), 1.3, 32, [0.0; 3], normal)[0]
        };
        let before = shaded(&wall(), &original, normal);
        let after = shaded(&turned, &shifted(64 - 8), about_y(normal));
        assert_rel(after, before, 0.02, "noise of the rest, measured 0.7 %; the sun is exact");
        assert!((shaded(&turned, &shifted(8), about_y(normal)) / before - 1.0).abs() > 0.05, "mirrored");
        let open = entering(&nothing(), &surroundings(&original, false), 1.3, 32, [0.0; 3], normal)[0];
        let open_after =
            entering(&nothing(), &surroundings(&shifted(64 - 8), false), 1.3, 32, [0.0; 3], about_y(normal))
                [0];
        assert_rel(open_after, open, 1e-12, "rounding");
        assert!((before / open - 1.0).abs() > 0.05, "the wall takes something");
    }

    #[test]
    fn black_map_is_dark() {
        assert_eq!(at_origin(&wall(), &map(4, 2, |_, _| [0.0; 3]), 1.3, 8), [0.0; 3]);
        let below = map(4, 2, |_, row| [row as f64, 0.0, 0.0]);
        assert!(at_origin(&nothing(), &below, 1.3, 8)[0] < 1e-12, "all light is below the horizon");
    }
}
