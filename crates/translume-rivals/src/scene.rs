//! Camera and lights of a frame, checked and as WGSL reads them.

use crate::Error;
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use translume::{Camera, Light, Medium, Profile, Region};

/// Lights a frame may have, each with a map of its own.
pub const MAX_LIGHTS: usize = 4;
/// Half the angle of view of a point light's map, as a cosine: beyond it texels would be stretched too far.
const WIDEST_COSINE: f32 = 0.5;
/// Room around the body, in texels of the map.
const MARGIN: f32 = 4.0;

/// The inputs of one frame.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// What the body is made of.
    pub medium: Medium,
    /// Directional and point lights, at most [`MAX_LIGHTS`], world units.
    pub lights: &'a [Light],
    /// Where the picture is taken from, world units; in perspective.
    pub camera: Camera,
    /// Millimetres per world unit.
    pub mm_per_unit: f32,
    /// Corners of a box around the body's vertices, mm.
    pub bounds: [[f32; 3]; 2],
}

/// A light, as WGSL reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct LightLayout {
    pub origin: [f32; 3],
    pub perspective: f32,
    pub right: [f32; 3],
    pub half_width: f32,
    pub up: [f32; 3],
    pub near: f32,
    pub forward: [f32; 3],
    pub far: f32,
    pub colour: [f32; 3],
    pub shadow: f32,
    pub region_low: [f32; 3],
    pub padding0: u32,
    pub region_high: [f32; 3],
    pub padding1: u32,
}

/// Camera and lights, as WGSL reads them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct SceneLayout {
    pub view_projection: [[f32; 4]; 4],
    pub eye: [f32; 3],
    pub eta: f32,
    pub exit_scale: f32,
    pub light_count: u32,
    pub padding: [u32; 2],
    pub lights: [LightLayout; MAX_LIGHTS],
}

impl SceneLayout {
    /// `map`: width of the lights' maps, texels.
    ///
    /// # Errors
    /// [`Error`] names the light, the coefficient or what else cannot be.
    pub fn new(frame: &Frame<'_>, map: u32) -> Result<Self, Error> {
        frame.medium.validate()?;
        let fail = |problem: &str, remedy| Err(Error::Frame { problem: problem.to_owned(), remedy });
        if frame.lights.len() > MAX_LIGHTS {
            let problem = format!("{} lights, but at most {MAX_LIGHTS} have a map", frame.lights.len());
            return Err(Error::Frame { problem, remedy: "leave lights out" });
        }
        if !(frame.mm_per_unit > 0.0 && frame.mm_per_unit.is_finite()) {
            return fail("a unit is no length", "give a finite mm_per_unit above 0");
        }
        let [low, high] = frame.bounds.map(Vec3::from);
        if !((high - low).min_element() >= 0.0 && low.is_finite() && high.is_finite()) {
            return fail("the body's bounds are not a box", "give the least and the greatest corner, mm");
        }
        let view = view_projection(frame);
        if !view.is_finite() || view.row(3).truncate().length() < 1e-12 {
            return fail("the camera has no perspective", "give a finite perspective projection");
        }
        let mut lights = [LightLayout::zeroed(); MAX_LIGHTS];
        for (index, light) in frame.lights.iter().enumerate() {
            lights[index] = layout(index, light, frame, map)?;
        }
        Ok(Self {
            view_projection: view.to_cols_array_2d(),
            eye: frame.camera.eye.map(|x| x * frame.mm_per_unit),
            eta: frame.medium.ior,
            exit_scale: Profile::DipoleNormalised.exit_scale(frame.medium.ior) / std::f32::consts::PI,
            light_count: frame.lights.len() as u32,
            padding: [0; 2],
            lights,
        })
    }
}

/// Millimetres to clip space, scaled so that w is a depth in mm.
fn view_projection(frame: &Frame<'_>) -> Mat4 {
    let to_world = Mat4::from_scale(Vec3::splat(1.0 / frame.mm_per_unit));
    Mat4::from_cols_array_2d(&frame.camera.view_projection) * to_world * frame.mm_per_unit
}

/// Pixels per mm at a depth of 1 mm, across and down.
pub(crate) fn focal(frame: &Frame<'_>, [width, height]: [u32; 2]) -> [f32; 2] {
    let view = view_projection(frame);
    let deep = view.row(3).truncate().length();
    let half = |row: usize, pixels: u32| 0.5 * pixels as f32 * view.row(row).truncate().length() / deep;
    [half(0, width), half(1, height)]
}

fn layout(index: usize, light: &Light, frame: &Frame<'_>, map: u32) -> Result<LightLayout, Error> {
    let fail = |problem, remedy| Err(Error::Light { index, problem, remedy });
    let (colour, direction, position, shadow, region) = match light {
        Light::Directional(sun) => (sun.irradiance, Some(sun.to_light), [0.0; 3], sun.shadow, sun.region),
        Light::Point(lamp) => {
            let square = frame.mm_per_unit * frame.mm_per_unit;
            (lamp.intensity.map(|x| x * square), None, lamp.position, lamp.shadow, lamp.region)
        }
        _ => return fail("is neither directional nor a point", "give one of these"),
    };
    if colour.iter().any(|c| !(0.0..=f32::MAX).contains(c)) || position.iter().any(|x| !x.is_finite()) {
        return fail("has a colour or a place that cannot be", "give finite numbers, colours not negative");
    }
    let [low, high] = frame.bounds.map(Vec3::from);
    let centre = 0.5 * (low + high);
    let origin = direction.map_or(Vec3::from(position) * frame.mm_per_unit, |_| centre);
    let forward = direction.map_or(centre - origin, |to| -Vec3::from(to)).normalize_or_zero();
    if forward == Vec3::ZERO || !forward.is_finite() {
        return fail("has no direction to the body", "move it, or give a vector that is not zero");
    }
    let right = forward.any_orthonormal_vector();
    let up = right.cross(forward);
    let corners = (0..8).map(|k| Vec3::select(glam::BVec3::new(k & 1 > 0, k & 2 > 0, k & 4 > 0), high, low));
    let seen = corners.map(|p| p - origin).map(|p| Vec3::new(p.dot(right), p.dot(up), p.dot(forward)));
    let (mut near, mut far, mut half_width) = (f32::INFINITY, f32::NEG_INFINITY, 1e-6_f32);
    for p in seen {
        if direction.is_none() && p.z < WIDEST_COSINE * p.length() {
            return fail("is so near that one map does not see all of the body", "move it away");
        }
        let scale = if direction.is_none() { p.z } else { 1.0 };
        half_width = half_width.max(p.x.abs().max(p.y.abs()) / scale);
        (near, far) = (near.min(p.z), far.max(p.z));
    }
    let slack = 0.01 * (far - near).max(1e-6);
    let region = region.unwrap_or(Region { low: [f32::MIN; 3], high: [f32::MAX; 3] });
    let mm = |corner: [f32; 3]| corner.map(|x| (x * frame.mm_per_unit).clamp(f32::MIN, f32::MAX));
    Ok(LightLayout {
        origin: origin.to_array(),
        perspective: f32::from(u8::from(direction.is_none())),
        right: right.to_array(),
        half_width: half_width * (1.0 + 2.0 * MARGIN / map as f32),
        up: up.to_array(),
        near: if direction.is_none() { (near - slack).max(0.5 * near) } else { near - slack },
        forward: forward.to_array(),
        far: far + slack,
        colour,
        shadow: f32::from(u8::from(shadow)),
        region_low: mm(region.low),
        padding0: 0,
        region_high: mm(region.high),
        padding1: 0,
    })
}
