//! Radial reflectance profiles of one colour channel, beside the closed-form [`Dipole`].
//!
//! Each is a function that tells R_d(r) by adaptive quadrature or by a plain sum; [`Numeric`] makes a profile of it.

mod beam;
mod diffusion;
mod half_space;
mod numeric;
mod stack;
mod table;

pub use beam::{photon_beam, with_single};
pub use diffusion::{Entry, better_dipole, half_space_albedo, normalised_diffusion};
pub use half_space::{half_space, walks};
pub use numeric::Numeric;
pub use stack::{Sheet, stack};
pub use table::table;

use crate::Dipole;

/// What a sum over sources asks of a profile.
pub trait Profile: Sync {
    /// R_d at distance `r` ≥ 0 mm, 1/mm². May be infinite at 0.
    fn reflectance(&self, r: f64) -> f64;

    /// ∫₀ʳ R_d(ρ) 2πρ dρ.
    fn enclosed(&self, r: f64) -> f64;

    /// What leaves beyond `r` ≥ 0 mm, without the cancellation of `total − enclosed`.
    fn beyond(&self, r: f64) -> f64;

    /// What leaves between `r` and √(r² + `width`²), to full accuracy however narrow the ring.
    fn ring(&self, r: f64, width: f64) -> f64;

    /// ∫₀^∞ R_d 2πr dr, 0..=1.
    fn total(&self) -> f64;

    /// Rate of the exponential far away, 1/mm.
    fn decay(&self) -> f64;

    /// Length below which R_d is smooth, mm; 0 where it has no bound at r = 0.
    fn core(&self) -> f64;
}

impl Profile for Dipole {
    fn reflectance(&self, r: f64) -> f64 {
        Self::reflectance(self, r)
    }

    fn enclosed(&self, r: f64) -> f64 {
        Self::enclosed(self, r)
    }

    fn beyond(&self, r: f64) -> f64 {
        Self::beyond(self, r)
    }

    fn ring(&self, r: f64, width: f64) -> f64 {
        Self::ring(self, r, width)
    }

    fn total(&self) -> f64 {
        Self::total(self)
    }

    fn decay(&self) -> f64 {
        self.sigma_tr
    }

    fn core(&self) -> f64 {
        self.z[0]
    }
}

/// Coefficients of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channel {
    /// Reduced scattering coefficient σ_s', 1/mm, > 0.
    pub sigma_s_prime: f64,
    /// Absorption coefficient σ_a, 1/mm, ≥ 0.
    pub sigma_a: f64,
    /// Index of refraction, inside over outside.
    pub ior: f64,
}

impl Channel {
    /// σ_t', 1/mm.
    #[must_use]
    pub fn sigma_t(&self) -> f64 {
        self.sigma_s_prime + self.sigma_a
    }

    /// α', 0..=1.
    #[must_use]
    pub fn albedo(&self) -> f64 {
        self.sigma_s_prime / self.sigma_t()
    }
}
