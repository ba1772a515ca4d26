//! A sphere of uniform radiance. From outside it is a cone of sky, up to its surface.

use glam::DVec3;

use super::ambient::ambient_transmittance;
use super::strata::cone;
use super::{Emitter, Ray, Receiver};
use crate::rgb::scale;

/// A sphere that shines outwards.
pub(super) struct Sphere {
    pub center: DVec3,
    pub radius: f64,
    pub radiance: [f64; 3],
    pub shadow: bool,
}

impl Emitter for Sphere {
    fn entering(&self, receiver: &Receiver<'_>) -> [f64; 3] {
        let offset = self.center - receiver.at.position;
        let distance = offset.length();
        if distance <= self.radius {
            return [0.0; 3];
        }
        let axis = offset / distance;
        let half_angle = (self.radius / distance).asin();
        let open = ambient_transmittance(receiver.eta, receiver.at.normal.dot(axis), half_angle);
        let visible = if self.shadow && open > 0.0 { self.visible(receiver, axis, distance) } else { 1.0 };
        scale(self.radiance, open * visible)
    }
}

impl Sphere {
    fn visible(&self, receiver: &Receiver<'_>, axis: DVec3, distance: f64) -> f64 {
        let square = (self.radius / distance).powi(2);
        // 1 − cos of the half angle without cancellation.
        let opening = square / (1.0 + (1.0 - square).sqrt());
        let rays = receiver.strata.points().map(|point| {
            let (direction, height) = cone(axis, opening, point);
            let weight = [receiver.share(direction); 3];
            // Half the chord: r² − d² sin² of the angle from the axis.
            let half = (self.radius.powi(2) - distance.powi(2) * height * (2.0 - height)).max(0.0).sqrt();
            Ray { direction, distance: distance * (1.0 - height) - half, weight }
        });
        receiver.visible(rays)[0]
    }
}
