//! The same radiance from every direction of a cone, or of the whole sky.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::strata::{cone, hemisphere};
use super::{Emitter, Ray, Receiver};
use crate::fresnel::{hemispherical_transmittance, transmittance};
use crate::quadrature::integrate_panels;
use crate::rgb::scale;

/// A cone of the sky.
pub(super) struct Sky {
    radiance: [f64; 3],
    axis: DVec3,
    half_angle: f64,
    shadow: bool,
    /// What the whole sky lets in, sr.
    whole: f64,
}

impl Sky {
    pub fn new(radiance: [f64; 3], axis: [f64; 3], half_angle: f64, shadow: bool, eta: f64) -> Self {
        let whole = PI * hemispherical_transmittance(eta);
        Self { radiance, axis: axis.into(), half_angle, shadow, whole }
    }

    fn ray(&self, receiver: &Receiver<'_>, point: [f64; 2]) -> Ray {
        // The cosine is in the density over the hemisphere, and in the weight over a cone.
        let (direction, weight) = if self.half_angle >= PI {
            let direction = hemisphere(receiver.at.normal, point);
            (direction, transmittance(receiver.eta, receiver.at.normal.dot(direction)))
        } else {
            let opening = 2.0 * (0.5 * self.half_angle).sin().powi(2);
            let (direction, _) = cone(self.axis, opening, point);
            (direction, receiver.share(direction))
        };
        Ray { direction, distance: f64::INFINITY, weight: [weight; 3] }
    }
}

impl Emitter for Sky {
    fn entering(&self, receiver: &Receiver<'_>) -> [f64; 3] {
        let open = if self.half_angle >= PI {
            self.whole
        } else {
            ambient_transmittance(receiver.eta, receiver.at.normal.dot(self.axis), self.half_angle)
        };
        let rays = receiver.strata.points().map(|point| self.ray(receiver, point));
        let visible = if self.shadow { receiver.visible(rays)[0] } else { 1.0 };
        scale(self.radiance, open * visible)
    }
}

/// ∫ F_t(eta, cos) cos dω over the part of a cone of directions above the horizon, sr. `cos_axis` is the cosine between
/// the normal and the cone's axis, `half_angle` the cone's half opening angle in radians, 0..=π.
///
/// For eta = 1: π sin²(half_angle) cos_axis where the whole cone is above the horizon, π for the whole sky.
#[must_use]
pub fn ambient_transmittance(eta: f64, cos_axis: f64, half_angle: f64) -> f64 {
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
        transmittance(eta, cos) * cos * polar.sin() * azimuth(polar)
    };
    integrate_panels(ring, &breaks, 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::assert_rel;

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
