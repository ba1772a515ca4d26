//! The same radiance from every direction of a cone, or of the whole sky.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::strata::{cone, hemisphere};
use super::{Emitter, Ray, Receiver};
use crate::Boundary;
use crate::fresnel::transmittance;
use crate::quadrature::integrate_panels;
use crate::rgb::product;

/// A cone of the sky.
pub(super) struct Sky {
    radiance: [f64; 3],
    axis: DVec3,
    half_angle: f64,
    shadow: bool,
    /// What the whole sky lets in, sr.
    whole: [f64; 3],
}

impl Sky {
    pub fn new(
        radiance: [f64; 3],
        axis: [f64; 3],
        half_angle: f64,
        shadow: bool,
        boundary: &Boundary,
    ) -> Self {
        let whole = boundary.whole_sky();
        Self { radiance, axis: axis.into(), half_angle, shadow, whole }
    }

    fn ray(&self, receiver: &Receiver<'_>, point: [f64; 2]) -> Ray {
        // The cosine is in the density over the hemisphere, and in the weight over a cone.
        let (direction, weight) = if self.half_angle >= PI {
            let direction = hemisphere(receiver.at.normal, point);
            (direction, receiver.boundary.entering(receiver.at.normal.dot(direction)))
        } else {
            let opening = 2.0 * (0.5 * self.half_angle).sin().powi(2);
            let (direction, _) = cone(self.axis, opening, point);
            (direction, receiver.share(direction))
        };
        Ray { direction, distance: f64::INFINITY, weight }
    }
}

impl Emitter for Sky {
    fn entering(&self, receiver: &Receiver<'_>) -> [f64; 3] {
        let open = if self.half_angle >= PI {
            self.whole
        } else {
            cone_transmittance(&receiver.boundary, receiver.at.normal.dot(self.axis), self.half_angle)
        };
        let rays = receiver.strata.points().map(|point| self.ray(receiver, point));
        let visible = if self.shadow { receiver.visible(rays) } else { [1.0; 3] };
        product(self.radiance, product(open, visible))
    }
}

/// ∫ F_t(eta, cos) cos dω over the part of a cone of directions above the horizon, sr. `cos_axis` is the cosine between
/// the normal and the cone's axis, `half_angle` the cone's half opening angle in radians, 0..=π.
///
/// For eta = 1: π sin²(half_angle) cos_axis where the whole cone is above the horizon, π for the whole sky.
#[must_use]
pub fn ambient_transmittance(eta: f64, cos_axis: f64, half_angle: f64) -> f64 {
    over_cone(eta, &|cos| transmittance(eta, cos), cos_axis, half_angle)
}

/// The same of each channel with the gain of entry.
pub(super) fn cone_transmittance(boundary: &Boundary, cos_axis: f64, half_angle: f64) -> [f64; 3] {
    boundary.each(|entering| over_cone(boundary.ior, entering, cos_axis, half_angle))
}

fn over_cone(eta: f64, entering: &dyn Fn(f64) -> f64, cos_axis: f64, half_angle: f64) -> f64 {
    let tilt = cos_axis.clamp(-1.0, 1.0).acos();
    let sin_tilt = tilt.sin();
    let half_angle = half_angle.clamp(0.0, PI);
    let azimuth = |polar: f64| {
        let (nearest, farthest) = ((polar - tilt).abs(), (polar + tilt).min(TAU - polar - tilt));
        if nearest >= half_angle {
            0.0
        } else if farthest <= half_angle {
            TAU
        } else {
            // sin² of a quarter of the arc: narrow cones keep their digits.
            let (before, past) = (0.5 * (half_angle + polar - tilt), 0.5 * (half_angle - polar + tilt));
            let square = before.sin() * past.sin() / (polar.sin() * sin_tilt);
            4.0 * square.clamp(0.0, 1.0).sqrt().asin()
        }
    };
    // The integrand has roots where the circle of constant polar angle touches the cone, and at the critical angle.
    let mut breaks =
        vec![0.0, (tilt - half_angle).abs(), tilt + half_angle, TAU - tilt - half_angle, FRAC_PI_2];
    if eta < 1.0 {
        breaks.push(eta.asin());
    }
    breaks.retain(|angle| (0.0..=FRAC_PI_2).contains(angle));
    breaks.sort_by(f64::total_cmp);
    let ring = |polar: f64| {
        let cos = polar.cos();
        entering(cos) * cos * polar.sin() * azimuth(polar)
    };
    integrate_panels(ring, &breaks, 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fresnel::hemispherical_transmittance;
    use crate::lights::{Lighting, Place};
    use crate::testing::{assert_rel, entering, nothing, octasphere, ring, wall};
    use crate::{Light, Surface};

    fn sky(axis: [f64; 3], half_angle: f64) -> Light {
        Light::Ambient { radiance: [1.0, 2.0, 3.0], axis, half_angle, shadow: true }
    }

    fn at_origin(surface: &Surface, light: &Light, eta: f64, rays: u32) -> f64 {
        entering(surface, light, eta, rays, [0.0; 3], [0.0, 1.0, 0.0])[0]
    }

    #[test]
    fn wall_hides_half_of_a_sky() {
        for (axis, half_angle) in [([0.0, 1.0, 0.0], PI), ([0.0, 0.0, 1.0], 1.2), ([0.0, 0.6, 0.8], 0.1)] {
            for eta in [0.8, 1.0, 1.4] {
                let light = sky(axis, half_angle);
                let open = at_origin(&nothing(), &light, eta, 1);
                // The wall's edge runs through 16 of 256 cells: measured 0.8 %.
                assert_rel(at_origin(&wall(), &light, eta, 16), 0.5 * open, 0.02, "half");
                let unshadowed = Light::Ambient { radiance: [1.0; 3], axis, half_angle, shadow: false };
                assert_eq!(at_origin(&wall(), &unshadowed, eta, 16), open, "no shadow asked for");
            }
        }
    }

    /// A disc takes a smaller cone from the sky, and a hole in a roof, the mouth of a cup, leaves as much: sin² of its half
    /// angle from a whole sky without Fresnel.
    #[test]
    fn disc_and_mouth_of_a_cup() {
        for (sky_angle, eta) in [(PI, 1.0), (PI, 3.0), (1.4, 1.0), (1.4, 3.0)] {
            let light = sky([0.0, 1.0, 0.0], sky_angle);
            let open = at_origin(&nothing(), &light, eta, 1);
            for half_angle in [0.2f64, 0.8, 1.3] {
                let radius = half_angle.tan();
                let exact = ambient_transmittance(eta, 1.0, half_angle) / open;
                let behind = 1.0 - at_origin(&ring([0.0, radius], 1.0), &light, eta, 32) / open;
                let inside = at_origin(&ring([radius, 1e6], 1.0), &light, eta, 32) / open;
                // A rim through about 100 of 1024 cells: √100/3 · 1/1024 = 0.3 %; measured 0.6 % at most.
                assert!((behind - exact).abs() < 0.01, "{sky_angle} {eta}: {behind} {exact}");
                assert!((inside - exact).abs() < 0.01, "{sky_angle} {eta}: {inside} {exact}");
                let narrower =
                    at_origin(&ring([(half_angle - 0.05).tan(), 1e6], 1.0), &light, eta, 32) / open;
                assert!((narrower - exact).abs() > 0.01, "0.05 rad less must be noticed: {narrower} {exact}");
            }
        }
    }

    /// On a ball whose shading normal leans, what lies below the face is hidden by the rest of the body: without Fresnel
    /// (1 + cos tilt)/2 of a cosine-weighted sky is left.
    #[test]
    fn body_hides_what_is_below_the_face() {
        let (positions, triangles) = octasphere(10.0, 3);
        let ball = Surface::flat(positions, triangles);
        let light = [sky([0.0, 1.0, 0.0], PI)];
        let out = DVec3::from(ball.face_normal(7));
        let place = |tilt: f64| Place {
            position: ball.point(7, [0.3, 0.3]).into(),
            normal: out * tilt.cos() + out.any_orthonormal_vector() * tilt.sin(),
            triangle: 7,
        };
        let light = |tilt: f64| Lighting::new(&ball, &light, 1.0.into(), 32).irradiance(place(tilt))[0] / PI;
        assert_eq!(light(0.0), 1.0, "a convex body does not shade itself");
        for tilt in [0.3f64, 0.8] {
            // An edge through 32 of 1024 cells: measured 0.5 % at most.
            assert!((light(tilt) - 0.5 * (1.0 + tilt.cos())).abs() < 0.01, "{tilt} {}", light(tilt));
            assert!((light(tilt + 0.1) - 0.5 * (1.0 + tilt.cos())).abs() > 0.01, "{tilt}");
        }
    }

    #[test]
    fn all_or_nothing_is_exact() {
        let light = sky([0.0, 0.8, 0.6], 0.3);
        let open = at_origin(&nothing(), &light, 1.3, 1);
        assert_eq!(open, ambient_transmittance(1.3, 0.8, 0.3));
        for rays in [0, 1, 7] {
            assert_eq!(at_origin(&ring([0.0, 10.0], 1.0), &light, 1.3, rays), 0.0);
            assert_eq!(at_origin(&ring([0.0, 0.1], 1.0), &light, 1.3, rays), open);
        }
    }

    #[test]
    fn cone_above_the_horizon() {
        for (tilt, half) in [(0.0f64, 0.3f64), (0.5, 0.3), (0.9, 0.6), (0.0, 1.5), (1.2, 0.01)] {
            let exact = PI * half.sin().powi(2) * tilt.cos();
            assert_rel(
                ambient_transmittance(1.0, tilt.cos(), half),
                exact,
                1e-8,
                "tolerance of the integral",
            );
            assert!((ambient_transmittance(1.0, tilt.cos(), half * 1.01) / exact - 1.0).abs() > 1e-5);
        }
    }

    #[test]
    fn hemisphere_of_sky_and_whole_sky() {
        for tilt in [0.0f64, 0.4, 1.5, 2.0, 3.0] {
            let exact = PI * 0.5 * (1.0 + tilt.cos());
            assert_rel(ambient_transmittance(1.0, tilt.cos(), FRAC_PI_2), exact, 1e-8, "half the sky");
            for eta in [0.7, 1.0, 1.3, 1.5] {
                let exact = PI * hemispherical_transmittance(eta);
                assert_rel(ambient_transmittance(eta, tilt.cos(), PI), exact, 1e-8, "whole sky");
            }
        }
        assert_eq!(ambient_transmittance(1.3, -1.0, 0.4), 0.0);
    }

    /// A cone and its complement make the whole sky, whatever the tilt; a wrong break or arc would show here.
    #[test]
    fn complementary_cones_add_up() {
        for eta in [0.7, 1.3] {
            let whole = PI * hemispherical_transmittance(eta);
            for (tilt, half) in [(0.2f64, 0.5f64), (1.0, 1.2), (1.2, 0.7), (2.5, 2.0), (2.9, 2.8)] {
                let cone = ambient_transmittance(eta, tilt.cos(), half);
                let rest = ambient_transmittance(eta, -tilt.cos(), PI - half);
                assert_rel(cone + rest, whole, 1e-8, "tolerance of the integral");
                let wrong = ambient_transmittance(eta, -tilt.cos(), PI - half + 0.01);
                assert!((cone + wrong - whole).abs() > 1e-6, "{eta} {tilt} {half}");
            }
        }
    }

    #[test]
    fn fresnel_weight_inside_the_cone() {
        // A narrow cone is a directional light.
        let (cos, half) = (0.4f64, 1e-3f64);
        let expected = PI * half * half * cos * transmittance(1.3, cos);
        // The cone's curvature term is of the order of half_angle².
        assert_rel(ambient_transmittance(1.3, cos, half), expected, 1e-5, "narrow cone");
        assert!((ambient_transmittance(1.0, cos, half) / expected - 1.0).abs() > 0.01);
    }
}
