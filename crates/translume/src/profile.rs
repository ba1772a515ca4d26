//! Radial diffuse reflectance R_d(r): how far light wanders under the surface.

use crate::{Error, Medium, fresnel};

/// Which R_d(r) scatters, and how light leaves towards the eye.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Profile {
    /// The classical dipole with L_o = F_t·B/π, to the letter of Gong et al. 2008 (eqs. 3–7). It loses 6 % at η = 1.3 and 9 % at
    /// η = 1.5 even on a plane under a uniform sky, because F_t is not normalised over the hemisphere.
    Dipole,
    /// The same dipole with F_t divided by its hemispherical mean 1 − F_dr,ext, so that what B says leaves does leave.
    #[default]
    DipoleNormalised,
}

impl Profile {
    /// Every profile with its name.
    pub const NAMES: &[(&'static str, Self)] =
        &[("dipole", Self::Dipole), ("dipole-normalised", Self::DipoleNormalised)];

    /// The profile of this name.
    ///
    /// # Errors
    /// [`Error::UnknownProfile`] lists the names there are.
    pub fn named(name: &str) -> Result<Self, Error> {
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, profile)| *profile).ok_or_else(|| {
            let known = Self::NAMES.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
            Error::UnknownProfile { name: name.to_owned(), known }
        })
    }

    /// What a host's own material multiplies F_t(η, ω_o)·B/π with: 1, or 1/(1 − F_dr,ext). `ior` as in [`Medium::ior`].
    #[must_use]
    pub fn exit_scale(self, ior: f32) -> f32 {
        match self {
            Self::Dipole => 1.0,
            Self::DipoleNormalised => (1.0 / fresnel::hemispherical_transmittance(f64::from(ior))) as f32,
        }
    }
}

/// The classical dipole of one colour channel. Jensen et al. 2001, eq. 4; constants as in Gong et al. 2008, eqs. 3–7.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dipole {
    /// α'/2: what each of the two sources carries.
    half_albedo: f64,
    /// σ_tr, 1/mm.
    pub(crate) sigma_tr: f64,
    /// Depth of the real source, one transport mean free path, mm.
    pub(crate) z_r: f64,
    /// Height of the virtual source, mm.
    z_v: f64,
}

impl Dipole {
    pub(crate) fn new(medium: &Medium, channel: usize) -> Self {
        let scattering = f64::from(medium.sigma_s_prime[channel]);
        let absorption = f64::from(medium.sigma_a[channel]);
        // A medium that does nothing at all has an infinite mean free path; a very long one behaves the same and stays finite.
        let extinction = (scattering + absorption).max(1e-12);
        let f_dr = fresnel::diffuse_internal_reflectance(f64::from(medium.ior)).clamp(-0.99, 0.99);
        let a = (1.0 + f_dr) / (1.0 - f_dr);
        let z_r = 1.0 / extinction;
        Self {
            half_albedo: 0.5 * scattering / extinction,
            sigma_tr: (3.0 * absorption * extinction).sqrt(),
            z_r,
            z_v: z_r * (1.0 + 4.0 / 3.0 * a),
        }
    }

    fn sum(&self, term: impl Fn(f64) -> f64) -> f64 {
        self.half_albedo * (term(self.z_r) + term(self.z_v))
    }

    /// ∫ R_d over the whole plane.
    pub(crate) fn total(&self) -> f64 {
        self.sum(|z| (-self.sigma_tr * z).exp())
    }

    /// R_d(r)·e^(σ_tr·r), 1/mm²: the part that never underflows.
    pub(crate) fn scaled_reflectance(&self, r: f64) -> f64 {
        self.sum(|z| {
            let d = (r * r + z * z).sqrt();
            z * (1.0 + self.sigma_tr * d) * (-self.sigma_tr * (z * z / (d + r))).exp() / d.powi(3)
        }) / std::f64::consts::TAU
    }

    /// e^(σ_tr·inner) · ∫ R_d 2πρ dρ over the ring from `inner` to `outer`, without cancellation where the ring is thin.
    pub(crate) fn scaled_ring(&self, inner: f64, outer: f64) -> f64 {
        self.sum(|z| {
            let near = (inner * inner + z * z).sqrt();
            let far = (outer * outer + z * z).sqrt();
            let step = (outer * outer - inner * inner) / (near + far);
            let falloff = (-self.sigma_tr * (z * z / (near + inner))).exp();
            z / far * falloff * (step / near - (-self.sigma_tr * step).exp_m1())
        })
    }

    /// ∫ R_d 2πρ dρ from 0 to r.
    pub(crate) fn enclosed(&self, r: f64) -> f64 {
        self.scaled_ring(0.0, r)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn media() -> Vec<Medium> {
        let mut media: Vec<_> = Medium::PRESETS.iter().map(|(_, medium)| *medium).collect();
        for albedo in [0.1_f32, 0.5, 0.9, 0.99, 0.9999, 1.0] {
            for ior in [0.8, 1.0, 1.3, 1.5, 2.0] {
                media.push(Medium { sigma_s_prime: [albedo; 3], sigma_a: [1.0 - albedo; 3], ior });
            }
        }
        media
    }

    /// α'/2·(1 + e^(−4/3·A·s))·e^(−s), s = √(3(1 − α')): the closed form of the plane.
    fn closure(medium: &Medium, channel: usize) -> f64 {
        let (s, a) = (f64::from(medium.sigma_s_prime[channel]), f64::from(medium.sigma_a[channel]));
        let albedo = s / (s + a);
        let f_dr = fresnel::diffuse_internal_reflectance(f64::from(medium.ior));
        let boundary = (1.0 + f_dr) / (1.0 - f_dr);
        let root = (3.0 * (1.0 - albedo)).sqrt();
        0.5 * albedo * (1.0 + (-4.0 / 3.0 * boundary * root).exp()) * (-root).exp()
    }

    fn integrate(dipole: &Dipole, gain: f64) -> f64 {
        // Logarithmic midpoint rule from far below to far above every length of the profile.
        let (low, high, steps) = ((1e-5 * dipole.z_r).ln(), (1e7 * dipole.z_r).ln(), 40_000);
        (0..steps)
            .map(|k| {
                let r = (low + (high - low) * (k as f64 + 0.5) / f64::from(steps)).exp();
                let value = dipole.scaled_reflectance(r) * (-dipole.sigma_tr * r).exp();
                gain * value * std::f64::consts::TAU * r * r * (high - low) / f64::from(steps)
            })
            .sum()
    }

    #[test]
    fn the_plane_closes() {
        for medium in media() {
            for channel in 0..3 {
                let dipole = Dipole::new(&medium, channel);
                let expected = closure(&medium, channel);
                // 1e-5: the midpoint rule's cut-offs; the closed form itself is exact.
                assert!((dipole.total() / expected - 1.0).abs() < 1e-9, "{medium:?}");
                assert!((integrate(&dipole, 1.0) / expected - 1.0).abs() < 1e-5, "{medium:?}");
                assert!(
                    (integrate(&dipole, 1.001) / expected - 1.0).abs() > 1e-5,
                    "a brighter profile must be noticed"
                );
            }
        }
    }

    #[test]
    fn rings_add_up_to_the_plane() {
        for medium in media() {
            let dipole = Dipole::new(&medium, 1);
            for r in [1e-6, 1e-3, 0.1, 1.0, 30.0] {
                let outside = dipole.scaled_ring(r, 1e9) * (-dipole.sigma_tr * r).exp();
                let error = dipole.enclosed(r) + outside - dipole.total();
                // 1e-8: what lies beyond 10⁹ mm without absorption.
                assert!(error.abs() <= 1e-8 * dipole.total(), "{medium:?} at {r}: {error}");
                let thin = dipole.scaled_ring(r, r * (1.0 + 1e-9)) / (std::f64::consts::TAU * r * r * 1e-9);
                assert!((thin / dipole.scaled_reflectance(r) - 1.0).abs() < 1e-6, "{medium:?} at {r}");
            }
        }
    }

    #[test]
    fn nothing_scatters_nothing() {
        let clear = Medium { sigma_s_prime: [0.0; 3], sigma_a: [0.0; 3], ior: 1.3 };
        let dipole = Dipole::new(&clear, 0);
        assert_eq!((dipole.total(), dipole.scaled_reflectance(1.0)), (0.0, 0.0));
    }

    #[test]
    fn an_unknown_profile_lists_the_known() {
        assert!(Profile::named("bipole").unwrap_err().to_string().contains("dipole-normalised"));
    }
}
