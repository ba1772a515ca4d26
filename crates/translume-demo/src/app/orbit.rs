//! A camera in the hand: turned around what it looks at, moved, brought nearer.

use crate::scene::SceneCamera;
use glam::{Mat3, Mat4, Vec2, Vec3};

/// Radians per point of the mouse's way.
const TURN: f32 = 0.008;
/// Closest to the poles, radians.
const POLE: f32 = 0.02;

/// A camera for a view of some shape, with the lens of a square one as long as its shorter side.
pub fn shaped(mut camera: SceneCamera, pixels: [u32; 2]) -> SceneCamera {
    let tangent = (0.5 * camera.fov_deg.to_radians()).tan() / longer(camera.width, camera.height);
    let [width, height] = pixels;
    (camera.width, camera.height) = (width, height);
    camera.fov_deg = 2.0 * (tangent * longer(width, height)).atan().to_degrees();
    camera
}

fn longer(width: u32, height: u32) -> f32 {
    (width as f32 / height as f32).max(1.0)
}

/// Around the target; `drag` in points.
pub fn turn(camera: &mut SceneCamera, drag: Vec2) {
    let (target, up) = (Vec3::from(camera.target), axis(camera));
    let offset = Vec3::from(camera.eye) - target;
    let pitch = up.dot(offset.normalize_or_zero()).clamp(-1.0, 1.0).acos();
    let turned = Mat3::from_axis_angle(up, -TURN * drag.x) * offset;
    let right = up.cross(turned).normalize_or(Vec3::X);
    let wanted = (pitch - TURN * drag.y).clamp(POLE, std::f32::consts::PI - POLE);
    let lifted = Mat3::from_axis_angle(right, wanted - pitch) * turned;
    (camera.eye, camera.up) = ((target + lifted).to_array(), up.to_array());
}

/// The upright axis of the scene that the camera's `up` is nearest to: a framed camera leans with its view.
fn axis(camera: &SceneCamera) -> Vec3 {
    let up = Vec3::from(camera.up);
    let axes = [Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z, Vec3::X, Vec3::NEG_X];
    axes.into_iter().fold(Vec3::Y, |best, axis| if axis.dot(up) > best.dot(up) + 1e-3 { axis } else { best })
}

/// Across the picture, so that the target follows the mouse; `drag` in heights of the view.
pub fn pan(camera: &mut SceneCamera, drag: Vec2) {
    let frame = Frame::of(camera);
    let height = 2.0 * frame.distance * frame.tangent.y;
    let step = (frame.up * drag.y - frame.right * drag.x) * height;
    camera.eye = (Vec3::from(camera.eye) + step).to_array();
    camera.target = (Vec3::from(camera.target) + step).to_array();
}

/// Nearer by a factor.
pub fn zoom(camera: &mut SceneCamera, factor: f32) {
    let target = Vec3::from(camera.target);
    let offset = Vec3::from(camera.eye) - target;
    camera.eye = (target + offset / factor).to_array();
}

/// Where a camera stands and what it spans.
pub struct Frame {
    pub eye: Vec3,
    pub forward: Vec3,
    pub right: Vec3,
    pub up: Vec3,
    /// To the target.
    pub distance: f32,
    /// Of half the angles across and down.
    pub tangent: Vec2,
}

impl Frame {
    pub fn of(camera: &SceneCamera) -> Self {
        let (eye, target) = (Vec3::from(camera.eye), Vec3::from(camera.target));
        let forward = (target - eye).normalize_or(Vec3::NEG_Z);
        let right = forward.cross(camera.up.into()).normalize_or(Vec3::X);
        let across = (0.5 * camera.fov_deg.to_radians()).tan();
        let down = across * camera.height as f32 / camera.width as f32;
        let distance = eye.distance(target);
        Self { eye, forward, right, up: right.cross(forward), distance, tangent: Vec2::new(across, down) }
    }

    /// Where a point is in the picture, 0..=1 across and down, and its depth; `None` behind the eye.
    pub fn project(&self, point: Vec3) -> Option<(Vec2, f32)> {
        let offset = point - self.eye;
        let depth = offset.dot(self.forward);
        (depth > 1e-6 * self.distance).then(|| {
            let place = Vec2::new(offset.dot(self.right), -offset.dot(self.up)) / (self.tangent * depth);
            (0.5 + 0.5 * place, depth)
        })
    }

    /// The point at a place of the picture and a depth.
    pub fn point(&self, place: Vec2, depth: f32) -> Vec3 {
        let [x, y] = ((2.0 * place - 1.0) * self.tangent * depth).to_array();
        self.eye + self.forward * depth + self.right * x - self.up * y
    }
}

/// A turn about the vertical through the target, radians.
pub fn carousel(camera: &mut SceneCamera, angle: f32) {
    let target = Vec3::from(camera.target);
    let turn = Mat4::from_axis_angle(axis(camera), angle);
    camera.eye = (target + turn.transform_vector3(Vec3::from(camera.eye) - target)).to_array();
    camera.up = turn.transform_vector3(camera.up.into()).to_array();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> SceneCamera {
        let (eye, target) = ([1.0, 2.0, 10.0], [0.5, 0.0, 1.0]);
        SceneCamera { eye, target, up: [0.0, 1.0, 0.0], fov_deg: 30.0, width: 300, height: 200 }
    }

    #[test]
    fn a_point_is_where_it_is_projected_to() {
        let frame = Frame::of(&camera());
        for point in [Vec3::new(0.3, 0.2, 0.1), Vec3::new(-1.0, 0.5, 2.0)] {
            let (place, depth) = frame.project(point).unwrap();
            // Rounding of positions of size 10.
            assert!(frame.point(place, depth).distance(point) < 1e-4);
        }
        assert!(frame.project(frame.eye - frame.forward).is_none());
        let (middle, depth) = frame.project(camera().target.into()).unwrap();
        assert!(middle.distance(Vec2::splat(0.5)) < 1e-5 && (depth - frame.distance).abs() < 1e-4);
    }

    #[test]
    fn turning_keeps_the_distance_and_stays_off_the_poles() {
        let mut camera = camera();
        let distance = Frame::of(&camera).distance;
        for k in 0..200 {
            turn(&mut camera, Vec2::new(13.0, if k % 100 < 50 { 40.0 } else { -40.0 }));
            let frame = Frame::of(&camera);
            assert!((frame.distance / distance - 1.0).abs() < 1e-3);
            assert!(frame.forward.y.abs() < 1.0 && frame.up.y > 0.0);
        }
    }

    #[test]
    fn the_target_follows_the_mouse() {
        let mut camera = camera();
        let target = Vec3::from(camera.target);
        pan(&mut camera, Vec2::new(0.1, -0.2));
        let (place, _) = Frame::of(&camera).project(target).unwrap();
        // A tenth of the height is a fifteenth of the width.
        assert!(place.distance(Vec2::new(0.5 + 0.1 / 1.5, 0.3)) < 1e-4, "{place}");
    }

    #[test]
    fn a_wider_view_shows_more_and_crops_nothing() {
        let square = SceneCamera { width: 100, height: 100, ..camera() };
        let wide = shaped(square, [200, 100]);
        assert!((Frame::of(&wide).tangent.y - Frame::of(&square).tangent.y).abs() < 1e-6);
        let tall = shaped(wide, [100, 300]);
        assert!((Frame::of(&tall).tangent.x - Frame::of(&square).tangent.x).abs() < 1e-6);
    }
}
