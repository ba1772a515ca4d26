//! Straight lines through a body.

use glam::DVec3;

use super::Site;
use crate::fresnel::refracted_cos;
use crate::lights::strata::{Strata, hemisphere};
use crate::path::way::segments;
use crate::path::{Crossing, Shape};

/// Rays start this share of the body's diagonal off the surface.
const OFFSET: f64 = 1e-6;
/// Its square is how many directions of the sky a site looks along.
pub(super) const SKY: u32 = 8;

pub(super) struct Rays<'a> {
    pub shape: &'a dyn Shape,
    pub ior: f64,
    pub offset: f64,
}

impl<'a> Rays<'a> {
    pub fn new(shape: &'a dyn Shape, ior: f64) -> Self {
        let [low, high] = shape.extent();
        Self { shape, ior, offset: OFFSET * low.distance(high) }
    }

    /// Parts of a ray that are inside, from near to far, up to a distance.
    pub fn segments(&self, origin: DVec3, direction: DVec3, most: f64) -> Vec<[f64; 2]> {
        let mut crossings: Vec<Crossing> = Vec::new();
        self.shape.crossings(origin, direction, &mut |crossing| crossings.push(crossing));
        crossings.sort_by(|a, b| a.t.total_cmp(&b.t));
        // Who begins or ends inside comes in or goes out there.
        if crossings.first().is_some_and(|crossing| crossing.leaves(direction)) {
            crossings.insert(0, Crossing { t: 0.0, normal: -direction });
        }
        crossings.retain(|crossing| crossing.t < most);
        if most.is_finite() {
            crossings.push(Crossing { t: most, normal: direction });
        }
        segments(&crossings, direction)
    }

    /// How much of a ray is inside, mm.
    pub fn inside(&self, origin: DVec3, direction: DVec3, most: f64) -> f64 {
        self.segments(origin, direction, most).iter().map(|[from, to]| to - from).sum()
    }

    /// A direction outside, away from a surface with this normal, as it is inside.
    pub fn bent(&self, outwards: DVec3, normal: DVec3) -> DVec3 {
        let cosine = normal.dot(outwards).max(0.0);
        if self.ior == 1.0 {
            return outwards;
        }
        (outwards - cosine * normal) / self.ior + refracted_cos(self.ior, cosine) * normal
    }

    /// From a site along a direction that leads inwards to the other side, mm; 0 where there is none.
    pub fn chord(&self, site: &Site, direction: DVec3) -> f64 {
        let origin = DVec3::from(site.position) - DVec3::from(site.normal) * self.offset;
        self.shape.first(origin, direction, true, f64::INFINITY).map_or(0.0, |crossing| crossing.t)
    }

    pub fn thickness(&self, site: &Site) -> f64 {
        self.chord(site, -DVec3::from(site.normal))
    }

    /// Share of the light of an even sky that the body keeps from a site.
    pub fn occlusion(&self, site: &Site) -> f64 {
        let (normal, position) = (DVec3::from(site.normal), DVec3::from(site.position));
        let origin = position + normal * self.offset;
        let is_blocked = |point: &[f64; 2]| {
            self.shape.first(origin, hemisphere(normal, *point), false, f64::INFINITY).is_some()
        };
        let blocked = Strata::new(SKY, position, 0).points().filter(is_blocked).count();
        blocked as f64 / f64::from(SKY * SKY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::Ball;

    #[test]
    fn rays_may_begin_and_end_inside() {
        let ball = Ball { center: [0.0; 3], radius: 2.0 };
        let rays = Rays::new(&ball, 1.0);
        let along = |x: f64, most: f64| rays.segments(DVec3::new(x, 0.0, 0.0), DVec3::X, most);
        assert_eq!(along(-5.0, f64::INFINITY), [[3.0, 7.0]]);
        assert_eq!(along(-5.0, 4.0), [[3.0, 4.0]]);
        assert_eq!(along(1.0, f64::INFINITY), [[0.0, 1.0]]);
        assert_eq!(along(-1.0, 2.0), [[0.0, 2.0]]);
        assert!(along(3.0, 9.0).is_empty() && along(-5.0, 2.0).is_empty());
    }
}
