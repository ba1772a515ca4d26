//! Light that scattered once, marched along a ray of view.

use glam::DVec3;

use super::coefficients::Coefficients;
use super::phase::{kept, spread};
use super::rays::Rays;
use super::source::Lamps;
use crate::dice::Dice;
use crate::fresnel::{refracted_cos, transmittance};
use crate::lights::strata::cone;
use crate::path::Crossing;
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

/// Radiance in each channel along a ray, W/(m² sr); `segments` are its inside parts, and it leaves at a cosine inside.
pub(super) fn single(
    medium: &[Coefficients; 3],
    rays: &Rays<'_>,
    lamps: &Lamps,
    ((origin, direction), segments, leaves): ((DVec3, DVec3), &[[f64; 2]], f64),
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
                let place = Place { at, direction, leaves, seen_along: before + way, channel: k };
                let light: f64 = lamps.0.iter().map(|lamp| arriving(lamp, rays, channel, &place, dice)).sum();
                sum[k] += left * share / f64::from(STEPS) * channel.albedo / (4.0 * PI) * light;
            }
        }
        before += to - from;
    }
    sum
}

/// Where a ray of view is met by light.
struct Place {
    at: DVec3,
    /// Of the ray of view, inwards, and its cosine at the surface.
    direction: DVec3,
    leaves: f64,
    /// How much of it is inside up to there, mm.
    seen_along: f64,
    channel: usize,
}

impl Place {
    /// How much more light from this direction, which comes in through this surface and so far inside, is scattered towards the eye than if it were scattered
    /// evenly. Light from all sides is.
    fn brighter(&self, medium: &Coefficients, lamp: &Lamp, (ray, normal): (DVec3, DVec3), way: f64) -> f64 {
        if medium.g == 0.0 || !lamp.is_aimed_at() {
            return 1.0;
        }
        let depth = medium.albedo * medium.extinction * (self.seen_along + way);
        1.0 + kept(spread(medium.g, depth, ray.dot(self.direction)), depth, [normal.dot(ray), self.leaves])
    }
}

/// ∫ L dω over a light at a point of the volume, W/m², as if it were scattered evenly.
fn arriving(lamp: &Lamp, rays: &Rays<'_>, medium: &Coefficients, place: &Place, dice: &mut Dice) -> f64 {
    let Place { at, channel, .. } = *place;
    let count = if lamp.has_no_extent() { 1 } else { DIRECTIONS };
    let mut sum = 0.0;
    for _ in 0..count {
        let Some(aim) = towards(lamp, at, dice) else { continue };
        if rays.ior != 1.0 {
            sum += refracted(lamp, rays, medium, place, &aim);
            continue;
        }
        let segments = rays.segments(at, aim.direction, aim.distance);
        let Some([_, last]) = segments.last() else { continue };
        if is_lit(lamp.region(), at + aim.direction * *last) {
            let inside: f64 = segments.iter().map(|[from, to]| to - from).sum();
            let brighter = if medium.g == 0.0 {
                1.0
            } else {
                let surface = rays.shape.first(at, aim.direction, true, f64::INFINITY);
                let normal = surface.map_or(aim.direction, |surface| surface.normal.normalize());
                place.brighter(medium, lamp, (aim.direction, normal), inside)
            };
            sum += aim.light[channel] * brighter * (-medium.extinction * inside).exp();
        }
    }
    sum / f64::from(count)
}

/// Steps towards the place where light enters that is bent towards another.
const BENDS: u32 = 16;

/// From a place inside, the direction in which light comes that comes from another outside, and where it enters.
fn bent_way(rays: &Rays<'_>, at: DVec3, outwards: DVec3) -> Option<(DVec3, Crossing)> {
    let leaves = |direction: DVec3| rays.shape.first(at, direction, true, f64::INFINITY);
    let mut ray = outwards;
    for _ in 0..BENDS {
        ray = rays.bent(outwards, leaves(ray)?.normal.normalize());
    }
    Some((ray, leaves(ray)?))
}

/// What of a lamp that is seen from a place outside in this direction gets there through a surface that refracts. Curved surfaces gather no light.
fn refracted(lamp: &Lamp, rays: &Rays<'_>, medium: &Coefficients, place: &Place, aim: &Aim) -> f64 {
    let Some((ray, entry)) = bent_way(rays, place.at, aim.direction) else { return 0.0 };
    let (normal, surface) = (entry.normal.normalize(), place.at + ray * entry.t);
    let outside = normal.dot(aim.direction);
    let is_dark = outside <= 0.0
        || !is_lit(lamp.region(), surface)
        || rays.shape.first(surface + normal * rays.offset, aim.direction, false, aim.distance).is_some();
    if is_dark {
        return 0.0;
    }
    let squeezed = outside / refracted_cos(rays.ior, outside);
    let brighter = place.brighter(medium, lamp, (ray, normal), entry.t);
    let enters = squeezed * transmittance(rays.ior, outside) * (-medium.extinction * entry.t).exp();
    aim.light[place.channel] * brighter * enters
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::Ball;

    #[test]
    fn light_is_bent_where_it_enters() {
        let ball = Ball { center: [0.0; 3], radius: 2.0 };
        let rays = Rays::new(&ball, 1.4);
        for at in [DVec3::new(0.0, 0.3, 0.5), DVec3::new(0.9, 0.0, 1.0), DVec3::new(0.2, -1.2, -0.4)] {
            let (ray, entry) = bent_way(&rays, at, DVec3::Z).unwrap();
            let normal = (at + ray * entry.t).normalize();
            // Snell's law, in the plane of incidence.
            let (outside, inside) = (normal.cross(DVec3::Z), normal.cross(ray));
            assert!((outside - 1.4 * inside).length() < 1e-3, "{at}: {outside} {inside}");
            assert!((outside - inside).length() > 0.02, "{at}: not bent");
        }
    }
}
