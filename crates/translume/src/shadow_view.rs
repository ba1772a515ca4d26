//! Where depth is looked at from: the views of lights and of the sky, and their places in an array of depth maps.
//!
//! Depth is reversed: 1 at the near plane, 0 at the far one. In floating point that keeps the same relative precision at every distance.

use crate::{Light, ShadowOptions};
use glam::camera::rh::{proj, view};
use glam::{Mat4, Vec3, Vec4};

/// A point light further off its body than this (cosine of the half angle under which the body appears) needs one view; a nearer
/// one, or one inside, needs six.
const SINGLE_VIEW_COSINE: f32 = 0.5;
/// A spot light with a wider cone (radians) takes six views: one would be stretched too far towards its rim.
const WIDEST_CONE: f32 = 1.05;
/// Room around the body for filtering, in texels of the map.
const MARGIN: f32 = 4.0;
/// Least half width of a view, mm (of a perspective view at a depth of 1 mm), and least depth, mm: a pose may gather its body in one point,
/// and a matrix that divides by its extent would not be finite.
const LEAST_EXTENT: f32 = 1e-6;
/// Tiles are as wide as a layer of the array, or down to a sixteenth of it.
const MAX_SHIFT: u32 = 4;

/// One depth map: a matrix from millimetres to clip space, and its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View {
    pub matrix: Mat4,
    /// Width of a texel, mm; for a perspective view at a depth of 1 mm.
    pub texel: f32,
    pub perspective: bool,
    /// Its width is that of a layer divided by 2^shift.
    shift: u32,
    pub tile: Tile,
}

/// A square of a layer, in texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tile {
    pub layer: u32,
    pub x: u32,
    pub y: u32,
    pub width: u32,
}

/// What is to be seen: the body, and whatever else casts shadows on it.
pub(crate) struct Subject<'a> {
    /// Corners of the body's bounding box, mm.
    pub corners: &'a [Vec3; 8],
    /// Corners of a box around the host's casters, mm.
    pub casters: Option<&'a [Vec3; 8]>,
}

impl Subject<'_> {
    fn centre(&self) -> Vec3 {
        self.corners.iter().sum::<Vec3>() / 8.0
    }

    /// The middle of the body's box and half its diagonal.
    pub fn ball(&self) -> (Vec3, f32) {
        (self.centre(), 0.5 * self.corners[0].distance(self.corners[7]))
    }
}

/// What one light needs: its emitters (none for a directional light), and for each the same number of views, 0, 1 or 6.
#[derive(Debug, Default)]
pub(crate) struct LightViews {
    /// Position, mm, and area, mm².
    pub emitters: Vec<Vec4>,
    pub views: Vec<View>,
    pub views_per_emitter: u32,
}

/// The emitters and views of one light over a body. `light` is in world units; `scale` takes it to millimetres.
pub(crate) fn light_views(
    light: &Light,
    scale: f32,
    subject: &Subject<'_>,
    options: &ShadowOptions,
) -> LightViews {
    let resolution = options.resolution;
    let whole =
        |views: Vec<View>| LightViews { views_per_emitter: views.len() as u32, views, emitters: Vec::new() };
    match light {
        Light::Directional(light) if light.shadow => {
            whole(vec![directional_view(Vec3::from(light.to_light).normalize(), subject, resolution, 0)])
        }
        Light::Point(light) if light.shadow => {
            whole(point_views(Vec3::from(light.position) * scale, subject, resolution))
        }
        Light::Spot(light) if light.shadow => {
            let position = Vec3::from(light.position) * scale;
            let views = point_views(position, subject, resolution);
            if views.len() > 1 && light.outer_angle <= WIDEST_CONE {
                whole(vec![cone_view(
                    position,
                    light.direction.into(),
                    light.outer_angle,
                    subject,
                    resolution,
                )])
            } else {
                whole(views)
            }
        }
        Light::Rectangle(light) => {
            area_views(light.emitters(scale, options.area_points), light.shadow, subject, options)
        }
        Light::Sphere(light) => {
            let (middle, reach) = subject.ball();
            let emitters = light.emitters(scale, options.area_points, middle, reach);
            area_views(emitters, light.shadow, subject, options)
        }
        Light::Ambient(light) if light.is_shadowed_by_points(options) => {
            let emitters = light.emitters(options.area_points);
            let shift = shared_shift(emitters.len());
            let directions = emitters.iter().map(|emitter| emitter.truncate());
            let views =
                directions.map(|to_sky| directional_view(to_sky, subject, resolution, shift)).collect();
            LightViews { emitters, views, views_per_emitter: 1 }
        }
        _ => LightViews::default(),
    }
}

/// The largest squares of which this many share a layer.
fn shared_shift(count: usize) -> u32 {
    (0..MAX_SHIFT).find(|shift| count <= 1 << (2 * shift)).unwrap_or(MAX_SHIFT)
}

/// All the points of an area light together take as much room as one point light.
fn area_views(
    emitters: Vec<Vec4>,
    shadow: bool,
    subject: &Subject<'_>,
    options: &ShadowOptions,
) -> LightViews {
    if !shadow {
        return LightViews { emitters, ..Default::default() };
    }
    let shift = shared_shift(emitters.len());
    let points = emitters.iter().map(|emitter| emitter.truncate());
    let one_each = points.clone().all(|point| is_narrow(point, subject));
    let views = points.flat_map(|point| views_from(point, one_each, subject, options.resolution, shift));
    LightViews { views: views.collect(), views_per_emitter: if one_each { 1 } else { 6 }, emitters }
}

/// The views of the sky, one along each of these directions towards it.
pub(crate) fn sky_view(to_sky: Vec3, subject: &Subject<'_>, tile: Tile) -> View {
    View { tile, ..directional_view(to_sky, subject, tile.width, 0) }
}

/// Gives every view a square of its own, larger ones first: with widths of powers of two the Morton order leaves no gap. Returns how many
/// layers they fill.
pub(crate) fn pack(views: &mut [View], resolution: u32) -> u32 {
    let mut order: Vec<usize> = (0..views.len()).collect();
    order.sort_by_key(|&k| views[k].shift);
    let mut cursor = 0_u32;
    for k in order {
        let view = &mut views[k];
        let within = (cursor % (1 << (2 * MAX_SHIFT))) >> (2 * (MAX_SHIFT - view.shift));
        let width = resolution >> view.shift;
        view.tile = Tile {
            layer: cursor >> (2 * MAX_SHIFT),
            x: even_bits(within) * width,
            y: even_bits(within >> 1) * width,
            width,
        };
        cursor += 1 << (2 * (MAX_SHIFT - view.shift));
    }
    cursor.div_ceil(1 << (2 * MAX_SHIFT))
}

/// Bits 0, 2, 4 … moved together.
fn even_bits(word: u32) -> u32 {
    (0..MAX_SHIFT).map(|k| (word >> (2 * k) & 1) << k).sum()
}

/// What a spot light near or inside its body sees: beyond its cone it is dark anyway.
fn cone_view(position: Vec3, axis: Vec3, outer_angle: f32, subject: &Subject<'_>, resolution: u32) -> View {
    let axis = axis.normalize();
    let look = view::look_to_mat4(position, axis, axis.any_orthonormal_vector());
    let far = reach(position, subject);
    perspective(look, outer_angle.tan(), 1e-4 * far, far, resolution, 0)
}

/// A little more than the distance of the furthest corner.
fn reach(position: Vec3, subject: &Subject<'_>) -> f32 {
    1.02 * subject.corners.iter().map(|corner| corner.distance(position)).fold(LEAST_EXTENT, f32::max)
}

fn directional_view(to_light: Vec3, subject: &Subject<'_>, resolution: u32, shift: u32) -> View {
    let look = view::look_to_mat4(subject.centre(), -to_light, to_light.any_orthonormal_vector());
    let seen = subject.corners.map(|corner| look.transform_point3(corner));
    let (low, high) = (reduce(&seen, Vec3::min), reduce(&seen, Vec3::max));
    let half = 0.5 * (high - low).truncate().max_element().max(LEAST_EXTENT);
    let half = half * margin(resolution >> shift);
    let middle = 0.5 * (low + high);
    let slack = 0.01 * (high - low).max_element().max(LEAST_EXTENT);
    let casters = subject.casters.into_iter().flatten();
    let nearest = casters.map(|corner| look.transform_point3(*corner).z).fold(high.z, f32::max);
    let matrix = proj::directx::orthographic(
        middle.x - half,
        middle.x + half,
        middle.y - half,
        middle.y + half,
        -nearest - slack,
        -low.z + slack,
    );
    View {
        matrix: reversed(matrix) * look,
        texel: 2.0 * half / (resolution >> shift) as f32,
        perspective: false,
        shift,
        tile: Tile::default(),
    }
}

fn margin(resolution: u32) -> f32 {
    1.0 + 2.0 * MARGIN / resolution as f32
}

fn point_views(position: Vec3, subject: &Subject<'_>, resolution: u32) -> Vec<View> {
    views_from(position, is_narrow(position, subject), subject, resolution, 0)
}

/// One view that sees all of the body, or six that look all around.
fn views_from(position: Vec3, narrow: bool, subject: &Subject<'_>, resolution: u32, shift: u32) -> Vec<View> {
    if narrow {
        vec![narrow_view(position, subject, resolution, shift)]
    } else {
        cube_views(position, subject, resolution, shift)
    }
}

fn towards_body(position: Vec3, subject: &Subject<'_>) -> Mat4 {
    let forward = (subject.centre() - position).normalize_or(Vec3::Z);
    view::look_to_mat4(position, forward, forward.any_orthonormal_vector())
}

/// Whether one view sees all of the body.
fn is_narrow(position: Vec3, subject: &Subject<'_>) -> bool {
    let look = towards_body(position, subject);
    let seen = subject.corners.map(|corner| look.transform_point3(corner));
    seen.iter().all(|p| -p.z > SINGLE_VIEW_COSINE * p.length())
}

fn narrow_view(position: Vec3, subject: &Subject<'_>, resolution: u32, shift: u32) -> View {
    let look = towards_body(position, subject);
    let seen = subject.corners.map(|corner| look.transform_point3(corner));
    let tangent = seen.iter().map(|p| p.x.abs().max(p.y.abs()) / -p.z).fold(LEAST_EXTENT, f32::max);
    let (near, far) = (-reduce(&seen, Vec3::max).z, -reduce(&seen, Vec3::min).z);
    let near = if subject.casters.is_some() { 1e-4 * far } else { 0.98 * near };
    perspective(look, tangent, near, 1.02 * far, resolution, shift)
}

fn cube_views(position: Vec3, subject: &Subject<'_>, resolution: u32, shift: u32) -> Vec<View> {
    let far = reach(position, subject);
    let faces = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    faces
        .map(|face| {
            let look = view::look_to_mat4(position, face, face.any_orthonormal_vector());
            // A face is drawn a little wider than a quarter turn, so that filtering never leaves it.
            perspective(look, 1.05, 1e-4 * far, far, resolution, shift)
        })
        .to_vec()
}

fn perspective(look: Mat4, tangent: f32, near: f32, far: f32, resolution: u32, shift: u32) -> View {
    let tangent = tangent * margin(resolution >> shift);
    let matrix = proj::directx::perspective(2.0 * tangent.atan(), 1.0, near, far);
    View {
        matrix: reversed(matrix) * look,
        texel: 2.0 * tangent / (resolution >> shift) as f32,
        perspective: true,
        shift,
        tile: Tile::default(),
    }
}

/// Depth z/w becomes 1 − z/w.
fn reversed(projection: Mat4) -> Mat4 {
    Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::NEG_Z, Vec4::new(0.0, 0.0, 1.0, 1.0)) * projection
}

fn reduce(points: &[Vec3; 8], f: fn(Vec3, Vec3) -> Vec3) -> Vec3 {
    points.iter().copied().reduce(f).unwrap_or_default()
}

#[cfg(test)]
mod tests;
