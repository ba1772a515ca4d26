//! The lights in which the gather is measured.

use super::subject::Subject;
use glam::Vec3;
use std::f32::consts::{PI, TAU};
use translume::{
    AmbientLight, DirectionalLight, EnvironmentMap, Error, Light, PointLight, RectangleLight, SphereLight,
    SpotLight,
};

/// Where the sun stands.
pub const TO_SUN: Vec3 = Vec3::new(0.4, 0.7, 0.6);

/// Irradiance about 1 in the middle of the body, as from all lights here.
pub fn lamps(subject: &Subject) -> [(&'static str, Light); 4] {
    let intensity = [subject.diagonal.powi(2); 3];
    let near = [0.35, 0.35, 0.87];
    let far_place = subject.place(TO_SUN.to_array(), 1.0).to_array();
    let near_place = subject.place(near, 0.42).to_array();
    let spot = SpotLight {
        position: far_place,
        direction: (-TO_SUN).to_array(),
        intensity,
        inner_angle: 0.2,
        outer_angle: 0.35,
        ..Default::default()
    };
    [
        ("directional", Light::Directional(sun())),
        ("point", Light::Point(PointLight { position: far_place, intensity, ..Default::default() })),
        ("near point", Light::Point(PointLight { position: near_place, intensity, ..Default::default() })),
        ("spot", Light::Spot(spot)),
    ]
}

pub fn sun() -> DirectionalLight {
    DirectionalLight { to_light: TO_SUN.to_array(), irradiance: [1.0; 3], ..Default::default() }
}

pub fn constant_sky(shadow: bool) -> AmbientLight {
    AmbientLight { radiance: [1.0; 3], half_angle: PI, shadow, ..Default::default() }
}

/// A window of half a diagonal by half a diagonal that faces the body.
pub fn window(subject: &Subject) -> RectangleLight {
    let (middle, center) = (subject.place([0.0, 1.0, 0.0], 0.0), subject.place([-0.6, 0.5, 0.7], 0.8));
    let ahead = (middle - center).normalize_or(Vec3::Y);
    let right = ahead.any_orthonormal_vector();
    let half = 0.25 * subject.diagonal;
    RectangleLight {
        center: center.to_array(),
        half_right: (half * right).to_array(),
        // right × up points ahead.
        half_up: (half * ahead.cross(right)).to_array(),
        ..Default::default()
    }
}

pub fn bulb(subject: &Subject) -> SphereLight {
    let center = subject.place([0.7, 0.4, 0.6], 0.8).to_array();
    SphereLight { center, radius: 0.12 * subject.diagonal, ..Default::default() }
}

/// A sky that pales towards the horizon, dark ground, and a broad warm glow in the west, with more where `bright` says so.
pub fn sky_map(
    width: u32,
    height: u32,
    bright: impl Fn(Vec3) -> Option<[f32; 3]>,
) -> Result<EnvironmentMap, Error> {
    const ZENITH: Vec3 = Vec3::new(0.3, 0.5, 0.95);
    const HORIZON: Vec3 = Vec3::new(0.9, 0.85, 0.8);
    const GROUND: Vec3 = Vec3::new(0.25, 0.2, 0.15);
    const GLOW: Vec3 = Vec3::new(2.0, 1.2, 0.5);
    let west = Vec3::new(-1.0, 0.3, 0.2).normalize();
    let radiance = |to: Vec3| {
        let end = if to.y > 0.0 { ZENITH } else { GROUND };
        HORIZON.lerp(end, to.y.abs().powf(0.7)) + GLOW * (2.5 * (to.dot(west) - 1.0)).exp()
    };
    let direction = |k: u32| {
        let theta = PI * ((k / width) as f32 + 0.5) / height as f32;
        let phi = TAU * ((k % width) as f32 + 0.5) / width as f32;
        Vec3::new(-phi.cos() * theta.sin(), theta.cos(), -phi.sin() * theta.sin())
    };
    let pixel = |to: Vec3| bright(to).unwrap_or_else(|| radiance(to).to_array());
    EnvironmentMap::new(width, height, (0..width * height).map(direction).map(pixel).collect())
}

/// Four directional, four point and three spot lights, two rectangles, two spheres and a sky, all with shadows.
pub fn mixed(subject: &Subject) -> Vec<Light> {
    let turned = |to: Vec3, k: u32| to.rotate_y(TAU * k as f32 / 4.0 + 0.3);
    let mut lights = vec![Light::Ambient(constant_sky(true))];
    for k in 0..4 {
        let to = turned(TO_SUN, k);
        let position = subject.place(to.to_array(), 1.0).to_array();
        let intensity = [subject.diagonal.powi(2); 3];
        lights.push(Light::Directional(DirectionalLight { to_light: to.to_array(), ..sun() }));
        lights.push(Light::Point(PointLight { position, intensity, ..Default::default() }));
        if k > 0 {
            let direction = (-to).to_array();
            lights.push(Light::Spot(SpotLight { position, direction, intensity, ..Default::default() }));
        }
    }
    let half = 0.15 * subject.diagonal;
    for side in [-1.0, 1.0] {
        let center = subject.place([side, 0.2, 0.3], 0.8).to_array();
        let (half_right, half_up) = ([0.0, 0.0, side * half], [0.0, half, 0.0]);
        lights.push(Light::Rectangle(RectangleLight { center, half_right, half_up, ..Default::default() }));
        let center = subject.place([0.2, side, 0.3], 0.8).to_array();
        lights.push(Light::Sphere(SphereLight { center, ..bulb(subject) }));
    }
    lights
}
