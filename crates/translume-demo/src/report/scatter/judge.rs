//! What should come out, at some of the texels.

use super::all_pairs;
use crate::report::twin::Twin;
use translume::{Light, Medium};
use translume_reference::converged::Converged;
use translume_reference::gather::Source;
use translume_reference::metrics::{self, Metrics};

/// Light is cast onto patches no longer than this, mm; it varies slowly, as nothing casts shadows.
const EDGE: f64 = 1.0;

/// The truth at the texels it was computed at.
pub struct Judge {
    receivers: Vec<usize>,
    exact: Vec<[f64; 3]>,
}

impl Judge {
    /// The sum over all texels, in double precision.
    pub fn all_pairs(sources: &[Source], medium: &Medium, receivers: Vec<usize>) -> Self {
        let exact = all_pairs::exitance(sources, &translume_twin::dipoles(medium), &receivers);
        Self { receivers, exact }
    }

    /// The integral over the triangles as they are deformed, at the middle of texels.
    pub fn converged(
        twin_of: &Twin,
        lights: &[Light],
        sources: &[Source],
        medium: &Medium,
        receivers: Vec<usize>,
    ) -> Self {
        let lights: Vec<_> = lights.iter().filter_map(|light| twin_of.light(light)).collect();
        let places: Vec<_> = receivers.iter().map(|&k| sources[k].position).collect();
        let converged = Converged::new(&twin_of.surface, &lights, &translume_twin::medium(medium), EDGE);
        Self { exact: converged.exitance(&places), receivers }
    }

    /// `None` where there is nothing to compare.
    pub fn compare(&self, exitance: &[[f32; 4]]) -> Option<Metrics> {
        let at = |&k: &usize| exitance[k][..3].iter().copied().map(f64::from).collect::<Vec<_>>();
        let found: Vec<f64> = self.receivers.iter().flat_map(at).collect();
        metrics::compare(&found, self.exact.as_flattened(), None)
    }
}

#[cfg(test)]
mod tests {
    use super::Judge;

    #[test]
    fn only_the_receivers_count() {
        let judge = Judge { receivers: vec![0, 2], exact: vec![[1.0, 2.0, 3.0]; 2] };
        let right = [1.0, 2.0, 3.0, 57.0];
        let exitance = [right, [9.0; 4], right];
        assert_eq!(judge.compare(&exitance).unwrap().relative_rmse, 0.0);
        let dark = judge.compare(&[right, right, [0.0; 4]]).unwrap();
        // Half of the light is missing: 6 of 12, and 1 + 4 + 9 over six values with a mean of 2.
        assert!((dark.bias + 0.5).abs() < 1e-12);
        assert!((dark.relative_rmse - (14.0_f64 / 6.0).sqrt() / 2.0).abs() < 1e-12);
    }
}
