//! The surface as light enters it: how much does from each direction, and how much of that counts.

use crate::{Medium, Profile, Transport, fresnel};
use std::f64::consts::TAU;

/// A smooth dielectric with a gain of entry ([`Profile::slant`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Boundary {
    /// Index of refraction, inside over outside.
    pub eta: f32,
    /// k of each channel; 0 where all that enters counts alike.
    pub slant: [f32; 3],
    /// Whether texels beside a chart are moved onto it.
    pub on_surface: bool,
}

impl Boundary {
    pub fn new(profile: &Profile, medium: &Medium, transport: Transport) -> Self {
        // The solver puts light where it scatters: it has no use for a gain.
        let on_surface = transport != Transport::Classic;
        let slant = if on_surface { [0.0; 3] } else { profile.slant(medium) };
        Self { eta: medium.ior, slant, on_surface }
    }

    /// F_t·g of each channel. `cosine`: to the normal outside, 0..1.
    pub fn entering(&self, cosine: f64) -> [f64; 3] {
        let eta = f64::from(self.eta);
        let inside = (1.0 - (1.0 - cosine * cosine) / (eta * eta)).max(0.0).sqrt();
        let entered = fresnel::transmittance(eta, cosine);
        self.slant.map(|slant| entered / (1.0 - f64::from(slant) * (1.0 - inside)))
    }

    /// a_l = 2π ∫ F_t·g·c·P_l(c) dc for l = 0, 1, 2, each of three channels: π, 2π/3, π/4 at eta = 1 without a gain.
    pub fn lobe(&self) -> [[f64; 3]; 3] {
        // The substitution c = critical + (1 − critical)·u² tames the square root where the surface begins to transmit.
        const STEPS: usize = 2048;
        let eta = f64::from(self.eta);
        let critical = (1.0 - eta * eta).max(0.0).sqrt();
        let mut sums = [[0.0; 3]; 3];
        for k in 0..STEPS {
            let u = (k as f64 + 0.5) / STEPS as f64;
            let cosine = critical + (1.0 - critical) * u * u;
            let weight = TAU * cosine * (1.0 - critical) * 2.0 * u / STEPS as f64;
            let legendre = [1.0, cosine, 1.5 * cosine * cosine - 0.5];
            let entering = self.entering(cosine);
            for (sum, polynomial) in sums.iter_mut().zip(legendre) {
                *sum = std::array::from_fn(|channel| sum[channel] + weight * polynomial * entering[channel]);
            }
        }
        sums
    }
}
