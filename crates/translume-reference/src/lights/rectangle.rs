//! A rectangle of uniform radiance, shining to one side.

use std::f64::consts::TAU;

use glam::DVec3;

use super::polygon::polygon_transmittance;
use super::{Emitter, Ray, Receiver};
use crate::rgb::scale;

/// Half diagonal over distance below which the solid angle cancels to less than ten digits. There the rectangle is
/// sampled by area instead, and a rule of degree 3 errs by the fourth power of this.
const FAR: f64 = 1e-2;

/// A rectangle by its middle and two unit axes with the half extent along each.
pub(super) struct Rectangle {
    center: DVec3,
    axes: [DVec3; 2],
    half: [f64; 2],
    /// Where it shines to; zero if it has no area.
    normal: DVec3,
    radiance: [f64; 3],
    shadow: bool,
}

impl Rectangle {
    pub fn new(
        center: [f64; 3],
        half_right: [f64; 3],
        half_up: [f64; 3],
        radiance: [f64; 3],
        shadow: bool,
    ) -> Self {
        let halves = [half_right, half_up].map(DVec3::from);
        Self {
            center: center.into(),
            axes: halves.map(DVec3::normalize_or_zero),
            half: halves.map(DVec3::length),
            normal: halves[0].cross(halves[1]).normalize_or_zero(),
            radiance,
            shadow,
        }
    }

    /// Its point at −1..=1 of each half extent.
    fn point(&self, [x, y]: [f64; 2]) -> DVec3 {
        self.center + self.axes[0] * (self.half[0] * x) + self.axes[1] * (self.half[1] * y)
    }

    fn is_far(&self, from: DVec3) -> bool {
        self.half[0].hypot(self.half[1]) < FAR * from.distance(self.center)
    }

    /// A ray to a point, weighted as one of many that share the rectangle's area evenly.
    fn area_ray(&self, receiver: &Receiver<'_>, point: [f64; 2]) -> Ray {
        let ray = towards(receiver, self.point(point.map(|x| 2.0 * x - 1.0)));
        let area = 4.0 * self.half[0] * self.half[1];
        let solid_angle = area * -self.normal.dot(ray.direction) / (ray.distance * ray.distance);
        Ray { weight: ray.weight.map(|weight| weight * solid_angle), ..ray }
    }

    /// ∫ F_t cos dω over what is above the receiver's horizon, sr.
    fn open(&self, receiver: &Receiver<'_>) -> f64 {
        let from = receiver.at.position;
        if self.is_far(from) {
            let nodes = [0.5 - 0.5 / 3.0f64.sqrt(), 0.5 + 0.5 / 3.0f64.sqrt()];
            let each = nodes.iter().flat_map(|&x| nodes.map(|y| self.area_ray(receiver, [x, y]).weight[0]));
            return 0.25 * each.sum::<f64>();
        }
        let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]].map(|at| self.point(at) - from);
        polygon_transmittance(receiver.eta, receiver.at.normal, &corners)
    }

    fn visible(&self, receiver: &Receiver<'_>) -> f64 {
        let points = receiver.strata.points();
        if self.is_far(receiver.at.position) {
            return receiver.visible(points.map(|point| self.area_ray(receiver, point)))[0];
        }
        let seen = Seen::new(self, receiver.at.position);
        receiver.visible(points.map(|point| towards(receiver, self.point(seen.point(point)))))[0]
    }
}

impl Emitter for Rectangle {
    fn entering(&self, receiver: &Receiver<'_>) -> [f64; 3] {
        if self.normal.dot(receiver.at.position - self.center) <= 0.0 {
            return [0.0; 3];
        }
        let open = self.open(receiver);
        let visible = if self.shadow && open > 0.0 { self.visible(receiver) } else { 1.0 };
        scale(self.radiance, open * visible)
    }
}

fn towards(receiver: &Receiver<'_>, point: DVec3) -> Ray {
    let offset = point - receiver.at.position;
    let distance = offset.length();
    let direction = offset / distance;
    Ray { direction, distance, weight: [receiver.share(direction); 3] }
}

/// The solid angle of a rectangle from one place, prepared to be sampled evenly.
///
/// Source: Ureña, Fajardo and King 2013, "An area-preserving parametrization for spherical rectangles"; the names are
/// theirs.
struct Seen {
    x: [f64; 2],
    y: [f64; 2],
    half: [f64; 2],
    center: [f64; 2],
    z0: f64,
    b0: f64,
    b1: f64,
    k: f64,
    solid_angle: f64,
}

impl Seen {
    fn new(rectangle: &Rectangle, from: DVec3) -> Self {
        let offset = rectangle.center - from;
        let center = rectangle.axes.map(|axis| offset.dot(axis));
        let [x, y] = [0, 1].map(|k| [center[k] - rectangle.half[k], center[k] + rectangle.half[k]]);
        let z0 = -offset.dot(rectangle.normal).abs();
        // Components along z of the normals of the planes through the edges; their x or y follows from unit length.
        let tilt = |c: f64| c / c.hypot(z0);
        let n = [-tilt(y[0]), tilt(x[1]), tilt(y[1]), -tilt(x[0])];
        let angle = |i: usize, j: usize| (-n[i] * n[j]).clamp(-1.0, 1.0).acos();
        let (g0, g1, g2, g3) = (angle(0, 1), angle(1, 2), angle(2, 3), angle(3, 0));
        let k = TAU - g2 - g3;
        Self { x, y, half: rectangle.half, center, z0, b0: n[0], b1: n[2], k, solid_angle: g0 + g1 - k }
    }

    /// The point of the rectangle, −1..=1 along each axis, that belongs to a point of the unit square.
    fn point(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let angle = u * self.solid_angle + self.k;
        let f = (angle.cos() * self.b0 - self.b1) / angle.sin();
        let cos = f.signum() / f.hypot(self.b0);
        let x = -cos * self.z0 / (1.0 - cos * cos).max(f64::MIN_POSITIVE).sqrt();
        let x = x.clamp(self.x[0], self.x[1]);
        let d = x.hypot(self.z0);
        let [h0, h1] = self.y.map(|y| y / d.hypot(y));
        let h = h0 + v * (h1 - h0);
        let y = (h * d / (1.0 - h * h).max(f64::MIN_POSITIVE).sqrt()).clamp(self.y[0], self.y[1]);
        [(x - self.center[0]) / self.half[0], (y - self.center[1]) / self.half[1]]
    }
}
