//! The material inside the object.

use crate::dipole::Dipole;

/// A homogeneous scattering medium behind a smooth dielectric boundary, in air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Reduced scattering coefficient σ_s' = σ_s (1 − g), RGB, 1/mm. Finite, ≥ 0.
    pub sigma_s_prime: [f64; 3],
    /// Absorption coefficient σ_a, RGB, 1/mm. Finite, ≥ 0.
    pub sigma_a: [f64; 3],
    /// Index of refraction η, inside over outside. Positive; 1 is an index-matched boundary.
    pub ior: f64,
}

impl Medium {
    /// The dipole of each colour channel.
    #[must_use]
    pub fn dipoles(&self) -> [Dipole; 3] {
        std::array::from_fn(|k| Dipole::new(self.sigma_s_prime[k], self.sigma_a[k], self.ior))
    }
}
