//! The surface that light enters through: how much enters from each direction, and how much of that counts.

use crate::fresnel::{hemispherical_transmittance, refracted_cos, transmittance};
use crate::quadrature::integrate_panels;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A smooth dielectric with a gain of entry. A profile tells what returns of light along the normal; what enters aslant starts less deep, and
/// more of it returns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// Index of refraction, inside over outside, > 0.
    pub ior: f64,
    /// k of each channel, 0 to below 1: light whose direction inside has the cosine μ' to the normal counts 1/(1 − k (1 − μ')) times. 0 where all
    /// that enters counts alike.
    pub slant: [f64; 3],
}

impl From<f64> for Boundary {
    /// Without a gain.
    fn from(ior: f64) -> Self {
        Self { ior, slant: [0.0; 3] }
    }
}

impl Boundary {
    /// F_t times the gain in each channel, for light from a direction outside with this cosine to the normal.
    #[must_use]
    pub fn entering(&self, cos: f64) -> [f64; 3] {
        let fresnel = transmittance(self.ior, cos);
        let lost = 1.0 - refracted_cos(self.ior, cos);
        self.slant.map(|slant| fresnel / (1.0 - slant * lost))
    }

    /// ∫ F_t g cos dω over the hemisphere, sr.
    #[must_use]
    pub fn whole_sky(&self) -> [f64; 3] {
        if self.slant == [0.0; 3] {
            return [PI * hemispherical_transmittance(self.ior); 3];
        }
        let mut breaks = vec![0.0, FRAC_PI_2];
        if self.ior < 1.0 {
            breaks.insert(1, self.ior.asin());
        }
        let ring = |polar: f64, share: f64| TAU * share * polar.cos() * polar.sin();
        self.each(|entering| integrate_panels(|polar| ring(polar, entering(polar.cos())), &breaks, 1e-10))
    }

    /// Something of each channel by what enters there; of channels alike once.
    pub(crate) fn each(&self, of: impl Fn(&dyn Fn(f64) -> f64) -> f64) -> [f64; 3] {
        let channel = |k: usize| of(&|cos| self.entering(cos)[k]);
        let red = channel(0);
        if self.slant == [self.slant[0]; 3] { [red; 3] } else { [red, channel(1), channel(2)] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_along_the_normal_counts_as_it_is() {
        let boundary = Boundary { ior: 1.4, slant: [0.0, 0.3, 0.9] };
        assert_eq!(boundary.entering(1.0), [transmittance(1.4, 1.0); 3]);
        // At the critical angle inside, μ'² = 1 − 1/η².
        let grazing = boundary.entering(1e-9).map(|entering| entering / transmittance(1.4, 1e-9));
        let inside = (1.0 - 1.0 / (1.4_f64 * 1.4)).sqrt();
        for (gain, slant) in grazing.iter().zip(boundary.slant) {
            assert!((gain * (1.0 - slant * (1.0 - inside)) - 1.0).abs() < 1e-12, "{grazing:?}");
        }
        assert!(grazing[0] == 1.0 && grazing[2] > grazing[1] && grazing[1] > 1.05, "{grazing:?}");
    }
}
