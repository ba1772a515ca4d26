//! The surface that a mesh is laid on.

use std::f64::consts::PI;

use glam::DVec3;

/// Steps of the integrals over the height, by the trapezoidal rule: 1e-4 of the result.
const STEPS: u32 = 128;

/// An upright egg about the origin: (x² + z²) / (radius · e^(−taper · y / half))² + (y / half)² = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ovoid {
    /// Radius at half the height.
    pub radius: f64,
    /// Half the height.
    pub half: f64,
    /// How much slimmer the upper half is.
    pub taper: f64,
}

impl Ovoid {
    /// Where a direction of the unit sphere goes.
    pub fn point(&self, direction: DVec3) -> DVec3 {
        let slim = self.slim(direction.y);
        DVec3::new(slim * direction.x, self.half * direction.y, slim * direction.z)
    }

    /// Undoes [`point`](Self::point); a point off the egg counts as one on it nearby.
    pub fn direction(&self, point: DVec3) -> DVec3 {
        let y = point.y / self.half;
        let slim = self.slim(y);
        DVec3::new(point.x / slim, y, point.z / slim).normalize_or_zero()
    }

    /// How fast the `point` of a `direction` moves when the direction moves along `t`.
    pub fn tangent(&self, direction: DVec3, point: DVec3, t: DVec3) -> DVec3 {
        let (slim, narrowing) = (self.slim(direction.y), self.taper * t.y);
        DVec3::new(slim * t.x - narrowing * point.x, self.half * t.y, slim * t.z - narrowing * point.z)
    }

    /// An outward normal of some length at a point of the egg.
    pub fn normal(&self, point: DVec3) -> DVec3 {
        let y = point.y / self.half;
        let widening = self.slim(y).powi(-2);
        let across = widening * (point.x * point.x + point.z * point.z);
        DVec3::new(widening * point.x, (self.taper * across + y) / self.half, widening * point.z)
    }

    fn slim(&self, y: f64) -> f64 {
        self.radius * (-self.taper * y).exp()
    }

    pub fn area(&self) -> f64 {
        self.integral(|upper, lower| PI * (upper.x + lower.x) * upper.distance(lower))
    }

    pub fn volume(&self) -> f64 {
        self.integral(|upper, lower| PI / 2.0 * (upper.x.powi(2) + lower.x.powi(2)) * (upper.y - lower.y))
    }

    /// Sums over bands between neighbouring points of a meridian.
    fn integral(&self, band: impl Fn(DVec3, DVec3) -> f64) -> f64 {
        let meridian = |step: u32| {
            let (x, y) = (PI * f64::from(step) / f64::from(STEPS)).sin_cos();
            self.point(DVec3::new(x, y, 0.0))
        };
        (0..STEPS).map(|step| band(meridian(step), meridian(step + 1))).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EGG: Ovoid = Ovoid { radius: 2.0, half: 3.0, taper: 0.3 };

    #[test]
    fn sizes_are_those_of_a_ball() {
        let ball = Ovoid { radius: 2.0, half: 2.0, taper: 0.0 };
        let errors =
            |ovoid: Ovoid| [ovoid.area() / (16.0 * PI) - 1.0, ovoid.volume() / (32.0 / 3.0 * PI) - 1.0];
        // Steps of π / 128, squared.
        assert!(errors(ball).iter().all(|error| error.abs() < 6e-4), "{:?}", errors(ball));
        assert!(errors(EGG).iter().all(|error| error.abs() > 0.1), "{:?}: another egg", errors(EGG));
    }

    #[test]
    fn points_tangents_and_normals_fit_together() {
        for direction in [DVec3::new(0.3, -0.8, 0.2), DVec3::new(-0.5, 0.4, 0.6), DVec3::Y] {
            let direction = direction.normalize();
            let point = EGG.point(direction);
            assert!(EGG.direction(point).distance(direction) < 1e-14);
            let (along, across) = direction.any_orthonormal_pair();
            for t in [along, across] {
                let tangent = EGG.tangent(direction, point, t);
                let difference = (EGG.point((direction + 1e-6 * t).normalize()) - point) / 1e-6;
                // One-sided difference: step times curvature.
                assert!(tangent.distance(difference) < 1e-5, "{tangent} {difference}");
                assert!(tangent.dot(EGG.normal(point)).abs() < 1e-12);
            }
        }
    }
}
