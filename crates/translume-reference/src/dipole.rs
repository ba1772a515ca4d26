//! The classical dipole of one colour channel: diffuse reflectance of a half-space lit at one point.

use std::f64::consts::PI;

use crate::fresnel::diffuse_reflectance_fit;

/// The radial profile R_d(r) and its integrals over discs, all in closed form.
///
/// Coefficients may be anything from 0 to 1e100 1/mm; a medium that does not scatter gives 0 everywhere.
///
/// Source: Jensen, Marschner, Levoy, Hanrahan 2001, "A Practical Model for Subsurface Light Transport", eq. 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dipole {
    /// Reduced albedo α' = σ_s'/σ_t', 0..=1.
    pub albedo: f64,
    /// Effective transport coefficient σ_tr = √(3 σ_a σ_t'), 1/mm.
    pub sigma_tr: f64,
    /// Depth of the real source z_r and height of the virtual source z_v, mm.
    pub z: [f64; 2],
}

impl Dipole {
    /// From σ_s' and σ_a in 1/mm and the index of refraction of the medium over that outside.
    #[must_use]
    pub fn new(sigma_s_prime: f64, sigma_a: f64, ior: f64) -> Self {
        if sigma_s_prime <= 0.0 {
            return Self { albedo: 0.0, sigma_tr: 0.0, z: [1.0; 2] };
        }
        let sigma_t = sigma_s_prime + sigma_a;
        let f_dr = diffuse_reflectance_fit(ior);
        let a = (1.0 + f_dr) / (1.0 - f_dr);
        let z_r = 1.0 / sigma_t;
        Self {
            albedo: sigma_s_prime / sigma_t,
            sigma_tr: (3.0 * sigma_a * sigma_t).sqrt(),
            z: [z_r, z_r * (1.0 + 4.0 / 3.0 * a)],
        }
    }

    /// Diffuse reflectance R_d at distance `r` ≥ 0 mm, in 1/mm².
    #[must_use]
    pub fn reflectance(&self, r: f64) -> f64 {
        let term = |z: f64| {
            let d = (r * r + z * z).sqrt();
            z / d * (self.sigma_tr + 1.0 / d) * (-self.sigma_tr * d).exp() / d
        };
        self.sum(term) / (2.0 * PI)
    }

    /// ∫₀ʳ R_d(ρ) 2πρ dρ: what leaves within distance `r` ≥ 0 mm of the point of entry. 0..=[`total`](Self::total).
    #[must_use]
    pub fn enclosed(&self, r: f64) -> f64 {
        self.ring(0.0, r)
    }

    /// What leaves beyond distance `r` ≥ 0 mm: `total − enclosed`, without its cancellation.
    #[must_use]
    pub fn beyond(&self, r: f64) -> f64 {
        self.sum(|z| {
            let d = (r * r + z * z).sqrt();
            z / d * (-self.sigma_tr * d).exp()
        })
    }

    /// ∫₀^∞ R_d 2πr dr, 0..=1.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.sum(|z| (-self.sigma_tr * z).exp())
    }

    /// What leaves between the radii `r` and √(r² + `width`²), both ≥ 0 mm: `beyond(r) − beyond(√(r² + width²))` to full
    /// relative accuracy however narrow the ring.
    pub(crate) fn ring(&self, r: f64, width: f64) -> f64 {
        self.sum(|z| {
            let d = (r * r + z * z).sqrt();
            let outer = (d * d + width * width).sqrt();
            // With the difference in the exponent of one expm1 nothing is subtracted from its like.
            let ratio = -0.5 * (width / d).powi(2).ln_1p();
            let decay = -self.sigma_tr * width * (width / (d + outer));
            -z / d * (-self.sigma_tr * d).exp() * (ratio + decay).exp_m1()
        })
    }

    fn sum(&self, term: impl Fn(f64) -> f64) -> f64 {
        if self.albedo == 0.0 {
            0.0
        } else {
            0.5 * self.albedo * self.z.iter().map(|&z| term(z)).sum::<f64>()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::integrate;
    use crate::testing::assert_rel;

    const HARD: [(f64, f64, f64); 9] = [
        (2.19, 0.0021, 1.5),
        (0.03, 1.45, 1.3),
        (20.4, 0.0, 1.3),
        (1.0, 1e-14, 1.0),
        (1e-9, 1e-9, 1.3),
        (1e6, 1e3, 0.8),
        (1e80, 1.0, 1.3),
        (1e-80, 0.0, 1.3),
        (0.0, 1.0, 1.3),
    ];

    #[test]
    fn closure_of_the_plane() {
        for (s, a, ior) in HARD {
            let dipole = Dipole::new(s, a, ior);
            let f = diffuse_reflectance_fit(ior);
            let big_a = (1.0 + f) / (1.0 - f);
            let albedo = if s > 0.0 { s / (s + a) } else { 0.0 };
            let root = if s > 0.0 { (3.0 * a / (s + a)).sqrt() } else { 0.0 };
            let closed = 0.5 * albedo * (1.0 + (-4.0 / 3.0 * big_a * root).exp()) * (-root).exp();
            // Rounding; σ_tr z_r and √(3(1 − α')) are computed along different ways.
            assert_rel(dipole.total(), closed, 1e-12, &format!("{s} {a}"));
            assert!(dipole.total() <= 1.0);
        }
    }

    /// ∫ R_d 2πρ dρ numerically; ln-spaced because the profile spans decades.
    fn numeric_enclosed(dipole: &Dipole, r: f64, gain: f64) -> f64 {
        let low = 1e-6 * dipole.z[0];
        let inner = PI * low * low * dipole.reflectance(0.0);
        let ring = |t: f64| gain * dipole.reflectance(t.exp()) * 2.0 * PI * (2.0 * t).exp();
        inner + integrate(ring, low.ln(), r.ln(), 1e-12)
    }

    #[test]
    fn enclosed_matches_numeric_integral() {
        for (s, a, ior) in &HARD[..6] {
            let dipole = Dipole::new(*s, *a, *ior);
            for r in [0.01, 0.3, 1.0, 7.0, 100.0].map(|r| r * dipole.z[0]) {
                // The tolerance of the integral, and the point-sampled innermost disc (1e-12 of z_r²).
                assert_rel(numeric_enclosed(&dipole, r, 1.0), dipole.enclosed(r), 1e-8, "enclosed");
                let bright = numeric_enclosed(&dipole, r, 1.001);
                assert!((bright / dipole.enclosed(r) - 1.0).abs() > 1e-4, "0.1 % more must be noticed");
            }
        }
    }

    #[test]
    fn rings_and_remainder_agree() {
        let dipole = Dipole::new(1.01, 0.48, 1.3);
        for r in [0.0, 0.5, 3.0, 20.0] {
            assert_rel(dipole.enclosed(r) + dipole.beyond(r), dipole.total(), 1e-14, "split");
            // A hair-thin ring is its area times the profile; a direct difference would have lost every digit.
            let width = 1e-9;
            assert_rel(dipole.ring(r, width), PI * width * width * dipole.reflectance(r), 1e-12, "thin ring");
        }
        let direct = dipole.beyond(3.0) - dipole.beyond((9.0f64 + 1e-18).sqrt());
        assert!((direct - dipole.ring(3.0, 1e-9)).abs() > 1e-3 * dipole.ring(3.0, 1e-9));
    }

    #[test]
    fn stays_finite() {
        for (s, a, ior) in HARD {
            let dipole = Dipole::new(s, a, ior);
            for r in [0.0, 1e-9, 1.0, 1e5, 1e12] {
                for value in [dipole.reflectance(r), dipole.enclosed(r), dipole.beyond(r)] {
                    assert!(value.is_finite() && value >= 0.0, "{s} {a} {ior} at {r}: {value}");
                }
            }
        }
        assert_eq!(Dipole::new(0.0, 1.0, 1.3).reflectance(0.0), 0.0);
        assert_eq!(Dipole::new(0.0, 0.0, 1.3).total(), 0.0);
    }
}
