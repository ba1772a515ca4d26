//! What illuminates the surface, and how much of it enters.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use crate::Surface;
use crate::fresnel::{hemispherical_transmittance, transmittance};
use crate::quadrature::integrate_panels;
use crate::rgb::{accumulate, scale};

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
    /// Uniform radiance from a cone of the sky, cut off by the horizon of each point and never occluded.
    Ambient {
        /// Radiance inside the cone, W/(m² sr).
        radiance: [f64; 3],
        /// Unit vector towards the middle of the cone.
        axis: [f64; 3],
        /// Half opening angle of the cone, radians; π is the whole sky.
        half_angle: f64,
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
    lights: &'a [Light],
    eta: f64,
    whole_sky: f64,
}

impl<'a> Lighting<'a> {
    pub fn new(surface: &'a Surface, lights: &'a [Light], eta: f64) -> Self {
        Self { surface, lights, eta, whole_sky: PI * hemispherical_transmittance(eta) }
    }

    /// Irradiance that entered: Σ L · F_t · cos, W/m².
    pub fn irradiance(&self, at: Place) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for light in self.lights {
            accumulate(&mut sum, self.entering(light, at), 1.0);
        }
        sum
    }

    fn entering(&self, light: &Light, at: Place) -> [f64; 3] {
        match *light {
            Light::Directional { to_light, irradiance, shadow, region } => {
                self.beam(at, to_light.into(), f64::INFINITY, irradiance, shadow, region)
            }
            Light::Point { position, intensity, shadow, region } => {
                let offset = DVec3::from(position) - at.position;
                let distance = offset.length();
                if distance == 0.0 {
                    return [0.0; 3];
                }
                let arriving = scale(intensity, 1.0 / (distance * distance));
                self.beam(at, offset / distance, distance, arriving, shadow, region)
            }
            Light::Spot { position, direction, intensity, inner_angle, outer_angle, shadow, region } => {
                let offset = at.position - DVec3::from(position);
                let angle = offset.angle_between(direction.into());
                // The extension's formula, in its own terms.
                let falloff =
                    (angle.cos() - outer_angle.cos()) / (inner_angle.cos() - outer_angle.cos()).max(0.001);
                let share = if angle.is_finite() { falloff.clamp(0.0, 1.0).powi(2) } else { 0.0 };
                let towards = scale(intensity, share);
                self.entering(&Light::Point { position, intensity: towards, shadow, region }, at)
            }
            Light::Ambient { radiance, axis, half_angle } => {
                let cos_axis = at.normal.dot(axis.into());
                let solid_angle = if at.normal == DVec3::ZERO {
                    0.0
                } else if half_angle >= PI {
                    self.whole_sky
                } else {
                    ambient_transmittance(self.eta, cos_axis, half_angle)
                };
                scale(radiance, solid_angle)
            }
        }
    }

    fn beam(
        &self,
        at: Place,
        direction: DVec3,
        distance: f64,
        irradiance: [f64; 3],
        shadow: bool,
        region: Option<Region>,
    ) -> [f64; 3] {
        let cos = at.normal.dot(direction);
        let outside =
            |(low, high): Region| at.position.cmplt(low.into()).any() || at.position.cmpgt(high.into()).any();
        let shaded = || {
            shadow
                && self.surface.occluded(at.position.to_array(), at.triangle, direction.to_array(), distance)
        };
        if cos <= 0.0 || region.is_some_and(outside) || shaded() {
            return [0.0; 3];
        }
        scale(irradiance, transmittance(self.eta, cos) * cos)
    }
}

/// ∫ F_t(eta, cos) cos dω over the part of a cone of directions above the horizon, sr. `cos_axis` is the cosine between
/// the normal and the cone's axis, `half_angle` the cone's half opening angle in radians, 0..=π.
///
/// For eta = 1: π sin²(half_angle) cos_axis where the whole cone is above the horizon, π for the whole sky.
#[must_use]
pub fn ambient_transmittance(eta: f64, cos_axis: f64, half_angle: f64) -> f64 {
    let tilt = cos_axis.clamp(-1.0, 1.0).acos();
    let (cos_tilt, sin_tilt) = (tilt.cos(), tilt.sin());
    let half_angle = half_angle.clamp(0.0, PI);
    let azimuth = |polar: f64| {
        let (nearest, farthest) = ((polar - tilt).abs(), (polar + tilt).min(TAU - polar - tilt));
        if nearest >= half_angle {
            0.0
        } else if farthest <= half_angle {
            TAU
        } else {
            let cos = (half_angle.cos() - polar.cos() * cos_tilt) / (polar.sin() * sin_tilt);
            2.0 * cos.clamp(-1.0, 1.0).acos()
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
