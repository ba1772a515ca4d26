//! What illuminates the surface, and how much of it enters.
//!
//! Lights of some extent are exact where nothing is in the way. Where something may be, that value is taken times the
//! visible share: of the rays' summed weights, that of the rays that get through. The share is exactly 1 or 0 where all
//! or none do, and between them the quotient's bias falls with the square of the number of rays.

mod ambient;
pub(crate) mod beam;
pub(crate) mod density;
mod environment;
mod polygon;
mod receiver;
mod rectangle;
mod solid_angle;
mod sphere;
pub(crate) mod strata;

use std::sync::Arc;

use glam::DVec3;

pub use ambient::ambient_transmittance;
pub(crate) use receiver::Place;

use crate::rgb::accumulate;
use crate::{Boundary, EnvironmentMap, Surface};
use ambient::Sky;
use beam::{Lamp, Sun};
use environment::Surroundings;
use receiver::{Ray, Receiver};
use rectangle::Rectangle;
use sphere::Sphere;
use strata::Strata;

/// Axis-aligned box, low and high corner in mm; light enters the surface only inside it.
pub type Region = ([f64; 3], [f64; 3]);

/// A light. Colours are linear RGB.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Light {
    /// Parallel light.
    Directional {
        /// Unit vector from the object towards the light.
        to_light: [f64; 3],
        /// Irradiance on a plane that faces the light, W/m².
        irradiance: [f64; 3],
        /// Whether the object shades itself.
        shadow: bool,
        /// Where the light enters; everywhere if `None`.
        region: Option<Region>,
    },
    /// A point that shines equally in all directions, falling off with the inverse square.
    Point {
        /// Position, mm.
        position: [f64; 3],
        /// Radiant intensity, W/sr; irradiance is intensity · cos / distance² with the distance in mm.
        intensity: [f64; 3],
        /// Whether the object shades itself.
        shadow: bool,
        /// Where the light enters; everywhere if `None`.
        region: Option<Region>,
    },
    /// A point that shines into a cone, as in the glTF extension `KHR_lights_punctual`.
    Spot {
        /// Position, mm.
        position: [f64; 3],
        /// Where it shines to; any length but zero.
        direction: [f64; 3],
        /// Radiant intensity inside the inner angle, W/sr, with distances in mm.
        intensity: [f64; 3],
        /// Angle from the axis where it begins to darken, radians.
        inner_angle: f64,
        /// Angle from the axis where it is dark, radians.
        outer_angle: f64,
        /// Whether the object shades itself.
        shadow: bool,
        /// Where the light enters; everywhere if `None`.
        region: Option<Region>,
    },
    /// Uniform radiance from a cone of the sky, cut off by the horizon of each point.
    Ambient {
        /// Radiance inside the cone, W/(m² sr).
        radiance: [f64; 3],
        /// Unit vector towards the middle of the cone.
        axis: [f64; 3],
        /// Half opening angle of the cone, radians; π is the whole sky.
        half_angle: f64,
        /// Whether the object shades itself.
        shadow: bool,
    },
    /// A rectangle of uniform radiance that shines to the side where `half_right` × `half_up` points.
    Rectangle {
        /// Middle, mm.
        center: [f64; 3],
        /// From the middle to the middle of one edge, mm.
        half_right: [f64; 3],
        /// From the middle to the middle of the next edge, mm; at right angles to `half_right`.
        half_up: [f64; 3],
        /// Radiance, W/(m² sr).
        radiance: [f64; 3],
        /// Whether the object shades itself.
        shadow: bool,
    },
    /// A sphere of uniform radiance that shines outwards; it gives nothing to what is inside it.
    Sphere {
        /// Middle, mm.
        center: [f64; 3],
        /// Radius, mm.
        radius: f64,
        /// Radiance, W/(m² sr).
        radiance: [f64; 3],
        /// Whether the object shades itself.
        shadow: bool,
    },
    /// Radiance from all directions, cut off by the horizon of each point.
    Environment {
        /// The radiance of each direction.
        map: Arc<EnvironmentMap>,
        /// Whether the object shades itself.
        shadow: bool,
    },
}

impl Light {
    /// Whether it takes many rays, and casts no sharp shadow.
    pub(crate) fn is_soft(&self) -> bool {
        match *self {
            Self::Directional { .. } | Self::Point { .. } | Self::Spot { .. } => false,
            Self::Ambient { shadow, .. }
            | Self::Rectangle { shadow, .. }
            | Self::Sphere { shadow, .. }
            | Self::Environment { shadow, .. } => shadow,
        }
    }
}

/// The lights of a scene with what does not depend on the place.
pub(crate) struct Lighting<'a> {
    surface: &'a Surface,
    emitters: Vec<Box<dyn Emitter>>,
    boundary: Boundary,
    rays: u32,
}

impl<'a> Lighting<'a> {
    /// `rays`² directions for each light that has an extent and a shadow.
    pub fn new(surface: &'a Surface, lights: &[Light], boundary: Boundary, rays: u32) -> Self {
        let emitters = lights.iter().map(|light| emitter(light, &boundary, rays)).collect();
        Self { surface, emitters, boundary, rays }
    }

    /// Irradiance that entered: Σ L · F_t · g · cos, W/m².
    pub fn irradiance(&self, at: Place) -> [f64; 3] {
        let mut sum = [0.0; 3];
        if at.normal == DVec3::ZERO {
            return sum;
        }
        for (index, emitter) in self.emitters.iter().enumerate() {
            let strata = Strata::new(self.rays, at.position, index);
            let receiver = Receiver { surface: self.surface, boundary: self.boundary, at, strata };
            accumulate(&mut sum, emitter.entering(&receiver), 1.0);
        }
        sum
    }
}

/// A light made ready.
trait Emitter: Send + Sync {
    /// Irradiance that enters a receiver, W/m².
    fn entering(&self, receiver: &Receiver<'_>) -> [f64; 3];
}

fn emitter(light: &Light, boundary: &Boundary, rays: u32) -> Box<dyn Emitter> {
    match *light {
        Light::Directional { to_light, irradiance, shadow, region } => {
            Box::new(Sun { to_light: to_light.into(), irradiance, shadow, region })
        }
        Light::Point { position, intensity, shadow, region } => {
            Box::new(Lamp { position: position.into(), intensity, cone: None, shadow, region })
        }
        Light::Spot { position, direction, intensity, inner_angle, outer_angle, shadow, region } => {
            let cone = Some((direction.into(), [inner_angle, outer_angle]));
            Box::new(Lamp { position: position.into(), intensity, cone, shadow, region })
        }
        Light::Ambient { radiance, axis, half_angle, shadow } => {
            Box::new(Sky::new(radiance, axis, half_angle, shadow, boundary))
        }
        Light::Rectangle { center, half_right, half_up, radiance, shadow } => {
            Box::new(Rectangle::new(center, half_right, half_up, radiance, shadow))
        }
        Light::Sphere { center, radius, radiance, shadow } => {
            Box::new(Sphere { center: center.into(), radius, radiance, shadow })
        }
        Light::Environment { ref map, shadow } => Box::new(Surroundings::new(map, rays, shadow)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{entering, half_roof};
    use std::f64::consts::PI;

    /// Lights that the roof at height 1 hides part of from the places below its edge.
    fn lights() -> [Light; 4] {
        let (radiance, shadow) = ([1.0; 3], true);
        let pixels = (0..32 * 16).map(|k| [1.0 + f64::from(k % 32 / 4), 1.0, 1.0]).collect();
        let map = EnvironmentMap::new(32, 16, pixels).expect("as many pixels as it says");
        [
            Light::Sphere { center: [0.0, 3.0, 1.0], radius: 1.0, radiance, shadow },
            Light::Rectangle {
                center: [0.0, 3.0, 0.0],
                half_right: [1.0, 0.0, 0.3],
                half_up: [-0.3, 0.0, 1.0],
                radiance,
                shadow,
            },
            Light::Ambient { radiance, axis: [0.0, 1.0, 0.0], half_angle: PI, shadow },
            Light::Environment { map: Arc::new(map), shadow },
        ]
    }

    /// Root mean square and mean of the errors at many places, relative to the mean light.
    fn errors(light: &Light, rays: u32, truth: &[f64]) -> [f64; 2] {
        let errors: Vec<f64> = at_places(light, rays).iter().zip(truth).map(|(a, b)| a - b).collect();
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let squares: Vec<f64> = errors.iter().map(|e| e * e).collect();
        [mean(&squares).sqrt() / mean(truth), mean(&errors) / mean(truth)]
    }

    fn at_places(light: &Light, rays: u32) -> Vec<f64> {
        let surface = half_roof(0.0, 1.0);
        let place = |k: u32| [0.2 * (f64::from(k) / 128.0 - 0.5), 0.0, 0.013 * f64::from(k % 7)];
        (0..128).map(|k| entering(&surface, light, 1.3, rays, place(k), [0.0, 1.0, 0.0])[0]).collect()
    }

    #[test]
    fn noise_falls_with_the_number_of_rays() {
        for light in lights() {
            let truth = at_places(&light, 96);
            let [few, many] = [4, 16].map(|rays| errors(&light, rays, &truth));
            // An edge through cells errs by rays^−3/2: an eighth for four times as many.
            assert!(few[0] / many[0] > 5.0 && few[0] / many[0] < 14.0, "{few:?} {many:?} {light:?}");
            // Standard error of the mean over 128 places, four times, with the truth's own.
            for [rms, bias] in [few, many] {
                assert!(bias.abs() < 4.5 * rms / 128.0f64.sqrt(), "{rms} {bias} {light:?}");
            }
        }
    }

    #[test]
    fn runs_repeat_bit_for_bit_and_lights_differ() {
        for light in lights() {
            assert_eq!(at_places(&light, 3), at_places(&light, 3));
            assert_eq!(at_places(&light, 0), at_places(&light, 1));
            assert_ne!(at_places(&light, 1), at_places(&light, 3));
            let surface = half_roof(0.0, 1.0);
            let at = Place { position: DVec3::ZERO, normal: DVec3::Y, triangle: u32::MAX };
            let twice =
                Lighting::new(&surface, &[light.clone(), light.clone()], 1.3.into(), 3).irradiance(at)[0];
            let once = Lighting::new(&surface, &[light], 1.3.into(), 3).irradiance(at)[0];
            assert!(twice != 2.0 * once, "two lights must not share their noise");
        }
    }

    /// A constant sky by every kind of light that can be one, where channels gain differently.
    #[test]
    fn skies_gain_alike() {
        let (radiance, axis, shadow) = ([1.0; 3], [0.0, 1.0, 0.0], false);
        let map =
            EnvironmentMap::new(256, 128, vec![radiance; 256 * 128]).expect("as many pixels as it says");
        let ceiling = Light::Rectangle {
            center: [0.0, 1.0, 0.0],
            half_right: [1e4, 0.0, 0.0],
            half_up: [0.0, 0.0, 1e4],
            radiance,
            shadow,
        };
        let skies = [
            Light::Ambient { radiance, axis, half_angle: PI, shadow },
            Light::Ambient { radiance, axis, half_angle: 0.5 * PI, shadow },
            Light::Environment { map: Arc::new(map), shadow },
            ceiling,
        ];
        let at = Place { position: DVec3::ZERO, normal: DVec3::Y, triangle: u32::MAX };
        let light = |sky: &Light, slant: [f64; 3], ior: f64| {
            let boundary = Boundary { ior, slant };
            Lighting::new(&crate::testing::nothing(), std::slice::from_ref(sky), boundary, 1).irradiance(at)
        };
        let slant = [0.0, 0.3, 0.6];
        for (sky, ior) in skies.iter().flat_map(|sky| [0.8, 1.0, 1.4].map(|ior| (sky, ior))) {
            // By midpoints of the cosine's square, which the cosine in the integral is half the derivative of.
            let mean = |k: usize| {
                let steps = 100_000;
                let share = |step: i32| {
                    let boundary = Boundary { ior, slant };
                    boundary.entering(((f64::from(step) + 0.5) / f64::from(steps)).sqrt())[k]
                };
                PI * (0..steps).map(share).sum::<f64>() / f64::from(steps)
            };
            let found = light(sky, slant, ior);
            for k in 0..3 {
                // 128 rows of a map against the jump at the critical angle: measured 7e-3 at η = 0.8.
                assert!((found[k] / mean(k) - 1.0).abs() < 1e-2, "{ior} {k}: {found:?} {}", mean(k));
            }
            let even = light(sky, [0.0; 3], ior);
            assert!((even[0] - found[0]).abs() < 1e-12 && found[2] > 1.05 * even[2], "{found:?} {even:?}");
        }
    }

    #[test]
    fn no_normal_takes_no_light() {
        for light in lights() {
            assert_eq!(entering(&half_roof(5.0, 1.0), &light, 1.3, 2, [0.0; 3], [0.0; 3]), [0.0; 3]);
            assert_ne!(entering(&half_roof(5.0, 1.0), &light, 1.3, 2, [0.0; 3], [0.0, 1.0, 0.0]), [0.0; 3]);
        }
    }
}
