//! What a body is made of.

use translume_mesh::Scattering;

use crate::Error;

/// A homogeneous scattering medium.
///
/// Source of the presets: Jensen, Marschner, Levoy, Hanrahan 2001, "A Practical Model for Subsurface Light Transport", fig. 5.
///
/// ```
/// use translume::Medium;
///
/// let wax = Medium::preset("wax")?;
/// let green_glass_paste = Medium { sigma_s_prime: [0.8, 1.0, 0.8], sigma_a: [0.05, 0.002, 0.03], ior: 1.5, g: 0.8 };
/// green_glass_paste.validate()?;
/// # Ok::<(), translume::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Reduced scattering coefficient σ_s' = σ_s (1 − g), RGB, 1/mm. Finite, ≥ 0.
    pub sigma_s_prime: [f32; 3],
    /// Absorption coefficient σ_a, RGB, 1/mm. Finite, ≥ 0.
    pub sigma_a: [f32; 3],
    /// Index of refraction inside over outside. Finite, > 0; exactly 1 means no surface reflection at all.
    pub ior: f32,
    /// Mean cosine g of the phase function, by Henyey and Greenstein: −0.99..=0.99, with 0 for even scattering, which is what every preset has. Only
    /// [`Transport::BoundaryLayers`](crate::Transport::BoundaryLayers) asks for it, for light that goes nearly straight on; to all else the
    /// reduced coefficient says enough.
    pub g: f32,
}

/// Of g: a beam that is turned less than by a hundredth on average is one that goes on.
const MOST_FORWARD: f32 = 0.99;

impl Default for Medium {
    /// [`Medium::MARBLE`].
    fn default() -> Self {
        Self::MARBLE
    }
}

macro_rules! presets {
    ($($(#[$doc:meta])* $constant:ident $name:literal: [$($s:literal),+] [$($a:literal),+] $ior:literal;)+) => {
        impl Medium {
            $($(#[$doc])* pub const $constant: Self = Self { sigma_s_prime: [$($s),+], sigma_a: [$($a),+], ior: $ior, g: 0.0 };)+

            /// Every preset with its name.
            pub const PRESETS: &[(&'static str, Self)] = &[$(($name, Self::$constant)),+];
        }
    };
}

presets! {
    /// Apple.
    APPLE "apple": [2.29, 2.39, 1.97] [0.0030, 0.0034, 0.046] 1.3;
    /// Chicken, first sample.
    CHICKEN1 "chicken1": [0.15, 0.21, 0.38] [0.015, 0.077, 0.19] 1.3;
    /// Chicken, second sample.
    CHICKEN2 "chicken2": [0.19, 0.25, 0.32] [0.018, 0.088, 0.20] 1.3;
    /// Cream.
    CREAM "cream": [7.38, 5.47, 3.15] [0.0002, 0.0028, 0.0163] 1.3;
    /// Ketchup.
    KETCHUP "ketchup": [0.18, 0.07, 0.03] [0.061, 0.97, 1.45] 1.3;
    /// Marble.
    MARBLE "marble": [2.19, 2.62, 3.00] [0.0021, 0.0041, 0.0071] 1.5;
    /// Potato.
    POTATO "potato": [0.68, 0.70, 0.55] [0.0024, 0.0090, 0.12] 1.3;
    /// Skim milk.
    SKIMMILK "skimmilk": [0.70, 1.22, 1.90] [0.0014, 0.0025, 0.0142] 1.3;
    /// Skin, first sample.
    SKIN1 "skin1": [0.74, 0.88, 1.01] [0.032, 0.17, 0.48] 1.3;
    /// Skin, second sample.
    SKIN2 "skin2": [1.09, 1.59, 1.79] [0.013, 0.070, 0.145] 1.3;
    /// Spectralon: no absorption at all.
    SPECTRALON "spectralon": [11.6, 20.4, 14.9] [0.0, 0.0, 0.0] 1.3;
    /// Whole milk.
    WHOLEMILK "wholemilk": [2.55, 3.21, 3.77] [0.0011, 0.0024, 0.014] 1.3;
    /// Green jade, set by eye; not a measurement.
    JADE "jade": [0.9, 1.3, 0.95] [0.055, 0.0045, 0.03] 1.5;
    /// White soap, set by eye; not a measurement.
    SOAP "soap": [1.5, 1.45, 1.3] [0.0015, 0.0035, 0.012] 1.45;
    /// Honey-coloured wax, set by eye; not a measurement.
    WAX "wax": [1.6, 1.4, 1.0] [0.002, 0.012, 0.07] 1.4;
}

impl Medium {
    /// The preset of this name. Case, spaces, dashes and underscores do not matter.
    ///
    /// # Errors
    /// [`Error::UnknownMedium`] lists the names there are.
    pub fn preset(name: &str) -> Result<Self, Error> {
        let wanted: String =
            name.chars().filter(|c| !matches!(c, ' ' | '-' | '_')).flat_map(char::to_lowercase).collect();
        Self::PRESETS.iter().find(|(preset, _)| *preset == wanted).map(|(_, medium)| *medium).ok_or_else(
            || {
                let known = Self::PRESETS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
                Error::UnknownMedium { name: name.to_owned(), known }
            },
        )
    }

    /// Mean free paths of the channels that scatter, mm.
    pub(crate) fn mean_free_paths(&self) -> impl Iterator<Item = f32> {
        let channels = self.sigma_s_prime.into_iter().zip(self.sigma_a);
        channels.filter(|(scattering, _)| *scattering > 0.0).map(|(s, a)| 1.0 / (s + a))
    }

    /// Checks every coefficient's range.
    ///
    /// # Errors
    /// [`Error::Medium`] names the coefficient and channel.
    pub fn validate(&self) -> Result<(), Error> {
        const SCATTERING: [&str; 3] =
            ["sigma_s_prime (red)", "sigma_s_prime (green)", "sigma_s_prime (blue)"];
        const ABSORPTION: [&str; 3] = ["sigma_a (red)", "sigma_a (green)", "sigma_a (blue)"];
        let coefficients = SCATTERING.into_iter().zip(self.sigma_s_prime);
        for (field, value) in coefficients.chain(ABSORPTION.into_iter().zip(self.sigma_a)) {
            if !(0.0..=f32::MAX).contains(&value) {
                return Err(Error::Medium { field, value, range: "finite and not negative (1/mm)" });
            }
        }
        if !(self.ior > 0.0 && self.ior.is_finite()) {
            return Err(Error::Medium { field: "ior", value: self.ior, range: "finite and above 0" });
        }
        if !(-MOST_FORWARD..=MOST_FORWARD).contains(&self.g) {
            return Err(Error::Medium { field: "g", value: self.g, range: "between −0.99 and 0.99" });
        }
        Ok(())
    }
}

impl TryFrom<Scattering> for Medium {
    type Error = Error;

    /// The medium that a file's material describes; both are in 1/mm.
    ///
    /// # Errors
    /// As [`Medium::validate`].
    fn try_from(scattering: Scattering) -> Result<Self, Error> {
        let Scattering { sigma_s_prime, sigma_a, ior, g } = scattering;
        let medium = Self { sigma_s_prime, sigma_a, ior, g };
        medium.validate()?;
        Ok(medium)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scattering_of_a_material_is_a_medium() {
        let wax = Medium::WAX;
        let scattering =
            Scattering { sigma_s_prime: wax.sigma_s_prime, sigma_a: wax.sigma_a, ior: wax.ior, g: 0.0 };
        assert_eq!(Medium::try_from(scattering), Ok(wax));
        let endless = Scattering { sigma_a: [0.0, f32::INFINITY, 0.0], ..scattering };
        assert!(Medium::try_from(endless).unwrap_err().to_string().contains("sigma_a (green)"));
    }

    #[test]
    fn presets_are_valid_and_found_by_any_spelling() {
        for (name, medium) in Medium::PRESETS {
            medium.validate().unwrap();
            assert_eq!(Medium::preset(&name.to_uppercase()), Ok(*medium));
        }
        assert_eq!(Medium::preset("Whole Milk"), Ok(Medium::WHOLEMILK));
    }

    #[test]
    fn a_wrong_name_lists_the_right_ones() {
        let message = Medium::preset("kryptonite").unwrap_err().to_string();
        assert!(message.contains("kryptonite") && message.contains("skimmilk"), "{message}");
    }

    #[test]
    fn impossible_coefficients_are_named() {
        let mut medium = Medium::WAX;
        medium.sigma_a[2] = -1.0;
        assert!(medium.validate().unwrap_err().to_string().contains("sigma_a (blue)"));
        medium = Medium { ior: f32::NAN, ..Medium::WAX };
        assert!(medium.validate().unwrap_err().to_string().contains("ior"));
        medium = Medium { sigma_s_prime: [1.0, f32::INFINITY, 1.0], ..Medium::WAX };
        assert!(medium.validate().unwrap_err().to_string().contains("(green)"));
        medium = Medium { g: 1.0, ..Medium::WAX };
        assert!(medium.validate().unwrap_err().to_string().contains("g is 1"));
    }
}
