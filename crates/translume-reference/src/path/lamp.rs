//! Lights as paths need them: a direction towards a light, and what a path meets that runs into one.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec3;

use super::Vantage;
use crate::dice::Dice;
use crate::lights::Region;
use crate::lights::beam::falloff;
use crate::lights::density::Density;
use crate::lights::strata::cone;
use crate::rgb::{mean, scale};
use crate::{EnvironmentMap, Light};

/// From this share of the sky on (1 − cos of the half angle; 60°) a cone is met often enough without looking for it.
const WIDE: f64 = 0.5;

/// A light made ready.
pub(crate) enum Lamp {
    Sun { to_light: DVec3, irradiance: [f64; 3], region: Option<Region> },
    Point { position: DVec3, intensity: [f64; 3], cone: Option<(DVec3, [f64; 2])>, region: Option<Region> },
    Cap { axis: DVec3, opening: f64, radiance: [f64; 3] },
    Rectangle { center: DVec3, halves: [DVec3; 2], radiance: [f64; 3] },
    Ball { center: DVec3, radius: f64, radiance: [f64; 3] },
    Map { map: Arc<EnvironmentMap>, density: Density },
}

/// A direction that light comes from.
pub(crate) struct Aim {
    pub direction: DVec3,
    /// How far away the light is, mm.
    pub distance: f64,
    /// Radiance over density; irradiance on a facing plane where one direction is all there is.
    pub light: [f64; 3],
    /// Density of the direction, 1/sr; infinite where one direction is all there is.
    pub density: f64,
}

/// What a ray meets.
pub(crate) struct Sight {
    /// How far away it is, mm.
    pub distance: f64,
    pub radiance: [f64; 3],
    /// Density with which [`Lamp::aim`] finds this direction, 1/sr; 0 if it is never asked.
    pub density: f64,
}

impl Lamp {
    /// `None` for a light that is black.
    pub fn new(light: &Light) -> Option<Self> {
        let lamp = match *light {
            Light::Directional { to_light, irradiance, region, .. } => {
                Self::Sun { to_light: to_light.into(), irradiance, region }
            }
            Light::Point { position, intensity, region, .. } => {
                Self::Point { position: position.into(), intensity, cone: None, region }
            }
            Light::Spot { position, direction, intensity, inner_angle, outer_angle, region, .. } => {
                let cone = Some((direction.into(), [inner_angle, outer_angle]));
                Self::Point { position: position.into(), intensity, cone, region }
            }
            Light::Ambient { radiance, axis, half_angle, .. } => {
                let opening = 2.0 * (0.5 * half_angle).sin().powi(2);
                Self::Cap { axis: axis.into(), opening, radiance }
            }
            Light::Rectangle { center, half_right, half_up, radiance, .. } => Self::Rectangle {
                center: center.into(),
                halves: [half_right.into(), half_up.into()],
                radiance,
            },
            Light::Sphere { center, radius, radiance, .. } => {
                Self::Ball { center: center.into(), radius, radiance }
            }
            Light::Environment { ref map, .. } => {
                let density = Density::new(map);
                if density.power() <= 0.0 {
                    return None;
                }
                Self::Map { map: Arc::clone(map), density }
            }
        };
        Some(lamp)
    }

    /// Whether no path can run into it.
    pub fn has_no_extent(&self) -> bool {
        matches!(self, Self::Sun { .. } | Self::Point { .. })
    }

    /// What all ways to it have in common.
    pub fn vantage(&self) -> Option<Vantage> {
        match self {
            Self::Sun { to_light, .. } => Some(Vantage::Direction(*to_light)),
            Self::Point { position, .. } => Some(Vantage::Point(*position)),
            _ => None,
        }
    }

    /// Whether light is looked for, and not only met.
    pub fn is_aimed_at(&self) -> bool {
        !matches!(self, Self::Cap { opening, .. } if *opening >= WIDE)
    }

    /// Where its light enters.
    pub fn region(&self) -> Option<Region> {
        match self {
            Self::Sun { region, .. } | Self::Point { region, .. } => *region,
            _ => None,
        }
    }

    /// A direction from `origin` towards it; `None` where none leads there.
    pub fn aim(&self, origin: DVec3, dice: &mut Dice) -> Option<Aim> {
        match self {
            Self::Sun { to_light, irradiance, .. } => Some(Aim {
                direction: *to_light,
                distance: f64::INFINITY,
                light: *irradiance,
                density: f64::INFINITY,
            }),
            Self::Point { position, intensity, cone, .. } => {
                let (direction, distance) = towards(origin, *position)?;
                let share = cone.map_or(1.0, |cone| falloff(cone, -direction));
                let light = scale(*intensity, share / (distance * distance));
                (share > 0.0).then_some(Aim { direction, distance, light, density: f64::INFINITY })
            }
            Self::Rectangle { center, halves, .. } => {
                let [u, v] = dice.pair().map(|x| 2.0 * x - 1.0);
                let (direction, _) = towards(origin, *center + halves[0] * u + halves[1] * v)?;
                self.aim_along(origin, direction)
            }
            Self::Ball { center, radius, .. } => {
                let (axis, distance) = towards(origin, *center).filter(|(_, distance)| distance > radius)?;
                self.aim_along(origin, cone(axis, opening(*radius, distance), dice.pair()).0)
            }
            Self::Cap { axis, opening, .. } => self.aim_along(origin, cone(*axis, *opening, dice.pair()).0),
            Self::Map { density, .. } => self.aim_along(origin, density.direction(dice.pair())),
        }
    }

    fn aim_along(&self, origin: DVec3, direction: DVec3) -> Option<Aim> {
        let sight = self.sight(origin, direction)?;
        let light = scale(sight.radiance, 1.0 / sight.density);
        Some(Aim { direction, distance: sight.distance, light, density: sight.density })
    }

    /// What a ray from `origin` meets.
    pub fn sight(&self, origin: DVec3, direction: DVec3) -> Option<Sight> {
        match self {
            Self::Sun { .. } | Self::Point { .. } => None,
            Self::Cap { axis, opening, radiance } => {
                // 1 − cos as half the square of the chord, which keeps its digits.
                let inside = 0.5 * axis.distance_squared(direction) <= *opening * (1.0 + 1e-12);
                let density = if self.is_aimed_at() { 1.0 / (TAU * opening) } else { 0.0 };
                inside.then_some(Sight { distance: f64::INFINITY, radiance: *radiance, density })
            }
            Self::Rectangle { center, halves, radiance } => {
                let normal = halves[0].cross(halves[1]);
                let facing = -normal.dot(direction);
                let distance = normal.dot(origin - *center) / facing;
                let place = origin + direction * distance - *center;
                let inside =
                    halves.iter().all(|half| half.dot(place).abs() <= half.length_squared() * (1.0 + 1e-12));
                // |normal| is a quarter of the area.
                let density = distance * distance / (4.0 * facing);
                (facing > 0.0 && distance > 0.0 && inside).then_some(Sight {
                    distance,
                    radiance: *radiance,
                    density,
                })
            }
            Self::Ball { center, radius, radiance } => {
                let (axis, distance) = towards(origin, *center).filter(|(_, distance)| distance > radius)?;
                let opening = opening(*radius, distance);
                let middle = distance * axis.dot(direction);
                let square = radius * radius - distance * distance + middle * middle;
                let inside = 0.5 * axis.distance_squared(direction) <= opening * (1.0 + 1e-12);
                inside.then(|| Sight {
                    distance: middle - square.max(0.0).sqrt(),
                    radiance: *radiance,
                    density: 1.0 / (TAU * opening),
                })
            }
            Self::Map { map, density } => {
                let radiance = map.radiance(direction.to_array());
                let density = mean(radiance) / density.power();
                (density > 0.0).then_some(Sight { distance: f64::INFINITY, radiance, density })
            }
        }
    }
}

fn towards(origin: DVec3, target: DVec3) -> Option<(DVec3, f64)> {
    let distance = origin.distance(target);
    (distance > 0.0).then(|| ((target - origin) / distance, distance))
}

/// 1 − cos of the half angle under which a sphere is seen, without cancellation.
pub(super) fn opening(radius: f64, distance: f64) -> f64 {
    let square = (radius / distance).powi(2);
    square / (1.0 + (1.0 - square).sqrt())
}
