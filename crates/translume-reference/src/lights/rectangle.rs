//! A rectangle of uniform radiance, shining to one side.

use glam::DVec3;

use super::polygon::polygon_transmittance;
use super::solid_angle::Seen;
use super::{Emitter, Ray, Receiver};
use crate::rgb::{accumulate, product, scale};

/// Half diagonal over distance below which the solid angle cancels to less than ten digits. There the rectangle is
/// sampled by area instead, and a rule of degree 3 errs by the fourth power of this.
const FAR: f64 = 1e-2;

/// A rectangle by its middle and two unit axes with the half extent along each.
pub(super) struct Rectangle {
    center: DVec3,
    axes: [DVec3; 2],
    half: [f64; 2],
    /// Where it shines to; zero if it has no area.
    normal: DVec3,
    radiance: [f64; 3],
    shadow: bool,
}

impl Rectangle {
    pub fn new(
        center: [f64; 3],
        half_right: [f64; 3],
        half_up: [f64; 3],
        radiance: [f64; 3],
        shadow: bool,
    ) -> Self {
        let halves = [half_right, half_up].map(DVec3::from);
        Self {
            center: center.into(),
            axes: halves.map(DVec3::normalize_or_zero),
            half: halves.map(DVec3::length),
            normal: halves[0].cross(halves[1]).normalize_or_zero(),
            radiance,
            shadow,
        }
    }

    /// Its point at −1..=1 of each half extent.
    fn point(&self, [x, y]: [f64; 2]) -> DVec3 {
        self.center + self.axes[0] * (self.half[0] * x) + self.axes[1] * (self.half[1] * y)
    }

    fn is_far(&self, from: DVec3) -> bool {
        self.half[0].hypot(self.half[1]) < FAR * from.distance(self.center)
    }

    /// A ray to a point, weighted as one of many that share the rectangle's area evenly.
    fn area_ray(&self, receiver: &Receiver<'_>, point: [f64; 2]) -> Ray {
        let ray = towards(receiver, self.point(point.map(|x| 2.0 * x - 1.0)));
        let area = 4.0 * self.half[0] * self.half[1];
        let solid_angle = area * -self.normal.dot(ray.direction) / (ray.distance * ray.distance);
        Ray { weight: scale(ray.weight, solid_angle), ..ray }
    }

    /// ∫ F_t cos dω over what is above the receiver's horizon, sr.
    fn open(&self, receiver: &Receiver<'_>) -> [f64; 3] {
        let from = receiver.at.position;
        if self.is_far(from) {
            let nodes = [0.5 - 0.5 / 3.0f64.sqrt(), 0.5 + 0.5 / 3.0f64.sqrt()];
            let mut sum = [0.0; 3];
            for [x, y] in nodes.iter().flat_map(|&x| nodes.map(|y| [x, y])) {
                accumulate(&mut sum, self.area_ray(receiver, [x, y]).weight, 0.25);
            }
            return sum;
        }
        let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]].map(|at| self.point(at) - from);
        polygon_transmittance(&receiver.boundary, receiver.at.normal, &corners)
    }

    fn visible(&self, receiver: &Receiver<'_>) -> [f64; 3] {
        let points = receiver.strata.points();
        if self.is_far(receiver.at.position) {
            return receiver.visible(points.map(|point| self.area_ray(receiver, point)));
        }
        let offset = self.center - receiver.at.position;
        let seen = Seen::new(self.axes.map(|axis| offset.dot(axis)), self.half, offset.dot(self.normal));
        receiver.visible(points.map(|point| towards(receiver, self.point(seen.point(point)))))
    }
}

impl Emitter for Rectangle {
    fn entering(&self, receiver: &Receiver<'_>) -> [f64; 3] {
        if self.normal.dot(receiver.at.position - self.center) <= 0.0 {
            return [0.0; 3];
        }
        let open = self.open(receiver);
        let visible = if self.shadow && open != [0.0; 3] { self.visible(receiver) } else { [1.0; 3] };
        product(self.radiance, product(open, visible))
    }
}

fn towards(receiver: &Receiver<'_>, point: DVec3) -> Ray {
    let offset = point - receiver.at.position;
    let distance = offset.length();
    let direction = offset / distance;
    Ray { direction, distance, weight: receiver.share(direction) }
}

#[cfg(test)]
mod tests {
    use crate::testing::{assert_rel, entering, half_roof, nothing};
    use crate::{Light, Surface};

    /// A rectangle of the given half sides at a height, shining down.
    fn ceiling(center: [f64; 3], [a, b]: [f64; 2]) -> Light {
        let (half_right, half_up) = ([a, 0.0, 0.0], [0.0, 0.0, b]);
        Light::Rectangle { center, half_right, half_up, radiance: [1.0, 2.0, 3.0], shadow: true }
    }

    fn at_origin(surface: &Surface, light: &Light, eta: f64, rays: u32) -> f64 {
        entering(surface, light, eta, rays, [0.0; 3], [0.0, 1.0, 0.0])[0]
    }

    /// π times the configuration factor from a point to a parallel rectangle whose corner is at height `c` above it.
    /// Source: Howell, "A catalog of radiation heat transfer configuration factors", B-3.
    fn above_corner(a: f64, b: f64, c: f64) -> f64 {
        let (a, b) = (a / c, b / c);
        let (ra, rb) = (1.0f64.hypot(a), 1.0f64.hypot(b));
        0.5 * (a / ra * (b / ra).atan() + b / rb * (a / rb).atan())
    }

    #[test]
    fn parallel_to_the_surface_without_fresnel() {
        for (a, b, c) in
            [(1.0, 1.0, 1e-6), (1.0, 3.0, 0.5), (2.0, 0.1, 5.0), (1.0, 1.0, 1e2), (1.0, 1.0, 1e5)]
        {
            let exact = 4.0 * above_corner(a, b, c);
            let light = at_origin(&nothing(), &ceiling([0.0, c, 0.0], [a, b]), 1.0, 3);
            // Just nearer than FAR four angles cancel to 1e-4 of each; beyond, the rule's error is FAR⁴. Measured 5e-16.
            assert_rel(light, exact, 1e-8, "above the middle");
            let corner = at_origin(&nothing(), &ceiling([a, c, -b], [a, b]), 1.0, 3);
            assert_rel(corner, above_corner(2.0 * a, 2.0 * b, c), 1e-8, "above a corner");
            let moved = at_origin(&nothing(), &ceiling([0.0, 1.001 * c, 0.0], [a, b]), 1.0, 3);
            assert!(c < 1e-3 || (moved / exact - 1.0).abs() > 1e-5, "0.1 % higher must be noticed");
        }
    }

    /// A lit wall that stands on the surface, next to the receiver.
    #[test]
    fn perpendicular_and_touching_without_fresnel() {
        for c in [1e-6, 0.1, 3.0] {
            let (width, height) = (2.0f64, 1.0f64);
            let wall = |lean: f64| Light::Rectangle {
                center: [c, 0.5 * height, 0.5 * width],
                half_right: [0.0, 0.5 * height * lean, 0.0],
                half_up: [0.0, 0.0, -0.5 * width],
                radiance: [1.0; 3],
                shadow: true,
            };
            // Howell B-4, the corner nearest to the receiver.
            let far = height.hypot(c);
            let exact = 0.5 * ((width / c).atan() - c / far * (width / far).atan());
            assert_rel(at_origin(&nothing(), &wall(1.0), 1.0, 3), exact, 1e-8, "wall");
            assert_eq!(at_origin(&nothing(), &wall(-1.0), 1.0, 3), 0.0, "its back");
        }
    }

    #[test]
    fn small_and_far_is_a_point_with_a_cosine() {
        let position = [30.0, 40.0, 0.0];
        let light = ceiling(position, [0.1, 0.2]);
        let point = |area: f64| {
            let intensity = [0.8 * area; 3];
            let point = Light::Point { position, intensity, shadow: true, region: None };
            at_origin(&nothing(), &point, 1.4, 1)
        };
        // The next term is of the order of (0.2/50)²/3 = 5e-6.
        assert_rel(at_origin(&nothing(), &light, 1.4, 1), point(0.08), 2e-5, "point");
        assert!((point(0.0801) / point(0.08) - 1.0).abs() > 2e-5);
    }

    /// Both ways to evaluate it agree where one takes over from the other.
    #[test]
    fn near_and_far_meet() {
        for eta in [0.8, 1.0, 1.4] {
            let at = |distance: f64, cos: f64| {
                let height = cos * distance;
                let light =
                    ceiling([(distance * distance - height * height).sqrt(), height, 0.0], [0.6, 0.8]);
                at_origin(&nothing(), &light, eta, 1) * distance * distance
            };
            let (near, far) = (at(99.9, 0.7), at(100.1, 0.7));
            // The light's size tells by (1/100)², between the two by 0.4 % of that: what is left is the method:
            // measured 3e-8.
            assert!((near - far).abs() <= 2e-6 * near, "{eta}: {near} {far}");
            assert!((at(99.9, 0.700_01) / near - 1.0).abs() > 2e-6, "{eta}: a tilt of 1e-5 must be noticed");
        }
    }

    /// A roof whose edge lies in line with x = `from` of the light leaves the rectangle from there on.
    #[test]
    fn what_a_roof_leaves_is_a_smaller_rectangle() {
        for (height, half) in [(1.0, [1.0, 0.7]), (0.05, [1.0, 0.7]), (500.0, [1.0, 0.7])] {
            for eta in [1.0, 1.4] {
                let center = [0.3, height, -0.2];
                let part = |from: f64| {
                    let width = 0.5 * (from - (center[0] - half[0]));
                    let light = ceiling([from - width, height, center[2]], [width, half[1]]);
                    at_origin(&nothing(), &light, eta, 1)
                };
                let covered = |from: f64| {
                    at_origin(&half_roof(0.5 * from, 0.5 * height), &ceiling(center, half), eta, 16)
                };
                for from in [-0.4, 0.0, 0.3, 1.1] {
                    // The edge runs through 16 of 256 cells: measured 1.3 % of the whole at most.
                    let whole = part(1.3);
                    let error = (covered(from) - part(from)).abs();
                    assert!(error < 0.02 * whole, "{height} {eta} {from}: {}", error / whole);
                    assert!((covered(from) - part(from + 0.2)).abs() > 0.02 * whole || height < 0.1);
                }
                assert_eq!(covered(-2.0), 0.0);
                assert_eq!(covered(2.0), part(1.3));
            }
        }
    }
}
