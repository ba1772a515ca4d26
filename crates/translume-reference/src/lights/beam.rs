//! Light that comes from one direction at each place: the sun, points and spots.

use glam::DVec3;

use super::{Emitter, Receiver, Region};
use crate::rgb::{product, scale};

/// Parallel light.
pub(super) struct Sun {
    pub to_light: DVec3,
    pub irradiance: [f64; 3],
    pub shadow: bool,
    pub region: Option<Region>,
}

/// A point that shines in all directions or into a cone.
pub(super) struct Lamp {
    pub position: DVec3,
    pub intensity: [f64; 3],
    /// Where it shines to, with the inner and the outer angle.
    pub cone: Option<(DVec3, [f64; 2])>,
    pub shadow: bool,
    pub region: Option<Region>,
}

impl Emitter for Sun {
    fn entering(&self, receiver: &Receiver<'_>) -> [f64; 3] {
        let share = receiver.share(self.to_light);
        let dark = share == [0.0; 3]
            || outside(self.region, receiver)
            || (self.shadow && receiver.blocked(self.to_light, f64::INFINITY));
        if dark { [0.0; 3] } else { product(self.irradiance, share) }
    }
}

impl Emitter for Lamp {
    fn entering(&self, receiver: &Receiver<'_>) -> [f64; 3] {
        let offset = self.position - receiver.at.position;
        let distance = offset.length();
        if distance == 0.0 {
            return [0.0; 3];
        }
        let to_light = offset / distance;
        let strength = self.cone.map_or(1.0, |cone| falloff(cone, -offset)) / (distance * distance);
        let share = scale(receiver.share(to_light), strength);
        let dark = share == [0.0; 3]
            || outside(self.region, receiver)
            || (self.shadow && receiver.blocked(to_light, distance));
        if dark { [0.0; 3] } else { product(self.intensity, share) }
    }
}

fn outside(region: Option<Region>, receiver: &Receiver<'_>) -> bool {
    let at = receiver.at.position;
    region.is_some_and(|(low, high)| at.cmplt(low.into()).any() || at.cmpgt(high.into()).any())
}

/// Share of the intensity towards `offset`, 0..=1.
///
/// Source: `KHR_lights_punctual`, "Inner and Outer Cone Angles", in its own terms.
pub(crate) fn falloff((direction, [inner, outer]): (DVec3, [f64; 2]), offset: DVec3) -> f64 {
    let angle = offset.angle_between(direction);
    let share = (angle.cos() - outer.cos()) / (inner.cos() - outer.cos()).max(0.001);
    if angle.is_finite() { share.clamp(0.0, 1.0).powi(2) } else { 0.0 }
}
