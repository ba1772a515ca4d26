//! The camera as light meets it: which pixel sees a point, and how much of its square the point's surroundings fill.

use glam::DVec3;

use super::Fan;
use crate::composite::Camera;

/// A camera made ready.
pub(super) struct Film {
    pub eye: DVec3,
    /// Of ways through the eye.
    pub fan: Option<Fan>,
    /// Unit vectors.
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    /// Pixels per unit of the tangent of the angle from the axis.
    scale: f64,
    /// In pixels.
    size: [usize; 2],
}

/// How the camera sees a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    pub pixel: usize,
    /// Unit vector towards the eye.
    pub direction: DVec3,
    /// To the eye, mm.
    pub distance: f64,
    /// Squares of pixels per volume of the surroundings, for each mm along the way of sight: 1/mm².
    pub density: f64,
}

impl Film {
    pub fn new(camera: &Camera, fan: Option<Fan>) -> Self {
        let [eye, target, up] = [camera.eye, camera.target, camera.up].map(DVec3::from);
        let forward = (target - eye).normalize_or_zero();
        let right = forward.cross(up).normalize_or_zero();
        let scale = 0.5 * camera.width as f64 / (0.5 * camera.fov).tan();
        let (up, size) = (right.cross(forward), [camera.width, camera.height]);
        Self { eye, fan, forward, right, up, scale, size }
    }

    /// `None` for what is beside the picture or behind the eye.
    pub fn view(&self, point: DVec3) -> Option<View> {
        let offset = point - self.eye;
        let depth = offset.dot(self.forward);
        if depth <= 0.0 {
            return None;
        }
        let [width, height] = self.size.map(|size| size as f64);
        let across = 0.5 * width + self.scale * offset.dot(self.right) / depth;
        let down = 0.5 * height - self.scale * offset.dot(self.up) / depth;
        let is_inside = (0.0..width).contains(&across) && (0.0..height).contains(&down);
        if !is_inside {
            return None;
        }
        let distance = offset.length();
        // A pixel's solid angle is cos³ / scale²; a volume at a distance s holds s² ds for each steradian.
        let cos = depth / distance;
        Some(View {
            pixel: down as usize * self.size[0] + across as usize,
            direction: -offset / distance,
            distance,
            density: self.scale * self.scale / (cos.powi(3) * distance * distance),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        let (eye, target) = ([3.0, -2.0, 40.0], [1.0, 2.0, 0.0]);
        Camera { eye, target, up: [0.1, 1.0, 0.0], fov: 0.9, width: 7, height: 5 }
    }

    /// A pixel sees what lies on its ways of sight, and no other does.
    #[test]
    fn points_fall_into_the_pixels_that_see_them() {
        let (camera, film) = (camera(), Film::new(&camera(), None));
        for pixel in 0..35 {
            let (column, row) = (pixel % 7, pixel / 7);
            for [x, y] in [[0.01, 0.01], [0.99, 0.5], [0.5, 0.99]] {
                let direction = DVec3::from(camera.direction_at(column as f64 + x, row as f64 + y));
                let view = film.view(DVec3::from(camera.eye) + direction * 12.0).unwrap();
                assert_eq!(view.pixel, pixel);
                assert!((view.direction + direction.normalize()).length() < 1e-14);
                assert!((view.distance - 12.0 * direction.length()).abs() < 1e-12);
            }
        }
        let beside = [[-0.01, 2.0], [7.01, 2.0], [3.0, -0.01], [3.0, 5.01]];
        for [x, y] in beside {
            let direction = DVec3::from(camera.direction_at(x, y));
            assert_eq!(film.view(DVec3::from(camera.eye) + direction), None);
        }
        assert_eq!(film.view(DVec3::from(camera.eye) - DVec3::from(camera.direction_at(3.0, 2.0))), None);
    }

    /// The density is how fast the place in the picture changes with the point, by differences.
    #[test]
    fn density_is_the_magnification() {
        let (camera, film) = (camera(), Film::new(&camera(), None));
        for (x, y) in [(3.5, 2.5), (0.2, 0.3), (6.9, 4.1)] {
            let along = DVec3::from(camera.direction_at(x, y));
            let step = 1e-4;
            let moved = |dx: f64, dy: f64| DVec3::from(camera.direction_at(x + dx, y + dy)).normalize();
            let here = along.normalize();
            // Area, at the point's distance, of a square of `step` pixels.
            let s = 12.0;
            let area = ((moved(step, 0.0) - here) * s).cross((moved(0.0, step) - here) * s).length();
            let density = film.view(DVec3::from(camera.eye) + here * s).unwrap().density;
            // Differences are off by the step times the curvature.
            assert!((density * area / (step * step) - 1.0).abs() < 1e-3, "{density}");
        }
    }
}
