//! Framing: where camera and lamps stand around what is to be seen.

use crate::scene::{SceneCamera, SceneLight};
use glam::{Mat4, Vec3};
use translume::{Camera, LookAt};

/// Everything that will be seen, at any moment.
pub struct Subject {
    points: Vec<Vec3>,
    pub middle: Vec3,
    /// Of a sphere around the bounding box.
    pub radius: f32,
}

impl Subject {
    pub fn new(points: Vec<Vec3>) -> Self {
        let mut subject = Self { points, middle: Vec3::ZERO, radius: 0.0 };
        let (low, high) = subject.bounds();
        let (low, high) = (Vec3::from(low), Vec3::from(high));
        (subject.middle, subject.radius) = (0.5 * (low + high), 0.5 * low.distance(high));
        subject
    }

    /// Corners of a box around it.
    pub fn bounds(&self) -> ([f32; 3], [f32; 3]) {
        let around = |(low, high): (Vec3, Vec3), p: &Vec3| (low.min(*p), high.max(*p));
        let (low, high) = self.points.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), around);
        (low.to_array(), high.to_array())
    }

    /// A camera that has all of it in its square picture, from `view` degrees to the right of the front and upwards.
    pub fn camera(&self, size: u32, view: [f32; 2]) -> SceneCamera {
        const FOV_DEG: f32 = 26.0;
        const FILLED: f32 = 0.86;
        let tangent = FILLED * (0.5 * FOV_DEG.to_radians()).tan();
        let [right, up, back] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| turned(view, axis));
        let distance = self.points.iter().fold(0.0, |distance: f32, point| {
            let offset = *point - self.middle;
            distance.max(offset.dot(right).abs().max(offset.dot(up).abs()) / tangent + offset.dot(back))
        });
        SceneCamera {
            eye: (self.middle + back * distance).to_array(),
            target: self.middle.to_array(),
            up: up.to_array(),
            fov_deg: FOV_DEG,
            width: size,
            height: size,
        }
    }

    /// Seen from the camera: a lamp behind that shines through what is thin, a key from the upper right, and a little sky.
    pub fn lamps(&self, view: [f32; 2]) -> Vec<SceneLight> {
        let lamp = turned([view[0], 0.0], Vec3::new(-0.75, 1.1, -1.5)) * self.radius * 1.5;
        vec![
            SceneLight::Point {
                position: (self.middle + lamp).to_array(),
                intensity: [7.5, 6.9, 6.0].map(|c| c * lamp.length_squared()),
                shadow: true,
                lit_region: None,
            },
            SceneLight::Directional {
                to_light: turned([view[0], 0.0], Vec3::new(0.9, 0.9, 0.75)).to_array(),
                irradiance: [1.5, 1.6, 1.75],
                shadow: true,
                lit_region: None,
            },
            SceneLight::ConstantEnv { radiance: [0.08, 0.09, 0.11], shadow: false },
        ]
    }

    /// A camera with a depth range around the subject, and some room.
    pub fn look(&self, camera: &SceneCamera) -> Camera {
        let distance = self.middle.distance(camera.eye.into());
        LookAt {
            eye: camera.eye,
            target: camera.target,
            up: camera.up,
            horizontal_fov: camera.fov_deg.to_radians(),
            aspect: camera.width as f32 / camera.height as f32,
            near: (distance - 2.0 * self.radius).max(0.01 * self.radius),
            far: distance + 2.0 * self.radius,
        }
        .into()
    }
}

/// From the object towards a camera at these degrees, and the frame around that direction turned with it.
fn turned(view: [f32; 2], v: Vec3) -> Vec3 {
    let [yaw, pitch] = view.map(f32::to_radians);
    Mat4::from_rotation_y(yaw).transform_vector3(Mat4::from_rotation_x(-pitch).transform_vector3(v))
}
