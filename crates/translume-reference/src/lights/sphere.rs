//! A sphere of uniform radiance. From outside it is a cone of sky, up to its surface.

use glam::DVec3;

use super::ambient::cone_transmittance;
use super::strata::cone;
use super::{Emitter, Ray, Receiver};
use crate::rgb::product;

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
        let open = cone_transmittance(&receiver.boundary, receiver.at.normal.dot(axis), half_angle);
        let shaded = self.shadow && open != [0.0; 3];
        let visible = if shaded { self.visible(receiver, axis, distance) } else { [1.0; 3] };
        product(self.radiance, product(open, visible))
    }
}

impl Sphere {
    fn visible(&self, receiver: &Receiver<'_>, axis: DVec3, distance: f64) -> [f64; 3] {
        let square = (self.radius / distance).powi(2);
        // 1 − cos of the half angle without cancellation.
        let opening = square / (1.0 + (1.0 - square).sqrt());
        let rays = receiver.strata.points().map(|point| {
            let (direction, height) = cone(axis, opening, point);
            let weight = receiver.share(direction);
            // Half the chord: r² − d² sin² of the angle from the axis.
            let half = (self.radius.powi(2) - distance.powi(2) * height * (2.0 - height)).max(0.0).sqrt();
            Ray { direction, distance: distance * (1.0 - height) - half, weight }
        });
        receiver.visible(rays)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::polygon::{above_horizon, polygon_transmittance};
    use super::*;
    use crate::testing::{assert_rel, entering, half_roof, nothing};
    use crate::{Light, Surface};

    const UP: [f64; 3] = [0.0, 1.0, 0.0];

    fn sphere(center: [f64; 3], radius: f64) -> Light {
        Light::Sphere { center, radius, radiance: [1.0, 2.0, 3.0], shadow: true }
    }

    fn at_origin(surface: &Surface, light: &Light, eta: f64, rays: u32) -> [f64; 3] {
        entering(surface, light, eta, rays, [0.0; 3], UP)
    }

    #[test]
    fn above_the_horizon_without_fresnel() {
        for (center, radius) in [([0.0, 2.0, 0.0], 1.0), ([3.0, 4.0, 0.0], 3.9), ([30.0, 40.0, 0.0], 1e-5)] {
            let square: f64 = center.iter().map(|x: &f64| x * x).sum();
            let exact = PI * radius * radius / square * center[1] / square.sqrt();
            for rays in [0, 1, 5] {
                let light = at_origin(&nothing(), &sphere(center, radius), 1.0, rays);
                assert_rel(light[0], exact, 1e-7, "π L (R/d)² cos");
                assert_rel(light[2], 3.0 * exact, 1e-7, "blue");
            }
            let larger = at_origin(&nothing(), &sphere(center, 1.001 * radius), 1.0, 1);
            assert!((larger[0] / exact - 1.0).abs() > 1e-3, "0.1 % of radius must be noticed");
        }
    }

    #[test]
    fn small_and_far_is_a_point() {
        let (position, radius) = ([3.0, 4.0, 12.0], 0.01);
        let intensity = [1.0, 2.0, 3.0].map(|l| l * PI * radius * radius);
        let point = |position| Light::Point { position, intensity, shadow: true, region: None };
        let exact = at_origin(&nothing(), &point(position), 1.4, 1)[1];
        // The next term is of the order of (R/d)² = 6e-7.
        assert_rel(at_origin(&nothing(), &sphere(position, radius), 1.4, 1)[1], exact, 2e-6, "point");
        let moved = at_origin(&nothing(), &point([3.0, 4.0, 12.001]), 1.4, 1)[1];
        assert!((moved / exact - 1.0).abs() > 1e-5, "a micrometre must be noticed");
    }

    #[test]
    fn inside_and_below_it_is_dark() {
        assert_eq!(at_origin(&nothing(), &sphere([0.0, 0.5, 0.0], 1.0), 1.3, 4), [0.0; 3]);
        assert_eq!(at_origin(&nothing(), &sphere([0.0, -2.0, 0.0], 1.0), 1.3, 4), [0.0; 3]);
        assert!(
            at_origin(&nothing(), &sphere([0.0, -0.5, 2.0], 1.0), 1.3, 4)[0] > 0.0,
            "part above the horizon"
        );
    }

    #[test]
    fn half_behind_a_roof_is_half() {
        for (center, radius) in [([0.0, 5.0, 3.0], 2.0), ([0.0, 5.0, 3.0], 0.1), ([0.0, 2.0, 0.0], 1.9)] {
            let light = sphere(center, radius);
            let open = at_origin(&nothing(), &light, 1.4, 1)[0];
            let covered = |from: f64| at_origin(&half_roof(from, 0.05), &light, 1.4, 16)[0];
            // The edge runs through 16 of 256 cells: measured 0.06 % at most, as it lies along them.
            assert_rel(covered(0.0), 0.5 * open, 0.02, "half");
            assert!(
                (covered(0.1 * 0.05 * radius / center[1]) / open - 0.5).abs() > 0.02,
                "a tenth of its radius"
            );
            assert_eq!(covered(-1.0), 0.0, "all behind the roof");
            assert_eq!(covered(1.0), open, "none behind it");
        }
    }

    /// A wide sphere on one side: the part a roof hides has another mean cosine than the part it leaves.
    #[test]
    fn what_a_roof_leaves_is_the_rest_of_a_disc() {
        let (center, radius) = (DVec3::new(2.0, 2.5, 0.0), 1.9f64);
        let sin = radius / center.length();
        let (x, y) = center.normalize().any_orthonormal_pair();
        let rim = |k: u32| {
            let (up, across) = (PI * f64::from(k) / 180.0).sin_cos();
            center.normalize() * (1.0 - sin * sin).sqrt() + (x * across + y * up) * sin
        };
        let rim: Vec<DVec3> = (0..360).map(rim).collect();
        for (eta, slope) in [1.0, 3.0].into_iter().flat_map(|eta| [0.3, 0.8, 2.0].map(|slope| (eta, slope))) {
            let seen = |slope: f64| {
                let above = above_horizon(DVec3::new(-1.0, slope, 0.0), &rim);
                polygon_transmittance(&eta.into(), DVec3::Y, &above)[0]
            };
            let light = sphere(center.to_array(), radius);
            let measured = at_origin(&half_roof(0.01 * slope, 0.01), &light, eta, 96)[0];
            let open = at_origin(&nothing(), &light, eta, 1)[0];
            // An edge through 96 of 9216 cells: measured 4e-5 of the whole.
            assert!(
                (measured - seen(slope)).abs() < 5e-4 * open,
                "{eta} {slope} {}",
                (measured - seen(slope)) / open
            );
            assert!((measured - seen(slope + 0.05)).abs() > 5e-4 * open, "{eta} {slope}");
        }
    }

    /// Only what is nearer than the light's surface is in its way.
    #[test]
    fn roof_inside_or_beyond_the_light_is_no_obstacle() {
        let light = sphere([0.0, 2.0, 0.0], 0.5);
        let open = at_origin(&nothing(), &light, 1.0, 1)[0];
        for (height, expected) in [(1.4, 0.0), (1.99, open), (2.6, open)] {
            assert_eq!(at_origin(&half_roof(-10.0, height), &light, 1.0, 8)[0], expected, "{height}");
        }
    }
}
