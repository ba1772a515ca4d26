//! Where the picture is taken from.

use glam::camera::rh::{proj, view};
use glam::{Mat4, Vec3};

/// A camera, in the host's world units. Clip space is wgpu's: x right, y up, depth 0..1.
///
/// ```
/// use translume::{Camera, LookAt};
///
/// // From matrices of your own …
/// let identity = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
/// let mine = Camera { view_projection: identity, eye: [0.0, 0.0, 1.0] };
/// // … or in words.
/// let words = Camera::from(LookAt {
///     eye: [0.0, 1.6, 3.0],
///     target: [0.0, 1.0, 0.0],
///     up: [0.0, 1.0, 0.0],
///     horizontal_fov: 0.8,
///     aspect: 16.0 / 9.0,
///     near: 0.1,
///     far: 100.0,
/// });
/// assert_eq!(words.eye, [0.0, 1.6, 3.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// World space to clip space, column-major.
    pub view_projection: [[f32; 4]; 4],
    /// The eye's position.
    pub eye: [f32; 3],
}

impl Camera {
    /// Millimetres to clip space, and the eye in millimetres.
    pub(crate) fn in_mm(&self, mm_per_unit: f32) -> ([[f32; 4]; 4], [f32; 3]) {
        let to_world = Mat4::from_scale(Vec3::splat(1.0 / mm_per_unit));
        let view_projection = Mat4::from_cols_array_2d(&self.view_projection) * to_world;
        (view_projection.to_cols_array_2d(), self.eye.map(|x| x * mm_per_unit))
    }
}

/// A camera in words.
///
/// ```
/// use translume::{Camera, LookAt};
///
/// let look = LookAt {
///     eye: [0.0, 0.0, 2.0],
///     target: [0.0; 3],
///     up: [0.0, 1.0, 0.0],
///     horizontal_fov: 1.0,
///     aspect: 1.0,
///     near: 0.1,
///     far: 10.0,
/// };
/// let camera: Camera = look.into();
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookAt {
    /// The eye's position.
    pub eye: [f32; 3],
    /// A point in the middle of the picture.
    pub target: [f32; 3],
    /// Which way is up; not parallel to the line of sight.
    pub up: [f32; 3],
    /// Full horizontal field of view, radians.
    pub horizontal_fov: f32,
    /// Width of the picture over its height.
    pub aspect: f32,
    /// Distance to the near plane.
    pub near: f32,
    /// Distance to the far plane.
    pub far: f32,
}

impl From<LookAt> for Camera {
    fn from(words: LookAt) -> Self {
        let view = view::look_at_mat4(words.eye.into(), words.target.into(), Vec3::from(words.up));
        let vertical = 2.0 * ((0.5 * words.horizontal_fov).tan() / words.aspect).atan();
        let projection = proj::directx::perspective(vertical, words.aspect, words.near, words.far);
        Self { view_projection: (projection * view).to_cols_array_2d(), eye: words.eye }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_field_of_view_is_horizontal() {
        let camera = Camera::from(LookAt {
            eye: [0.0, 0.0, 10.0],
            target: [0.0; 3],
            up: [0.0, 1.0, 0.0],
            horizontal_fov: std::f32::consts::FRAC_PI_2,
            aspect: 2.0,
            near: 0.1,
            far: 100.0,
        });
        let ndc = Mat4::from_cols_array_2d(&camera.view_projection).project_point3(Vec3::new(10.0, 5.0, 0.0));
        assert!((ndc.x - 1.0).abs() < 1e-5 && (ndc.y - 1.0).abs() < 1e-5, "{ndc}");
    }
}
