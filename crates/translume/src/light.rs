//! Lights, in the host's world units.

use crate::boundary::Boundary;
use crate::{EnvironmentLight, Error, RectangleLight, SphereLight};
use glam::Vec3;

/// A source of light. Positions are in world units; colours are linear RGB.
///
/// Irradiance, intensity and radiance share one unit of power and the host's unit of length, so what comes out has the unit that
/// went in: a radiance of 1 all around a white body returns 1.
///
/// ```
/// use translume::{AmbientLight, Light, PointLight};
///
/// let lights = [
///     Light::Point(PointLight { position: [0.0, 2.0, 1.0], intensity: [5.0; 3], ..Default::default() }),
///     Light::Ambient(AmbientLight { radiance: [0.1; 3], ..Default::default() }),
/// ];
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Light {
    /// Parallel light, such as the sun.
    Directional(DirectionalLight),
    /// Light from a point, falling off with the square of the distance.
    Point(PointLight),
    /// Light from a point into a cone.
    Spot(SpotLight),
    /// Light from one side of a rectangle.
    Rectangle(RectangleLight),
    /// Light from a ball.
    Sphere(SphereLight),
    /// The same radiance from every direction of a cone, or of the whole sky.
    Ambient(AmbientLight),
    /// Radiance from everywhere, such as the sky of an [`EnvironmentMap`](crate::EnvironmentMap).
    Environment(EnvironmentLight),
}

/// Parallel light.
///
/// ```
/// use translume::DirectionalLight;
///
/// let sun = DirectionalLight { to_light: [0.5, 1.0, 0.3], irradiance: [3.0, 2.8, 2.5], ..Default::default() };
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    /// From the body towards the light; any length but zero.
    pub to_light: [f32; 3],
    /// Irradiance on a surface that faces the light, RGB. π makes a white surface show radiance 1.
    pub irradiance: [f32; 3],
    /// Whether the body shadows itself.
    pub shadow: bool,
    /// Light enters only inside this box; `None` for everywhere.
    pub region: Option<Region>,
}

/// Light from a point.
///
/// ```
/// use translume::PointLight;
///
/// // Irradiance 1 on a surface that faces it from half a unit away.
/// let lamp = PointLight { position: [0.0, 0.5, 0.0], intensity: [0.25; 3], ..Default::default() };
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Position, world units. It may lie inside a body.
    pub position: [f32; 3],
    /// Radiant intensity, RGB: irradiance = intensity · cosine / distance², distance in world units.
    pub intensity: [f32; 3],
    /// Whether the body shadows itself.
    pub shadow: bool,
    /// Light enters only inside this box; `None` for everywhere.
    pub region: Option<Region>,
}

/// Light from a point into a cone, as in the glTF extension `KHR_lights_punctual`.
///
/// ```
/// use translume::SpotLight;
///
/// let spot = SpotLight { position: [0.0, 3.0, 0.0], direction: [0.0, -1.0, 0.0], outer_angle: 0.4, ..Default::default() };
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotLight {
    /// Position, world units. It may lie inside a body.
    pub position: [f32; 3],
    /// Where it shines to; any length but zero.
    pub direction: [f32; 3],
    /// Radiant intensity along its axis, RGB; between the two angles it falls to nothing by [`SpotLight::falloff`].
    pub intensity: [f32; 3],
    /// Angle from the axis up to which it is as bright as on the axis, radians, from 0 to below `outer_angle`.
    pub inner_angle: f32,
    /// Angle from the axis beyond which it is dark, radians, above `inner_angle` and at most π/2.
    pub outer_angle: f32,
    /// Whether the body shadows itself.
    pub shadow: bool,
    /// Light enters only inside this box; `None` for everywhere.
    pub region: Option<Region>,
}

/// Uniform light from a cone of the sky.
///
/// ```
/// use translume::AmbientLight;
///
/// // The upper half of the sky, shadowed by the body itself.
/// let sky = AmbientLight { half_angle: std::f32::consts::FRAC_PI_2, shadow: true, ..Default::default() };
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AmbientLight {
    /// Radiance inside the cone, RGB.
    pub radiance: [f32; 3],
    /// Middle of the cone, towards the sky; any length but zero.
    pub axis: [f32; 3],
    /// Half angle of the cone, radians, 0..π; π is the whole sky.
    pub half_angle: f32,
    /// Whether the body occludes it.
    pub shadow: bool,
}

/// An axis-aligned box, world units.
///
/// ```
/// use translume::{DirectionalLight, Region};
///
/// // Light enters only where x is above 0: a straight edge of shadow.
/// let half = Region { low: [0.0, -1e6, -1e6], high: [1e6; 3] };
/// let sun = DirectionalLight { region: Some(half), ..Default::default() };
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Least corner.
    pub low: [f32; 3],
    /// Greatest corner.
    pub high: [f32; 3],
}

impl Default for DirectionalLight {
    /// A white light from above that shows radiance 1 on white.
    fn default() -> Self {
        Self { to_light: [0.0, 1.0, 0.0], irradiance: [std::f32::consts::PI; 3], shadow: true, region: None }
    }
}

impl Default for PointLight {
    fn default() -> Self {
        Self { position: [0.0; 3], intensity: [1.0; 3], shadow: true, region: None }
    }
}

impl Default for SpotLight {
    /// Downwards, dark from 45° on, as in glTF.
    fn default() -> Self {
        Self {
            position: [0.0; 3],
            direction: [0.0, -1.0, 0.0],
            intensity: [1.0; 3],
            inner_angle: 0.0,
            outer_angle: std::f32::consts::FRAC_PI_4,
            shadow: true,
            region: None,
        }
    }
}

impl SpotLight {
    /// Scale s and offset o of the angular falloff clamp(s·c + o, 0, 1)², where c is the cosine of the angle from the axis.
    ///
    /// Source: `KHR_lights_punctual`, "Inner and Outer Cone Angles".
    #[must_use]
    pub fn falloff(&self) -> [f32; 2] {
        let [inner, outer] = [self.inner_angle, self.outer_angle].map(f32::cos);
        let scale = 1.0 / (inner - outer).max(0.001);
        [scale, -outer * scale]
    }
}

impl Default for AmbientLight {
    /// The whole sky at radiance 1, unoccluded.
    fn default() -> Self {
        Self { radiance: [1.0; 3], axis: [0.0, 1.0, 0.0], half_angle: std::f32::consts::PI, shadow: false }
    }
}

impl Light {
    /// Checks every number. `index` names the light in messages.
    pub(crate) fn validate(&self, index: usize) -> Result<(), Error> {
        let fail = |problem: String, remedy| {
            Err(Error::Frame { problem: format!("light {index} {problem}"), remedy })
        };
        let (colour, vectors, direction) = match self {
            Self::Directional(light) => (light.irradiance, [light.to_light; 2], Some(light.to_light)),
            Self::Point(light) => (light.intensity, [light.position; 2], None),
            Self::Spot(light) => {
                let SpotLight { inner_angle: inner, outer_angle: outer, .. } = *light;
                // NaN is no angle either.
                if !(0.0 <= inner && inner < outer && outer <= std::f32::consts::FRAC_PI_2) {
                    return fail(
                        format!("has a cone from {inner} to {outer} radians"),
                        "give 0 ≤ inner_angle < outer_angle ≤ π/2",
                    );
                }
                (light.intensity, [light.position, light.direction], Some(light.direction))
            }
            Self::Rectangle(light) => {
                let [right, up] = [light.half_right, light.half_up].map(Vec3::from);
                let area = right.cross(up).length();
                // A hundredth of a right angle is a slip of the pen, not a parallelogram.
                if !(area > 0.0 && right.dot(up).abs() <= 0.02 * area) {
                    return fail(
                        format!("has edges {:?} and {:?}", light.half_right, light.half_up),
                        "give two vectors that are not zero, at a right angle",
                    );
                }
                (light.radiance, [light.center; 2], None)
            }
            Self::Sphere(light) => {
                if !(light.radius > 0.0 && light.radius.is_finite()) {
                    return fail(format!("has radius {}", light.radius), "give a finite radius above 0");
                }
                (light.radiance, [light.center; 2], None)
            }
            Self::Ambient(light) => (light.radiance, [light.axis, [light.half_angle; 3]], Some(light.axis)),
            Self::Environment(light) => {
                // Harmonics may be negative.
                return match light.coefficients.iter().position(|rgb| rgb.iter().any(|c| !c.is_finite())) {
                    Some(k) => fail(
                        format!("has coefficient {k} {:?}", light.coefficients[k]),
                        "coefficients are finite",
                    ),
                    None => Ok(()),
                };
            }
        };
        if colour.iter().any(|c| !(0.0..=f32::MAX).contains(c)) {
            return fail(format!("has colour {colour:?}"), "colours are finite and not negative");
        }
        if vectors.iter().flatten().any(|x| !x.is_finite()) {
            return fail(
                format!("has a coordinate or angle that is not finite: {vectors:?}"),
                "give finite numbers",
            );
        }
        if direction.is_some_and(|d| d.iter().map(|x| x * x).sum::<f32>() < 1e-20) {
            return fail("has no direction".to_owned(), "give a vector that is not zero");
        }
        Ok(())
    }
}

/// Irradiance inside the surface from a cone of unit radiance, ∫ F_t·g·cos dω over cone ∩ hemisphere with g the gain of entry, RGB and 0,
/// as a table over the cosine between the surface's normal and the cone's axis from −1 to 1.
pub(crate) fn ambient_table<const N: usize>(half_angle: f32, boundary: &Boundary) -> [[f32; 4]; N] {
    let half_angle = f64::from(half_angle).clamp(0.0, std::f64::consts::PI);
    let entry = |[r, g, b]: [f64; 3]| [r as f32, g as f32, b as f32, 0.0];
    if half_angle >= std::f64::consts::PI {
        return [entry(boundary.lobe()[0]); N];
    }
    let cosine = |k: usize| 2.0 * k as f64 / (N - 1) as f64 - 1.0;
    std::array::from_fn(|k| entry(cone_irradiance(cosine(k), half_angle, boundary)))
}

/// Rings around the normal: on the ring at angle θ the cone covers an arc known in closed form. Only rings the cone reaches count.
fn cone_irradiance(cosine: f64, half_angle: f64, boundary: &Boundary) -> [f64; 3] {
    const RINGS: usize = 512;
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let tilt = cosine.clamp(-1.0, 1.0).acos();
    let first = (tilt - half_angle).max(0.0);
    let last = (tilt + half_angle).min(std::f64::consts::FRAC_PI_2);
    let step = (last - first).max(0.0) / RINGS as f64;
    let mut sum = [0.0; 3];
    for k in 0..RINGS {
        let (ring_sin, ring_cos) = (first + (k as f64 + 0.5) * step).sin_cos();
        let edge = (half_angle.cos() - ring_cos * cosine) / (ring_sin * sine).max(1e-12);
        let arc = 2.0 * edge.clamp(-1.0, 1.0).acos();
        let entering = boundary.entering(ring_cos);
        sum = std::array::from_fn(|c| sum[c] + entering[c] * ring_cos * ring_sin * arc * step);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Without a gain.
    fn cone(cosine: f64, half_angle: f64, eta: f32) -> f64 {
        cone_irradiance(cosine, half_angle, &Boundary { eta, slant: [0.0; 3], on_surface: false })[0]
    }

    #[test]
    fn half_a_sky_has_a_closed_form() {
        // A hemisphere of sky tilted by γ gives π(1 + cos γ)/2 at eta = 1. 0.1 %: 512 rings against a kink.
        for cosine in [-1.0, -0.3, 0.0, 0.5, 1.0] {
            let expected = PI * (1.0 + cosine) / 2.0;
            assert!((cone(cosine, FRAC_PI_2, 1.0) - expected).abs() < 1e-3 * PI, "{cosine}");
        }
    }

    #[test]
    fn a_narrow_cone_is_a_directional_light() {
        let half_angle: f64 = 0.1;
        let solid_angle = 2.0 * PI * (1.0 - half_angle.cos());
        for (cosine, eta) in [(1.0, 1.0), (0.6, 1.0), (0.6, 1.5)] {
            let expected = solid_angle * cosine * crate::fresnel::transmittance(eta.into(), cosine);
            let found = cone(cosine, half_angle, eta);
            assert!((found / expected - 1.0).abs() < 0.02, "{cosine} {eta}: {found} {expected}");
        }
    }

    #[test]
    fn impossible_lights_are_named() {
        let dark = Light::Directional(DirectionalLight { to_light: [0.0; 3], ..Default::default() });
        assert!(dark.validate(3).unwrap_err().to_string().contains("light 3 has no direction"));
        let nan = Light::Point(PointLight { position: [0.0, f32::NAN, 0.0], ..Default::default() });
        assert!(nan.validate(0).is_err());
        let negative = Light::Ambient(AmbientLight { radiance: [1.0, -1.0, 1.0], ..Default::default() });
        assert!(negative.validate(0).is_err());
        for (inner_angle, outer_angle) in
            [(0.5, 0.5), (-0.1, 0.5), (0.1, 1.6), (f32::NAN, 0.5), (0.1, f32::NAN)]
        {
            let cone = Light::Spot(SpotLight { inner_angle, outer_angle, ..Default::default() });
            let message = cone.validate(5).unwrap_err().to_string();
            assert!(message.contains("light 5 has a cone"), "{message}");
        }
        assert!(Light::Spot(SpotLight::default()).validate(0).is_ok());
        let skewed = RectangleLight { half_up: [0.5, 1.0, 0.0], ..Default::default() };
        let flat = RectangleLight { half_up: [0.0; 3], ..Default::default() };
        for light in [skewed, flat] {
            assert!(Light::Rectangle(light).validate(0).unwrap_err().to_string().contains("right angle"));
        }
        assert!(Light::Rectangle(RectangleLight::default()).validate(0).is_ok());
        let nothing = Light::Sphere(SphereLight { radius: 0.0, ..Default::default() });
        assert!(nothing.validate(0).unwrap_err().to_string().contains("radius"));
        let aimless = Light::Spot(SpotLight { direction: [0.0; 3], ..Default::default() });
        assert!(aimless.validate(0).is_err());
        assert!(Light::Ambient(AmbientLight::default()).validate(0).is_ok());
        let mut sky = EnvironmentLight::default();
        sky.coefficients[3] = [-1.0; 3];
        assert!(Light::Environment(sky).validate(0).is_ok());
        sky.coefficients[7] = [0.0, f32::INFINITY, 0.0];
        let message = Light::Environment(sky).validate(4).unwrap_err().to_string();
        assert!(message.contains("light 4 has coefficient 7"), "{message}");
    }
}
