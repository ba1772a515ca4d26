//! R_d for whoever wants to look at it.

use super::{Channels, Profile};
use crate::{Error, Medium};

/// Radial diffuse reflectance of a medium by a profile, in double precision: for plots and comparisons, not for shaders.
///
/// ```
/// use translume::{Medium, Profile};
///
/// let reflectance = Profile::default().reflectance(&Medium::MARBLE)?;
/// // Marble returns most of what enters.
/// assert!(reflectance.total().iter().all(|share| (0.6..1.0).contains(share)));
/// # Ok::<(), translume::Error>(())
/// ```
pub struct Reflectance {
    channels: Channels,
}

impl Profile {
    /// R_d of a medium. That of [`Profile::DipoleOriented`], whose sources lie off the surface, is the classical dipole's.
    ///
    /// # Errors
    /// Those of [`Profile::validate`] and [`Medium::validate`].
    pub fn reflectance(&self, medium: &Medium) -> Result<Reflectance, Error> {
        self.validate()?;
        medium.validate()?;
        let flat = if self.is_oriented() { &Self::DipoleNormalised } else { self };
        Ok(Reflectance { channels: flat.channels(medium) })
    }
}

impl Reflectance {
    /// At a distance of `r` > 0 mm from where light entered, RGB, 1/mm².
    #[must_use]
    pub fn at(&self, r: f64) -> [f64; 3] {
        [0, 1, 2].map(|k| self.channels[k].scaled_reflectance(r) * (-self.channels[k].decay() * r).exp())
    }

    /// ∫ R_d over the plane, RGB, 0..=1: what an evenly lit plane gives back.
    #[must_use]
    pub fn total(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| self.channels[k].total())
    }

    /// Rate of the exponential far away, RGB, 1/mm.
    #[must_use]
    pub fn decay(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| self.channels[k].decay())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_add_up_to_the_total() {
        let medium = Medium::SKIN1;
        for (name, profile) in Profile::NAMES {
            let reflectance = profile.reflectance(&medium).unwrap();
            // Trapezoids over ln r: R_d·2πr² dln r, from a thousandth of a mean free path to forty decay lengths.
            let sum = |k: usize| -> f64 {
                let step = 0.02;
                let rings = (0..900).map(|n| 1e-4 * (step * f64::from(n)).exp());
                rings.map(|r| reflectance.at(r)[k] * std::f64::consts::TAU * r * r * step).sum()
            };
            for k in 0..3 {
                let (found, wanted) = (sum(k), reflectance.total()[k]);
                // What lies nearer than 1e-4 mm of a profile of 1/r: 1e-4 of it. Measured 4e-4 at most.
                assert!((found / wanted - 1.0).abs() < 2e-3, "{name}, {k}: {found} {wanted}");
                assert!((found / (1.01 * wanted) - 1.0).abs() > 2e-3, "one per cent would be noticed");
            }
        }
        let broken = Medium { ior: f32::NAN, ..medium };
        assert!(Profile::default().reflectance(&broken).is_err());
    }
}
