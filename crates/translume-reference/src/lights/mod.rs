//! What illuminates the surface, and how much of it enters.
//!
//! Lights of some extent are exact where nothing is in the way. Where something may be, that value is taken times the
//! visible share: of the rays' summed weights, that of the rays that get through. The share is exactly 1 or 0 where all
//! or none do, and between them the quotient's bias falls with the square of the number of rays.

mod ambient;
mod beam;
mod environment;
mod polygon;
mod rectangle;
mod sphere;
mod strata;

use std::sync::Arc;

use glam::DVec3;

pub use ambient::ambient_transmittance;

use crate::fresnel::transmittance;
use crate::rgb::accumulate;
use crate::{EnvironmentMap, Surface};
use ambient::Sky;
use beam::{Lamp, Sun};
use environment::Surroundings;
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

/// A point of the surface that light falls on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub position: DVec3,
    pub normal: DVec3,
    /// The triangle it lies on, which cannot shade it.
    pub triangle: u32,
}

/// The lights of a scene with what does not depend on the place.
pub(crate) struct Lighting<'a> {
    surface: &'a Surface,
    emitters: Vec<Box<dyn Emitter>>,
    eta: f64,
    rays: u32,
}

impl<'a> Lighting<'a> {
    /// `rays`² directions for each light that has an extent and a shadow.
    pub fn new(surface: &'a Surface, lights: &[Light], eta: f64, rays: u32) -> Self {
        let emitters = lights.iter().map(|light| emitter(light, eta, rays)).collect();
        Self { surface, emitters, eta, rays }
    }

    /// Irradiance that entered: Σ L · F_t · cos, W/m².
    pub fn irradiance(&self, at: Place) -> [f64; 3] {
        let mut sum = [0.0; 3];
        if at.normal == DVec3::ZERO {
            return sum;
        }
        for (index, emitter) in self.emitters.iter().enumerate() {
            let strata = Strata::new(self.rays, at.position, index);
            let receiver = Receiver { surface: self.surface, eta: self.eta, at, strata };
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

fn emitter(light: &Light, eta: f64, rays: u32) -> Box<dyn Emitter> {
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
            Box::new(Sky::new(radiance, axis, half_angle, shadow, eta))
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

/// A place with what decides how much of a light enters there.
struct Receiver<'a> {
    surface: &'a Surface,
    eta: f64,
    at: Place,
    strata: Strata,
}

/// A direction that light may come from.
struct Ray {
    direction: DVec3,
    /// How far away the light is, mm.
    distance: f64,
    /// Light in each channel, in units that all rays of a light share.
    weight: [f64; 3],
}

impl Receiver<'_> {
    /// F_t · cos of a direction; 0 below the horizon.
    fn share(&self, direction: DVec3) -> f64 {
        let cos = self.at.normal.dot(direction);
        if cos > 0.0 { transmittance(self.eta, cos) * cos } else { 0.0 }
    }

    fn blocked(&self, direction: DVec3, distance: f64) -> bool {
        let Place { position, triangle, .. } = self.at;
        self.surface.occluded(position.to_array(), triangle, direction.to_array(), distance)
    }

    /// Share of each channel's weight that nothing blocks, 0..=1; 1 where no ray has weight.
    fn visible(&self, rays: impl Iterator<Item = Ray>) -> [f64; 3] {
        let (mut all, mut seen) = ([0.0; 3], [0.0; 3]);
        for ray in rays.filter(|ray| ray.weight != [0.0; 3]) {
            accumulate(&mut all, ray.weight, 1.0);
            if !self.blocked(ray.direction, ray.distance) {
                accumulate(&mut seen, ray.weight, 1.0);
            }
        }
        std::array::from_fn(|k| if all[k] > 0.0 { seen[k] / all[k] } else { 1.0 })
    }
}
