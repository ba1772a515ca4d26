//! Light as it leaves its source, towards a body.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::lamp::{Lamp, opening};
use crate::dice::Dice;
use crate::lights::beam::falloff;
use crate::lights::strata::{cone, disc, frame};
use crate::rgb::{mean, scale};

/// A sphere around the body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub center: DVec3,
    /// mm.
    pub radius: f64,
}

/// Where light goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    pub origin: DVec3,
    /// Unit vector.
    pub direction: DVec3,
    /// Power over the density of the ray, W.
    pub power: [f64; 3],
}

impl Bounds {
    /// The smallest cone from a point that holds the sphere: its axis, and 1 − cos of its half angle.
    fn seen_from(&self, point: DVec3) -> (DVec3, f64) {
        let (offset, distance) = (self.center - point, self.center.distance(point));
        if distance > self.radius {
            (offset / distance, opening(self.radius, distance))
        } else {
            (DVec3::Y, 2.0)
        }
    }

    /// Of a disc across it.
    fn area(&self) -> f64 {
        PI * self.radius * self.radius
    }

    /// A ray from a direction through a place of the disc across.
    fn ray(&self, to_light: DVec3, place: [f64; 2], power: [f64; 3]) -> Ray {
        let [x, y] = disc(place);
        let origin = self.center + frame(to_light) * DVec3::new(x, y, 1.0) * self.radius;
        Ray { origin, direction: -to_light, power }
    }
}

impl Lamp {
    /// A ray towards the body. `place` in the unit square tells where it goes as far as the light leaves a choice, neighbours to
    /// neighbours; uniform places make a power that is right on average.
    pub(super) fn emit(&self, bounds: &Bounds, place: [f64; 2], dice: &mut Dice) -> Ray {
        match self {
            Self::Sun { to_light, irradiance, .. } => {
                bounds.ray(*to_light, place, scale(*irradiance, bounds.area()))
            }
            Self::Point { position, intensity, cone: spot, .. } => {
                let around_body = bounds.seen_from(*position);
                let around_light = spot.map(|(axis, [_, outer])| (axis, 1.0 - outer.cos()));
                let narrower = around_light.filter(|other| other.1 < around_body.1);
                let (axis, opening) = narrower.unwrap_or(around_body);
                let direction = cone(axis, opening, place).0;
                let share = spot.map_or(1.0, |spot| falloff(spot, direction));
                Ray { origin: *position, direction, power: scale(*intensity, share * TAU * opening) }
            }
            Self::Rectangle { center, halves, radiance } => {
                let [u, v] = dice.pair().map(|x| 2.0 * x - 1.0);
                let origin = *center + halves[0] * u + halves[1] * v;
                leaving(bounds, origin, halves[0].cross(halves[1]) * 4.0, *radiance, place)
            }
            Self::Ball { center, radius, radiance } => {
                let normal = cone(DVec3::Y, 2.0, dice.pair()).0;
                let area = 4.0 * PI * radius * radius;
                leaving(bounds, *center + normal * *radius, normal * area, *radiance, place)
            }
            Self::Cap { axis, opening, radiance } => {
                let to_light = cone(*axis, *opening, dice.pair()).0;
                bounds.ray(to_light, place, scale(*radiance, TAU * opening * bounds.area()))
            }
            Self::Map { map, density } => {
                let to_light = density.direction(dice.pair());
                let radiance = map.radiance(to_light.to_array());
                let all = density.power() * bounds.area() / mean(radiance).max(f64::MIN_POSITIVE);
                bounds.ray(to_light, place, scale(radiance, all))
            }
        }
    }
}

/// From an area, given along its normal.
fn leaving(bounds: &Bounds, origin: DVec3, area: DVec3, radiance: [f64; 3], place: [f64; 2]) -> Ray {
    let (axis, opening) = bounds.seen_from(origin);
    let direction = cone(axis, opening, place).0;
    let power = scale(radiance, area.dot(direction).max(0.0) * TAU * opening);
    Ray { origin, direction, power }
}
