//! How much the triangles about a vertex are distorted by where it lies.
//!
//! Per triangle, with the singular values σ of its map: ½(σ₁/σ₂ + σ₂/σ₁) · (½(τ + 1/τ))² · area, where τ is its area over
//! the one it shall have (Degener, Meseth, Klein 2003, "An adaptable surface parameterization method").

use glam::{DVec2, DVec3};

/// A triangle (v, b, c) about a vertex v.
pub struct Corner {
    pub b: DVec3,
    pub c: DVec3,
    /// Cotangents of the angles at v, b and c that it shall have.
    pub cot: [f64; 3],
    /// The area that it shall have.
    pub area: f64,
}

/// Doubled area of a triangle, and the cotangents of its angles, from its squared sides (Heron).
pub fn shape([a, b, c]: [f64; 3]) -> (f64, [f64; 3]) {
    let doubled = 0.5 * (2.0 * (a * b + b * c + c * a) - (a * a + b * b + c * c)).max(0.0).sqrt();
    (doubled, [b + c - a, c + a - b, a + b - c].map(|opposite| opposite / (2.0 * doubled)))
}

/// The sum over the triangles about a vertex at `v`; infinite if one is turned over.
pub fn distortion(corners: &[Corner], v: DVec3) -> f64 {
    let mut energy = 0.0;
    for corner in corners {
        let laid = corner.laid(v);
        if laid <= 0.0 {
            return f64::INFINITY;
        }
        energy += corner.area * corner.dirichlet(v) * corner.unevenness(laid).powi(2) / laid;
    }
    energy
}

/// [`distortion`] while its vertex moves by x along one vector and y along another.
#[derive(Default)]
pub struct Expansion {
    slope: DVec2,
    /// Second derivatives by xx, xy and yy, with the surface taken as flat.
    curvature: [f64; 3],
}

impl Expansion {
    /// About a vertex at `v` without a triangle that is turned over.
    pub fn new(corners: &[Corner], v: DVec3, axes: [DVec3; 2]) -> Self {
        let mut sum = Self::default();
        corners.iter().for_each(|corner| sum.add(corner, v, axes));
        sum
    }

    /// The product rule for dirichlet · scale(laid), where laid is taken as linear and scale = unevenness² / laid.
    fn add(&mut self, corner: &Corner, v: DVec3, axes: [DVec3; 2]) {
        let Corner { b, c, cot, area } = *corner;
        let by_axes = |gradient: DVec3| DVec2::from(axes.map(|axis| gradient.dot(axis)));
        let (laid, dirichlet, unevenness) = {
            let laid = corner.laid(v);
            (laid, corner.dirichlet(v), corner.unevenness(laid))
        };
        let dirichlet_slope = by_axes(0.5 * (cot[1] * (v - c) + cot[2] * (v - b)));
        let laid_slope = by_axes(b.cross(c) / Corner::depth(v, b, c));
        let unevenness_slope = 0.5 * (1.0 / area - area / (laid * laid));
        let unevenness_bend = area / (laid * laid * laid);
        let scale = unevenness * unevenness / laid;
        let scale_slope = (2.0 * unevenness * unevenness_slope - scale) / laid;
        let scale_bend = 2.0 * (unevenness_slope.powi(2) + unevenness * unevenness_bend - scale_slope) / laid;

        self.slope += area * (scale * dirichlet_slope + dirichlet * scale_slope * laid_slope);
        let stiffness = area * 0.5 * (cot[1] + cot[2]) * scale;
        let mixed = area * scale_slope;
        let pure = area * dirichlet * scale_bend;
        for (curvature, (i, j)) in self.curvature.iter_mut().zip([(0, 0), (0, 1), (1, 1)]) {
            *curvature += stiffness * axes[i].dot(axes[j])
                + mixed * (dirichlet_slope[i] * laid_slope[j] + dirichlet_slope[j] * laid_slope[i])
                + pure * laid_slope[i] * laid_slope[j];
        }
    }

    /// A step downhill no longer than `reach`: Newton's, where the curvature is positive definite.
    pub fn step(&self, reach: f64) -> DVec2 {
        let Self { slope, curvature: [xx, xy, yy] } = self;
        let determinant = xx * yy - xy * xy;
        if *xx > 0.0 && determinant > 1e-6 * xx * yy {
            let newton = DVec2::new(xy * slope.y - yy * slope.x, xy * slope.x - xx * slope.y) / determinant;
            newton.clamp_length_max(reach)
        } else {
            -slope.normalize_or_zero() * reach
        }
    }
}

impl Corner {
    /// Its area as seen from the middle: it vanishes before the triangle turns over.
    fn laid(&self, v: DVec3) -> f64 {
        v.dot(self.b.cross(self.c)) / Self::depth(v, self.b, self.c)
    }

    /// Twice the distance of its centre from the middle.
    fn depth(v: DVec3, b: DVec3, c: DVec3) -> f64 {
        2.0 * (v + b + c).length() / 3.0
    }

    /// The Dirichlet energy of its map: ½(σ₁² + σ₂²) · area = ½(σ₁/σ₂ + σ₂/σ₁) · laid.
    fn dirichlet(&self, v: DVec3) -> f64 {
        let sides = [self.b.distance_squared(self.c), v.distance_squared(self.c), v.distance_squared(self.b)];
        0.25 * sides.iter().zip(self.cot).map(|(side, cot)| side * cot).sum::<f64>()
    }

    /// ½(τ + 1/τ)
    fn unevenness(&self, laid: f64) -> f64 {
        0.5 * (laid / self.area + self.area / laid)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fan about (0.02, −0.01, 1) whose triangles shall be right-angled.
    fn fan() -> (Vec<Corner>, DVec3) {
        let rim = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / 5.0;
            DVec3::new(0.1 * angle.cos(), 0.13 * angle.sin(), 1.0)
        };
        let corner = |k| Corner { b: rim(k), c: rim(k + 1), cot: shape([2.0, 1.0, 1.0]).1, area: 0.007 };
        ((0..5).map(corner).collect(), DVec3::new(0.02, -0.01, 1.0))
    }

    /// Largest relative difference between slope and curvature and their finite differences.
    fn error(expansion: &Expansion, corners: &[Corner], v: DVec3) -> f64 {
        let h = 1e-5;
        let energy = |x: f64, y: f64| distortion(corners, v + h * DVec3::new(x, y, 0.0));
        let slope = DVec2::new(energy(1.0, 0.0) - energy(-1.0, 0.0), energy(0.0, 1.0) - energy(0.0, -1.0));
        let middle = 2.0 * energy(0.0, 0.0);
        let bend = [
            energy(1.0, 0.0) + energy(-1.0, 0.0) - middle,
            (energy(1.0, 1.0) + energy(-1.0, -1.0) - energy(1.0, -1.0) - energy(-1.0, 1.0)) / 4.0,
            energy(0.0, 1.0) + energy(0.0, -1.0) - middle,
        ];
        let largest = expansion.curvature.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let bent = (0..3).map(|k| (expansion.curvature[k] - bend[k] / (h * h)).abs() / largest);
        bent.fold((expansion.slope - slope / (2.0 * h)).length() / expansion.slope.length(), f64::max)
    }

    #[test]
    fn expansion_is_that_of_the_distortion() {
        let (corners, v) = fan();
        let expansion = Expansion::new(&corners, v, [DVec3::X, DVec3::Y]);
        // What bends the area, its depth, changes by 2 % within the fan.
        assert!(error(&expansion, &corners, v) < 0.02, "{}", error(&expansion, &corners, v));
        let elsewhere = Expansion::new(&corners, v + 0.01 * DVec3::X, [DVec3::X, DVec3::Y]);
        assert!(error(&elsewhere, &corners, v) > 0.1);
    }

    #[test]
    fn steps_go_downhill() {
        let (corners, v) = fan();
        let step = Expansion::new(&corners, v, [DVec3::X, DVec3::Y]).step(0.01);
        let moved = |by: f64| distortion(&corners, v + by * step.extend(0.0));
        assert!(step.length() <= 0.01 + 1e-9 && moved(1.0) < moved(0.0) && moved(-1.0) > moved(0.0));
    }

    #[test]
    fn a_triangle_turned_over_is_infinitely_distorted() {
        let (corners, v) = fan();
        assert!(distortion(&corners, v).is_finite());
        assert_eq!(distortion(&corners, v + 0.2 * DVec3::X), f64::INFINITY);
    }
}
