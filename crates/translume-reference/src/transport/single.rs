//! Light that scattered once, marched along a ray of view.

use glam::DVec3;

use super::coefficients::Coefficients;
use super::rays::Rays;
use super::source::Lamps;
use crate::dice::Dice;
use crate::lights::strata::cone;
use crate::path::lamp::{Aim, Lamp};
use crate::path::way::is_lit;
use crate::rgb::scale;
use std::f64::consts::PI;

/// Places on each inside part of a ray, at random in strata of equal weight.
const STEPS: u32 = 16;
/// Directions towards a light of some extent, from each.
const DIRECTIONS: u32 = 8;
/// What a ray has left behind dimmer than this is not worth marching.
const DIM: f64 = 1e-4;

/// Radiance in each channel along a ray through an index-matched body, W/(m² sr); `segments` are its inside parts.
pub(super) fn single(
    medium: &[Coefficients; 3],
    rays: &Rays<'_>,
    lamps: &Lamps,
    ((origin, direction), segments): ((DVec3, DVec3), &[[f64; 2]]),
    dice: &mut Dice,
) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let mut before = 0.0;
    for [from, to] in segments {
        for (k, channel) in medium.iter().enumerate() {
            let left = (-channel.extinction * before).exp();
            let share = -(-channel.extinction * (to - from)).exp_m1();
            if left < DIM {
                continue;
            }
            for step in 0..STEPS {
                let part = (f64::from(step) + dice.roll()) / f64::from(STEPS);
                let way = (-(-part * share).ln_1p() / channel.extinction).min(to - from);
                let at = origin + direction * (from + way);
                let light: f64 =
                    lamps.0.iter().map(|lamp| arriving(lamp, rays, channel, (at, k), dice)).sum();
                sum[k] += left * share / f64::from(STEPS) * channel.albedo / (4.0 * PI) * light;
            }
        }
        before += to - from;
    }
    sum
}

/// ∫ L dω over a light at a point of the volume, W/m².
fn arriving(
    lamp: &Lamp,
    rays: &Rays<'_>,
    medium: &Coefficients,
    (at, channel): (DVec3, usize),
    dice: &mut Dice,
) -> f64 {
    let count = if lamp.has_no_extent() { 1 } else { DIRECTIONS };
    let mut sum = 0.0;
    for _ in 0..count {
        let Some(aim) = towards(lamp, at, dice) else { continue };
        let segments = rays.segments(at, aim.direction, aim.distance);
        let Some([_, last]) = segments.last() else { continue };
        if is_lit(lamp.region(), at + aim.direction * *last) {
            let inside: f64 = segments.iter().map(|[from, to]| to - from).sum();
            sum += aim.light[channel] * (-medium.extinction * inside).exp();
        }
    }
    sum / f64::from(count)
}

/// A direction of a light that is most of the sky is any.
fn towards(lamp: &Lamp, at: DVec3, dice: &mut Dice) -> Option<Aim> {
    if lamp.is_aimed_at() {
        return lamp.aim(at, dice);
    }
    let (direction, _) = cone(DVec3::Y, 2.0, dice.pair());
    let sight = lamp.sight(at, direction)?;
    Some(Aim { direction, distance: sight.distance, light: scale(sight.radiance, 4.0 * PI), density: 0.0 })
}
