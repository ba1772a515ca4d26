//! The solid angle of a rectangle, sampled evenly.

use std::f64::consts::TAU;

/// The solid angle of a rectangle from one place, prepared to be sampled evenly.
///
/// Source: Ureña, Fajardo and King 2013, "An area-preserving parametrization for spherical rectangles"; the names are
/// theirs.
pub(super) struct Seen {
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
    /// A rectangle by its middle and half extents along its own axes, at the given distance from its plane.
    pub fn new(center: [f64; 2], half: [f64; 2], distance: f64) -> Self {
        let [x, y] = [0, 1].map(|k| [center[k] - half[k], center[k] + half[k]]);
        let z0 = -distance.abs();
        // Components along z of the normals of the planes through the edges; their x or y follows from unit length.
        let tilt = |c: f64| c / c.hypot(z0);
        let n = [-tilt(y[0]), tilt(x[1]), tilt(y[1]), -tilt(x[0])];
        let angle = |i: usize, j: usize| (-n[i] * n[j]).clamp(-1.0, 1.0).acos();
        let (g0, g1, g2, g3) = (angle(0, 1), angle(1, 2), angle(2, 3), angle(3, 0));
        let k = TAU - g2 - g3;
        Self { x, y, half, center, z0, b0: n[0], b1: n[2], k, solid_angle: g0 + g1 - k }
    }

    /// The point of the rectangle, −1..=1 along each axis, that belongs to a point of the unit square.
    pub fn point(&self, [u, v]: [f64; 2]) -> [f64; 2] {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::assert_rel;

    /// Equal parts of the unit square are equal parts of the solid angle.
    #[test]
    fn sampling_is_even_in_solid_angle() {
        for (center, half) in
            [([0.3, 1.0, -0.2], [1.0, 0.7]), ([2.0, 0.01, 0.0], [1.9, 1.0]), ([9.0, 3.0, 4.0], [0.2; 2])]
        {
            let seen = Seen::new([center[0], center[2]], half, center[1]);
            // Solid angle of a rectangle seen from a point: Khadjavi 1968, by its four corners.
            let solid_angle = |low: [f64; 2], high: [f64; 2]| {
                let corner = |[x, y]: [f64; 2]| {
                    let (x, y) = (center[0] + half[0] * x, center[2] + half[1] * y);
                    (x * y / (center[1] * x.hypot(y).hypot(center[1]))).atan()
                };
                corner(high) - corner([low[0], high[1]]) - corner([high[0], low[1]]) + corner(low)
            };
            let whole = solid_angle([-1.0; 2], [1.0; 2]);
            assert_rel(seen.solid_angle, whole.abs(), 1e-9, "solid angle");
            for share in [0.1, 0.5, 0.8] {
                let [x, _] = seen.point([share, 0.3]);
                let left = solid_angle([-1.0, -1.0], [x, 1.0]) / whole;
                assert!((left - share).abs() < 1e-9, "{left} of {share}");
                let [left, y] = seen.point([share, 0.4]);
                let [right, _] = seen.point([share + 1e-4, 0.4]);
                let lower = solid_angle([left, -1.0], [right, y]) / solid_angle([left, -1.0], [right, 1.0]);
                // A column of finite width: measured 1.5e-5.
                assert!((lower - 0.4).abs() < 1e-4, "{lower}");
                let other =
                    solid_angle([left, -1.0], [right, y + 0.01]) / solid_angle([left, -1.0], [right, 1.0]);
                assert!((other - 0.4).abs() > 1e-4);
            }
        }
    }
}
