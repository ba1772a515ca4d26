//! A real and a virtual source: the classical dipole and d'Eon's better one.

use super::channel::{Channel, Grosjean, classical_boundary};
use super::radial::Radial;

/// R_d(r) = flux·Σ_z z(1 + σ_tr d)e^(−σ_tr d)/2πd³ + fluence·(e^(−σ_tr d_r)/d_r − e^(−σ_tr d_v)/d_v)/2π, with z the depth z_r of the
/// real source and the height z_v of the virtual one, d² = r² + z².
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dipole {
    flux: f64,
    /// 1/mm.
    fluence: f64,
    /// 1/mm.
    sigma_tr: f64,
    /// mm.
    z_r: f64,
    /// mm.
    z_v: f64,
}

impl Dipole {
    /// Jensen et al. 2001, eq. 4; constants as in Gong et al. 2008, eqs. 3–7.
    pub fn classical(channel: &Channel) -> Self {
        let extinction = channel.extinction();
        let z_r = 1.0 / extinction;
        Self {
            flux: 0.5 * channel.albedo(),
            fluence: 0.0,
            sigma_tr: (3.0 * channel.absorption * extinction).sqrt(),
            z_r,
            z_v: z_r * (1.0 + 4.0 / 3.0 * classical_boundary(channel.ior)),
        }
    }

    /// D'Eon 2012, "A Better Dipole".
    pub fn better(channel: &Channel) -> Self {
        // One α' is that of the first scattering, the other that of Grosjean's diffusion from there.
        Self::at_depth(&Grosjean::new(channel), 1.0 / channel.extinction()).weighted(channel.albedo().powi(2))
    }

    /// A point source of unit power at a depth, mm, mirrored about the plane where fluence vanishes.
    pub fn at_depth(grosjean: &Grosjean, depth: f64) -> Self {
        Self {
            flux: 0.5 * grosjean.flux,
            fluence: 0.5 * grosjean.fluence / grosjean.diffusion,
            sigma_tr: grosjean.sigma_tr,
            z_r: depth,
            z_v: depth + 2.0 * grosjean.z_b,
        }
    }

    /// Of the virtual source above the surface, mm.
    pub fn height(&self) -> f64 {
        self.z_v
    }

    fn weighted(self, weight: f64) -> Self {
        Self { flux: weight * self.flux, fluence: weight * self.fluence, ..self }
    }

    fn each_source(&self, term: impl Fn(f64) -> f64) -> f64 {
        self.flux * (term(self.z_r) + term(self.z_v))
    }

    /// (e^(−σ_tr d_r)/d_r − e^(−σ_tr d_v)/d_v)·e^(σ_tr r). The ratio of the two in one logarithm, for far away they are nearly the same.
    fn scaled_fluence(&self, r: f64) -> f64 {
        let (near, far) = (r.hypot(self.z_r), r.hypot(self.z_v));
        let apart = self.gap_of_squares() / (near + far);
        let ratio = 0.5 * (-self.gap_of_squares() / (far * far)).ln_1p() - self.sigma_tr * apart;
        -ratio.exp_m1() / near * (-self.sigma_tr * (self.z_r * self.z_r / (near + r))).exp()
    }

    /// e^(σ_tr·inner) · ∫ of the same over a ring, over 2π: F(inner) − F(outer) with F = (e^(−σ_tr d_r) − e^(−σ_tr d_v))/σ_tr.
    fn scaled_fluence_ring(&self, inner: f64, outer: f64) -> f64 {
        let (near, far) = (inner.hypot(self.z_r), inner.hypot(self.z_v));
        let (near_out, far_out) = (outer.hypot(self.z_r), outer.hypot(self.z_v));
        let area = (outer - inner) * (outer + inner);
        let (sum, sum_out) = (near + far, near_out + far_out);
        let growth = area / (near + near_out) + area / (far + far_out);
        let apart = self.gap_of_squares() / sum;
        // How much less the two distances differ at the outer rim.
        let closer = self.sigma_tr * apart * (growth / sum_out);
        let ratio = -self.sigma_tr * area / (near + near_out) - (growth / sum).ln_1p()
            + rise_of_mean_decay(self.sigma_tr * apart, closer);
        let falloff = (-self.sigma_tr * (self.z_r * self.z_r / (near + inner))).exp();
        -ratio.exp_m1() * falloff * apart * mean_decay(self.sigma_tr * apart)
    }

    fn gap_of_squares(&self) -> f64 {
        (self.z_v - self.z_r) * (self.z_v + self.z_r)
    }
}

/// (1 − e^(−x))/x, also at 0.
fn mean_decay(x: f64) -> f64 {
    if x < 1e-12 { 1.0 } else { -(-x).exp_m1() / x }
}

/// ln of `mean_decay(x − step)` over `mean_decay(x)`, also for a tiny step.
fn rise_of_mean_decay(x: f64, step: f64) -> f64 {
    if step > 1e-3 {
        return (mean_decay(x - step) / mean_decay(x)).ln();
    }
    let middle = x - 0.5 * step;
    let slope = if middle < 0.01 { 0.5 - middle / 12.0 } else { 1.0 / middle - 1.0 / middle.exp_m1() };
    step * slope
}

impl Radial for Dipole {
    fn decay(&self) -> f64 {
        self.sigma_tr
    }

    fn scaled_reflectance(&self, r: f64) -> f64 {
        let flux = self.each_source(|z| {
            let d = (r * r + z * z).sqrt();
            z * (1.0 + self.sigma_tr * d) * (-self.sigma_tr * (z * z / (d + r))).exp() / d.powi(3)
        });
        let fluence = if self.fluence == 0.0 { 0.0 } else { self.fluence * self.scaled_fluence(r) };
        (flux + fluence) / std::f64::consts::TAU
    }

    fn scaled_ring(&self, inner: f64, outer: f64) -> f64 {
        let flux = self.each_source(|z| {
            let near = (inner * inner + z * z).sqrt();
            let far = (outer * outer + z * z).sqrt();
            let step = (outer * outer - inner * inner) / (near + far);
            let falloff = (-self.sigma_tr * (z * z / (near + inner))).exp();
            z / far * falloff * (step / near - (-self.sigma_tr * step).exp_m1())
        });
        let fluence =
            if self.fluence == 0.0 { 0.0 } else { self.fluence * self.scaled_fluence_ring(inner, outer) };
        flux + fluence
    }

    fn total(&self) -> f64 {
        let apart = self.z_v - self.z_r;
        let fluence =
            self.fluence * apart * mean_decay(self.sigma_tr * apart) * (-self.sigma_tr * self.z_r).exp();
        self.each_source(|z| (-self.sigma_tr * z).exp()) + fluence
    }

    fn smooth_length(&self) -> f64 {
        self.z_r
    }
}
