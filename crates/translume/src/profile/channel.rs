//! One colour channel of a medium, and its constants of diffusion.

use crate::{Medium, fresnel};

/// Coefficients of one channel, 1/mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Channel {
    pub scattering: f64,
    pub absorption: f64,
    /// Index of refraction inside over outside.
    pub ior: f64,
}

impl Channel {
    pub fn of(medium: &Medium) -> [Self; 3] {
        [0, 1, 2].map(|channel| Self {
            scattering: medium.sigma_s_prime[channel].into(),
            absorption: medium.sigma_a[channel].into(),
            ior: medium.ior.into(),
        })
    }

    /// σ_t'. A medium that does nothing at all has an infinite mean free path; a very long one behaves the same and stays finite.
    pub fn extinction(&self) -> f64 {
        (self.scattering + self.absorption).max(1e-12)
    }

    /// α', 0..=1.
    pub fn albedo(&self) -> f64 {
        self.scattering / self.extinction()
    }
}

/// A of the boundary condition φ(0) = 2·A·D·φ'(0), from the fits of the classical dipole. `eta`: index inside over outside.
pub(crate) fn classical_boundary(eta: f64) -> f64 {
    let f_dr = fresnel::diffuse_internal_reflectance(eta).clamp(-0.99, 0.99);
    (1.0 + f_dr) / (1.0 - f_dr)
}

/// Diffusion after Grosjean, with a boundary from the true Fresnel equations. D'Eon 2012, "A Better Dipole"; d'Eon, Irving 2011, "A
/// Quantized-Diffusion Model for Rendering Translucent Materials".
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grosjean {
    /// D = (2σ_a + σ_s')/(3σ_t'²), mm.
    pub diffusion: f64,
    /// √(σ_a/D), 1/mm.
    pub sigma_tr: f64,
    /// Distance of the plane where fluence vanishes, 2AD, mm.
    pub z_b: f64,
    /// C_φ = ¼(1 − 2C₁): share of fluence in the exitance.
    pub fluence: f64,
    /// C_E = ½(1 − 3C₂): share of flux.
    pub flux: f64,
}

impl Grosjean {
    pub fn new(channel: &Channel) -> Self {
        let extinction = channel.extinction();
        // σ_s' + 2σ_a, finite where neither is.
        let diffusion = (extinction + channel.absorption) / (3.0 * extinction * extinction);
        // 1 − 2C₁ and 1 − 3C₂. An index beyond any real one would seal the surface.
        let open = fresnel::transmitted_moment(1.0 / channel.ior, 1).max(5e-3);
        let open_flux = fresnel::transmitted_moment(1.0 / channel.ior, 2);
        let boundary = (2.0 - open_flux) / open;
        Self {
            diffusion,
            sigma_tr: (channel.absorption / diffusion).sqrt(),
            z_b: 2.0 * boundary * diffusion,
            fluence: 0.25 * open,
            flux: 0.5 * open_flux,
        }
    }
}
