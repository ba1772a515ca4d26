//! Monte Carlo of a flat half-space or slab: what light that enters at one point returns, ring by ring. The truth that radial profiles
//! approximate.
//!
//! Lengths are mean free paths 1/σ_t. Light is counted once it has *entered*: the share that the surface reflects on the outside is no
//! part of it, so reflected, transmitted, unscattered and absorbed light add up to 1. A walk does not depend on absorption, so one run
//! serves any number of albedos: what was scattered n times counts αⁿ. Leaving is not waited for: every flight towards a face scores
//! what of it would get there and through (the last-flight or next-event estimator; Spanier, Gelbard 1969, "Monte Carlo Principles
//! and Neutron Transport Problems").

mod decay;
mod direction;
mod tally;
mod walk;

pub use decay::decay_rate;
pub use tally::{Estimate, Face, Light, Rings};

use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

/// From where light goes when it has just entered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Entry {
    /// Straight down.
    Normal,
    /// At this cosine to the normal *inside* the medium, above 0 to 1.
    Aslant(f64),
    /// All ways, by the cosine *inside* the medium, whatever the index.
    Cosine,
    /// As the same radiance from all sides enters: by the cosine outside, refracted, weighted with Fresnel's share. That of `Cosine` at
    /// an index of 1.
    Diffuse,
}

/// What to simulate.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// How light enters.
    pub entry: Entry,
    /// Index of refraction, inside over outside, > 0.
    pub ior: f64,
    /// Mean cosine g of Henyey and Greenstein's phase function, −1 < g < 1.
    pub anisotropy: f64,
    /// Thickness in mean free paths, > 0; infinite for a half-space.
    pub thickness: f64,
    /// Single-scattering albedos, 0..=1.
    pub albedos: Vec<f64>,
    /// Outer radii of the rings in mean free paths, ascending; what leaves farther out has a ring of its own.
    pub edges: Vec<f64>,
    /// Walks.
    pub photons: u64,
    /// The same seed gives the same result, whatever the number of threads.
    pub seed: u64,
}

impl Default for Setup {
    /// An index-matched half-space, light along the normal, three rings an octave from 0.02 mean free paths to 160.
    fn default() -> Self {
        Self {
            entry: Entry::Normal,
            ior: 1.0,
            anisotropy: 0.0,
            thickness: f64::INFINITY,
            albedos: vec![0.9],
            edges: (0..40).map(|k| 0.02 * (f64::from(k) / 3.0).exp2()).collect(),
            photons: 100_000,
            seed: 1,
        }
    }
}

/// Independent parts of a run, each with dice of its own. Errors are estimated from how they scatter, to 9 %.
const BATCHES: u64 = 64;

impl Setup {
    /// Walks on all threads of the current pool. `progress` is told the share that is done, and may end the run: then there is no result.
    #[must_use]
    pub fn run(&self, progress: &(dyn Fn(f64) -> ControlFlow<()> + Sync)) -> Option<Light> {
        let done = AtomicU64::new(0);
        let batches: Option<Vec<_>> = (0..BATCHES)
            .into_par_iter()
            .map(|batch| {
                // Rounded so that all batches together hold every photon.
                let photons = (batch + 1) * self.photons / BATCHES - batch * self.photons / BATCHES;
                let tally = walk::batch(self, batch, photons);
                let finished = done.fetch_add(1, Ordering::Relaxed) + 1;
                match progress(finished as f64 / BATCHES as f64) {
                    ControlFlow::Continue(()) => Some(tally),
                    ControlFlow::Break(()) => None,
                }
            })
            .collect();
        Some(Light::new(self, &batches?))
    }

    /// As [`run`](Self::run) to its end.
    #[must_use]
    pub fn finish(&self) -> Light {
        let batches: Vec<_> = (0..BATCHES)
            .into_par_iter()
            .map(|batch| {
                let photons = (batch + 1) * self.photons / BATCHES - batch * self.photons / BATCHES;
                walk::batch(self, batch, photons)
            })
            .collect();
        Light::new(self, &batches)
    }
}
