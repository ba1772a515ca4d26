//! Where light arrives, and how much of what comes from a direction enters there.

use glam::DVec3;

use super::strata::Strata;
use crate::rgb::{accumulate, scale};
use crate::{Boundary, Surface};

/// A point of the surface that light falls on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub position: DVec3,
    pub normal: DVec3,
    /// The triangle it lies on, which cannot shade it.
    pub triangle: u32,
}

/// A place with what decides how much of a light enters there.
pub(super) struct Receiver<'a> {
    pub surface: &'a Surface,
    pub boundary: Boundary,
    pub at: Place,
    pub strata: Strata,
}

/// A direction that light may come from.
pub(super) struct Ray {
    pub direction: DVec3,
    /// How far away the light is, mm.
    pub distance: f64,
    /// Light in each channel, in units that all rays of a light share.
    pub weight: [f64; 3],
}

impl Receiver<'_> {
    /// F_t g cos of a direction, g the gain of entry; 0 below the horizon.
    pub fn share(&self, direction: DVec3) -> [f64; 3] {
        let cos = self.at.normal.dot(direction);
        if cos > 0.0 { scale(self.boundary.entering(cos), cos) } else { [0.0; 3] }
    }

    pub fn blocked(&self, direction: DVec3, distance: f64) -> bool {
        let Place { position, triangle, .. } = self.at;
        self.surface.occluded(position.to_array(), triangle, direction.to_array(), distance)
    }

    /// Share of each channel's weight that nothing blocks, 0..=1; 1 where no ray has weight.
    pub fn visible(&self, rays: impl Iterator<Item = Ray>) -> [f64; 3] {
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
