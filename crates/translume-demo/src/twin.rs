//! What the library is given, as the reference takes it: millimetres, in double precision.

use glam::DVec3;
use std::sync::Arc;
use translume::Light;
use translume_reference::EnvironmentMap;

/// A light in millimetres; `None` for a kind that rays do not know, such as harmonics. Intensity is per steradian, so its
/// irradiance over distance² takes the square of the scale.
pub fn light(light: &Light, mm_per_unit: f64) -> Option<translume_reference::Light> {
    use translume_reference::Light as Twin;
    let double = |v: [f32; 3]| v.map(f64::from);
    let mm = |p: [f32; 3]| p.map(|x| f64::from(x) * mm_per_unit);
    let unit = |v: [f32; 3]| DVec3::from(double(v)).normalize().to_array();
    let intensity = |rgb: [f32; 3]| rgb.map(|c| f64::from(c) * mm_per_unit * mm_per_unit);
    let region = |region: Option<translume::Region>| region.map(|region| (mm(region.low), mm(region.high)));
    Some(match light {
        Light::Directional(light) => Twin::Directional {
            to_light: unit(light.to_light),
            irradiance: double(light.irradiance),
            shadow: light.shadow,
            region: region(light.region),
        },
        Light::Point(light) => Twin::Point {
            position: mm(light.position),
            intensity: intensity(light.intensity),
            shadow: light.shadow,
            region: region(light.region),
        },
        Light::Spot(light) => Twin::Spot {
            position: mm(light.position),
            direction: double(light.direction),
            intensity: intensity(light.intensity),
            inner_angle: light.inner_angle.into(),
            outer_angle: light.outer_angle.into(),
            shadow: light.shadow,
            region: region(light.region),
        },
        Light::Rectangle(light) => Twin::Rectangle {
            center: mm(light.center),
            half_right: mm(light.half_right),
            half_up: mm(light.half_up),
            radiance: double(light.radiance),
            shadow: light.shadow,
        },
        Light::Sphere(light) => Twin::Sphere {
            center: mm(light.center),
            radius: f64::from(light.radius) * mm_per_unit,
            radiance: double(light.radiance),
            shadow: light.shadow,
        },
        Light::Ambient(light) => Twin::Ambient {
            radiance: double(light.radiance),
            axis: unit(light.axis),
            half_angle: light.half_angle.into(),
            shadow: light.shadow,
        },
        _ => return None,
    })
}

/// The library's map in double precision.
pub fn map(map: &translume::EnvironmentMap) -> Option<Arc<EnvironmentMap>> {
    let pixels = map.pixels().iter().map(|rgb| rgb.map(f64::from)).collect();
    EnvironmentMap::new(map.width() as usize, map.height() as usize, pixels).map(Arc::new)
}
