//! Lights with an area, and the points on them that stand for it.

use crate::{AmbientLight, ShadowOptions};
use glam::{Mat3, Vec3, Vec4};

/// A rectangle that shines from one side, as a window or a softbox does.
///
/// ```
/// use translume::{Light, RectangleLight};
///
/// // A window of 2 by 3 units in the plane x = −4, shining towards +x.
/// let window = RectangleLight {
///     center: [-4.0, 1.5, 0.0],
///     half_right: [0.0, 0.0, -1.0],
///     half_up: [0.0, 1.5, 0.0],
///     radiance: [8.0, 9.0, 10.0],
///     ..Default::default()
/// };
/// let light = Light::Rectangle(window);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RectangleLight {
    /// Its middle, world units.
    pub center: [f32; 3],
    /// From the middle to the middle of its right edge, world units; any length but zero.
    pub half_right: [f32; 3],
    /// From the middle to the middle of its upper edge, at a right angle to `half_right`. It shines to where `half_right` × `half_up`
    /// points: to whoever sees its right on their right.
    pub half_up: [f32; 3],
    /// Radiance, RGB, the same in every direction.
    pub radiance: [f32; 3],
    /// Whether the body shadows itself.
    pub shadow: bool,
}

/// A ball that shines in every direction, as a bulb does. Surfaces inside it get nothing.
///
/// ```
/// use translume::{Light, SphereLight};
///
/// let bulb = Light::Sphere(SphereLight { center: [0.0, 2.0, 0.0], radius: 0.05, radiance: [400.0; 3], ..Default::default() });
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereLight {
    /// Its middle, world units.
    pub center: [f32; 3],
    /// Its radius, world units; above 0.
    pub radius: f32,
    /// Radiance, RGB, the same in every direction.
    pub radiance: [f32; 3],
    /// Whether the body shadows itself.
    pub shadow: bool,
}

impl Default for RectangleLight {
    /// Two units wide and high at the origin, shining towards +z with radiance 1.
    fn default() -> Self {
        Self {
            center: [0.0; 3],
            half_right: [1.0, 0.0, 0.0],
            half_up: [0.0, 1.0, 0.0],
            radiance: [1.0; 3],
            shadow: true,
        }
    }
}

impl Default for SphereLight {
    /// Radius 1 at the origin, radiance 1.
    fn default() -> Self {
        Self { center: [0.0; 3], radius: 1.0, radiance: [1.0; 3], shadow: true }
    }
}

impl AmbientLight {
    /// Whether it is shadowed along directions of its own rather than along those of the whole sky: where these are more.
    pub(crate) fn is_shadowed_by_points(&self, options: &ShadowOptions) -> bool {
        let share = 0.5 * (1.0 - self.half_angle.min(std::f32::consts::PI).cos());
        self.shadow && options.directions as f32 * share < options.area_points as f32
    }

    /// `count` unit vectors that share its solid angle, and the share of each, sr.
    pub(crate) fn emitters(&self, count: u32) -> Vec<Vec4> {
        let lowest = self.half_angle.cos();
        let solid_angle = std::f32::consts::TAU * (1.0 - lowest) / count as f32;
        cap(self.axis.into(), lowest, count).map(|direction| direction.extend(solid_angle)).collect()
    }
}

/// `count` unit vectors evenly spread over the cap around an axis down to this cosine.
fn cap(axis: Vec3, lowest: f32, count: u32) -> impl Iterator<Item = Vec3> {
    let axis = axis.normalize_or(Vec3::Y);
    let right = axis.any_orthonormal_vector();
    let turn = Mat3::from_cols(right, axis.cross(right), axis);
    (0..count).map(move |k| {
        let [u, v] = lattice(k, count);
        let height = 1.0 - u * (1.0 - lowest);
        let (sine, cosine) = (v * std::f32::consts::TAU).sin_cos();
        let ring = (1.0 - height * height).max(0.0).sqrt();
        turn * Vec3::new(ring * cosine, ring * sine, height)
    })
}

/// Point `k` of a lattice of `count` that spreads evenly over the unit square: no two share a row or a column, so that a straight edge
/// sweeps over them one by one. Source: the Fibonacci lattice, with the golden section for any count.
fn lattice(k: u32, count: u32) -> [f32; 2] {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let u = (f64::from(k) + 0.5) / f64::from(count);
    let v = (f64::from(k) * GOLDEN + 0.5).fract();
    [u as f32, v as f32]
}

impl RectangleLight {
    /// `count` points and the share of its area that each stands for; `scale` per world unit.
    pub(crate) fn emitters(&self, scale: f32, count: u32) -> Vec<Vec4> {
        let [center, right, up] = [self.center, self.half_right, self.half_up].map(|v| Vec3::from(v) * scale);
        let area = 4.0 * right.cross(up).length() / count as f32;
        let point = |k| {
            let [u, v] = lattice(k, count);
            (center + right * (2.0 * u - 1.0) + up * (2.0 * v - 1.0)).extend(area)
        };
        (0..count).map(point).collect()
    }
}

impl SphereLight {
    /// `count` points on the part of it that a body inside the ball of `reach` around `middle` can see, and the share of that part's area
    /// that each stands for; `scale` per world unit.
    pub(crate) fn emitters(&self, scale: f32, count: u32, middle: Vec3, reach: f32) -> Vec<Vec4> {
        let (center, radius) = (Vec3::from(self.center) * scale, self.radius * scale);
        let to_body = middle - center;
        // A point of the sphere sees what lies above its tangent plane.
        let lowest = ((radius - reach) / to_body.length().max(f32::MIN_POSITIVE)).clamp(-1.0, 1.0);
        let area = std::f32::consts::TAU * radius * radius * (1.0 - lowest) / count as f32;
        cap(to_body, lowest, count).map(|outwards| (center + outwards * radius).extend(area)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_share_a_rectangle() {
        let light = RectangleLight {
            center: [1.0, 2.0, 3.0],
            half_right: [0.0, 0.0, 4.0],
            half_up: [0.0, 2.0, 0.0],
            ..Default::default()
        };
        for count in [1, 5, 16, 64] {
            let points = light.emitters(10.0, count);
            let mean = points.iter().sum::<Vec4>() / count as f32;
            assert!((mean.w * count as f32 - 80.0 * 40.0).abs() < 0.1, "areas add up: {mean}");
            // A lattice of n points misses the middle by less than a cell's height; measured .31 of a half height for 1, .03 for 16.
            assert!((mean.z - 30.0).abs() < 1e-3 && (mean.y - 20.0).abs() < 20.0 / count as f32, "{mean}");
            assert!(
                points.iter().all(|p| p.x == 10.0 && (p.y - 20.0).abs() < 20.0 && (p.z - 30.0).abs() < 40.0)
            );
        }
    }

    #[test]
    fn points_of_a_sphere_are_those_a_body_can_see() {
        let light = SphereLight { center: [0.0, 10.0, 0.0], radius: 1.0, ..Default::default() };
        let lowest = |reach| {
            let points = light.emitters(1.0, 64, Vec3::ZERO, reach);
            points.iter().map(|p| 10.0 - p.y).fold(f32::INFINITY, f32::min)
        };
        // A point body sees heights above radius²/distance, 0.1; a body of radius 5 everything above (1 − 5)/10; one around the sphere all.
        assert!((0.1..0.12).contains(&lowest(0.0)), "{}", lowest(0.0));
        assert!((-0.4..-0.37).contains(&lowest(5.0)), "{}", lowest(5.0));
        assert!((-1.0..-0.95).contains(&lowest(20.0)), "{}", lowest(20.0));
    }
}
