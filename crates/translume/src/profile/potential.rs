//! The potential about a point source in an endless medium.

use super::channel::Channel;
use super::radial::Radial;
use std::f64::consts::PI;

/// K(r) = e^(−σ_tr r)/4πr, fluence over D of a source of unit power: its flux −D∇φ is −∇K.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Potential {
    /// 1/mm.
    sigma_tr: f64,
}

impl Potential {
    pub fn new(channel: &Channel) -> Self {
        Self { sigma_tr: (3.0 * channel.absorption * channel.extinction()).sqrt() }
    }
}

impl Radial for Potential {
    fn decay(&self) -> f64 {
        self.sigma_tr
    }

    fn scaled_reflectance(&self, r: f64) -> f64 {
        1.0 / (4.0 * PI * r)
    }

    fn scaled_ring(&self, inner: f64, outer: f64) -> f64 {
        let (width, x) = (outer - inner, self.sigma_tr * (outer - inner));
        0.5 * width * if x < 1e-12 { 1.0 } else { -(-x).exp_m1() / x }
    }

    /// Without absorption it has no end; all that counts is that it is not 0.
    fn total(&self) -> f64 {
        if self.sigma_tr > 0.0 { 0.5 / self.sigma_tr } else { f64::MAX }
    }

    /// The sources of a cluster are as far apart as its normals turn them, so it counts for no less that they are off the surface: with a mean
    /// free path here, a body of two mean free paths is 35 % off.
    fn smooth_length(&self) -> f64 {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_are_integrals() {
        for absorption in [0.0, 1e-9, 0.3] {
            let k = Potential::new(&Channel { scattering: 1.0, absorption, ior: 1.0 });
            for (inner, outer) in [(0.0, 1.0), (0.5, 0.5001), (3.0, 40.0)] {
                let steps = 20_000;
                let ring = |step: i32| {
                    let r = inner + (outer - inner) * (f64::from(step) + 0.5) / f64::from(steps);
                    k.scaled_reflectance(r) * (-k.decay() * (r - inner)).exp() * 2.0 * PI * r
                };
                let expected = (0..steps).map(ring).sum::<f64>() * (outer - inner) / f64::from(steps);
                let error = k.scaled_ring(inner, outer) / expected - 1.0;
                // The midpoint rule's own: (σ_tr · step)²/24.
                assert!(error.abs() < 1e-6, "{absorption} {inner} {outer}: {error}");
                let brighter = k.scaled_ring(inner, outer) / (0.999 * expected) - 1.0;
                assert!(brighter.abs() > 1e-6, "a thousandth more must be noticed");
            }
        }
    }
}
