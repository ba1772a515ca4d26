//! Lights, in millimetres.

use glam::DVec3;
use std::sync::Arc;
use translume::{EnvironmentMap, Light, Region};

/// A light in millimetres. Intensity is per steradian, so its irradiance over distance² takes the square of the scale.
/// `None` for a kind that rays do not know, such as harmonics.
#[must_use]
pub fn light(light: &Light, mm_per_unit: f64) -> Option<translume_reference::Light> {
    use translume_reference::Light as Twin;
    let mm = |p: [f32; 3]| p.map(|x| f64::from(x) * mm_per_unit);
    let region = |region: Option<Region>| region.map(|r| (mm(r.low), mm(r.high)));
    Some(match light {
        Light::Directional(light) => Twin::Directional {
            to_light: DVec3::from(light.to_light.map(f64::from)).normalize().to_array(),
            irradiance: light.irradiance.map(f64::from),
            shadow: light.shadow,
            region: region(light.region),
        },
        Light::Point(light) => Twin::Point {
            position: mm(light.position),
            intensity: light.intensity.map(|x| f64::from(x) * mm_per_unit * mm_per_unit),
            shadow: light.shadow,
            region: region(light.region),
        },
        Light::Spot(light) => Twin::Spot {
            position: mm(light.position),
            direction: light.direction.map(f64::from),
            intensity: light.intensity.map(|x| f64::from(x) * mm_per_unit * mm_per_unit),
            inner_angle: light.inner_angle.into(),
            outer_angle: light.outer_angle.into(),
            shadow: light.shadow,
            region: region(light.region),
        },
        Light::Rectangle(light) => Twin::Rectangle {
            center: mm(light.center),
            half_right: mm(light.half_right),
            half_up: mm(light.half_up),
            radiance: light.radiance.map(f64::from),
            shadow: light.shadow,
        },
        Light::Sphere(light) => Twin::Sphere {
            center: mm(light.center),
            radius: f64::from(light.radius) * mm_per_unit,
            radiance: light.radiance.map(f64::from),
            shadow: light.shadow,
        },
        Light::Ambient(light) => Twin::Ambient {
            radiance: light.radiance.map(f64::from),
            axis: DVec3::from(light.axis.map(f64::from)).normalize().to_array(),
            half_angle: light.half_angle.into(),
            shadow: light.shadow,
        },
        _ => return None,
    })
}

/// A map of the environment in double precision; `None` where it is empty.
#[must_use]
pub fn map(map: &EnvironmentMap) -> Option<Arc<translume_reference::EnvironmentMap>> {
    let pixels = map.pixels().iter().map(|rgb| rgb.map(f64::from)).collect();
    translume_reference::EnvironmentMap::new(map.width() as usize, map.height() as usize, pixels)
        .map(Arc::new)
}
