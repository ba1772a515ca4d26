//! Radial diffuse reflectance R_d(r): how far light wanders under the surface.

#[cfg(test)]
mod against_twin;
#[cfg(test)]
mod against_walks;
mod albedo;
mod beam;
mod burley;
mod channel;
mod dipole;
mod half_space;
mod hankel;
mod layers;
mod potential;
pub(crate) mod radial;
mod reflectance;
mod sampled;
mod tabulated;
#[cfg(test)]
mod tests;

use crate::layout::TermLayout;
use crate::{Error, Medium, fresnel};
pub use burley::{BurleyFit, BurleyShape};
use channel::Channel;
use dipole::Dipole;
pub use half_space::Entry;
pub use layers::{Layer, Layers};
use potential::Potential;
use radial::Radial;
pub use reflectance::Reflectance;
use std::sync::Arc;
pub use tabulated::Table;

/// One profile for each channel, RGB. Channels of the same coefficients share one.
pub(crate) type Channels = [Arc<dyn Radial>; 3];

/// Length below which every channel is smooth, mm; 10¹⁵ where nothing scatters.
pub(crate) fn smooth_length(channels: &Channels) -> f32 {
    let scattering = channels.iter().filter(|profile| profile.total() > 0.0);
    scattering.map(|profile| profile.smooth_length() as f32).fold(1e15, f32::min)
}

/// Which R_d(r) scatters, and how light leaves towards the eye.
///
/// All are for a flat half-space lit at one point. All but [`Dipole`](Self::Dipole) divide F_t by its hemispherical mean 1 − F_dr,ext on
/// the way to the eye, so that what B says leaves does leave. Figures of accuracy, and which to take when: docs/method.md.
///
/// ```
/// use translume::{Medium, Profile};
///
/// // R_d of skin one millimetre from where light enters, 1/mm².
/// let reflectance = Profile::default().reflectance(&Medium::SKIN1)?;
/// let [red, green, blue] = reflectance.at(1.0);
/// assert!(red > green && green > blue);
/// # Ok::<(), translume::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Profile {
    /// A flat half-space with *all* orders of scattering, tabulated from random walks over r, α' and η (0.6 to 2.5; as there beyond).
    /// Within 2 % of the walks wherever they are, near the entry too, and as bright as they to 0.5 %: what is left is that no body is
    /// flat. Through thin parts lit from behind it is darker than a dipole, and reality brighter than
    /// both. Scattering is isotropic with σ_s'.
    HalfSpace(Entry),
    /// The classical dipole with L_o = F_t·B/π, to the letter of Gong et al. 2008 (eqs. 3–7). It loses 6 % at η = 1.3 and 9 % at
    /// η = 1.5 even on a plane under a uniform sky, because F_t is not normalised over the hemisphere.
    Dipole,
    /// The same dipole (Jensen et al. 2001, eq. 4) with F_t normalised. Right some mean free paths away in media that absorb little; too
    /// bright where they absorb much, too dark near the point of entry. The cheapest to set up.
    DipoleNormalised,
    /// D'Eon 2012, "A Better Dipole": Grosjean's diffusion coefficient, the true Fresnel equations at the boundary (right for η < 1 too),
    /// fluence and flux mixed in the exitance. Right for absorbing media where the classical dipole is not; still one source at one
    /// depth, so too dark within a mean free path. Light scattered once is not in it.
    BetterDipole,
    /// Photon beam diffusion for light along the normal (Habel, Christensen, Jarosz 2013): such dipoles along the whole beam, with their
    /// correction κ near it. The best of the diffusion profiles within a mean free path. Light scattered once is not in it: see
    /// [`WithSingleScattering`](Self::WithSingleScattering).
    PhotonBeam,
    /// One of the three with light scattered once (Habel et al. 2013, normal incidence, isotropic, with Fresnel's share at the exit):
    /// sharp detail and the whole albedo of dark media. In forward-scattering media reality is less bright close by, since σ_s' hides
    /// the phase function.
    WithSingleScattering(Diffusion),
    /// Christensen, Burley 2015, "Approximate Reflectance Profiles for Efficient Subsurface Scattering": fitted to random walks with
    /// *all* orders of scattering at η = 1. Of the closed forms the closest to reality where the surface reflects little
    /// inside; the index of refraction does not change it, which makes it too bright at η of 1.3 and more. A of the surface
    /// comes from α' by Chandrasekhar's exact half-space, along the normal or from all sides as the fit says.
    NormalisedDiffusion(BurleyFit),
    /// Multipoles for a slab or for layers over each other (Donner, Jensen 2005), such as skin over fat. A thick slab is the classical
    /// dipole. Needs layers thicker than some mean free paths for its full accuracy; thinner ones keep energy and limits.
    /// Set up by a Hankel transform, the slowest of all.
    Multipole(Layers),
    /// The classical dipole with its two sources where they are: below and above every texel along its own normal, and the flux that they
    /// send through the receiver's plane leaving. On a plane it is the classical dipole. On smooth convex bodies of little absorption it is far
    /// closer to path tracing (5 to 13 % instead of 18 to 26 % on a sphere); on concave ones and thin ones it is worse, because mirrored sources
    /// land in other parts of the body. Takes twice as long, at texels only.
    DipoleOriented,
    /// Radii and values of the user's own, whatever the medium: measured profiles, or any not listed here.
    Tabulated(Table),
}

/// A profile that leaves out light scattered once.
///
/// ```
/// use translume::{Diffusion, Profile};
///
/// assert_eq!(Profile::named("photon-beam-single")?, Profile::WithSingleScattering(Diffusion::PhotonBeam));
/// # Ok::<(), translume::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Diffusion {
    /// As [`Profile::DipoleNormalised`], dimmed by what left after one scattering.
    Dipole,
    /// As [`Profile::BetterDipole`], dimmed likewise.
    BetterDipole,
    /// As [`Profile::PhotonBeam`], dimmed so that both together give back no more than they got: by 10 % at η = 1, 4 % at 1.3.
    PhotonBeam,
}

impl Default for Profile {
    /// The half-space that knows at which angle light enters.
    fn default() -> Self {
        Self::HalfSpace(Entry::Normal)
    }
}

impl Profile {
    /// Every profile without parameters, with its name. Normalised diffusion is that of diffuse entry unless the name says otherwise.
    pub const NAMES: &[(&'static str, Self)] = &[
        ("half-space", Self::HalfSpace(Entry::Normal)),
        ("half-space-diffuse", Self::HalfSpace(Entry::Diffuse)),
        ("dipole", Self::Dipole),
        ("dipole-normalised", Self::DipoleNormalised),
        ("dipole-oriented", Self::DipoleOriented),
        ("dipole-single", Self::WithSingleScattering(Diffusion::Dipole)),
        ("better-dipole", Self::BetterDipole),
        ("better-dipole-single", Self::WithSingleScattering(Diffusion::BetterDipole)),
        ("photon-beam", Self::PhotonBeam),
        ("photon-beam-single", Self::WithSingleScattering(Diffusion::PhotonBeam)),
        ("normalised-diffusion", Self::NormalisedDiffusion(BurleyFit::Diffuse)),
        ("normalised-diffusion-searchlight", Self::NormalisedDiffusion(BurleyFit::Searchlight)),
    ];

    /// The profile of this name.
    ///
    /// # Errors
    /// [`Error::UnknownProfile`] lists the names there are.
    pub fn named(name: &str) -> Result<Self, Error> {
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, profile)| profile.clone()).ok_or_else(
            || {
                let known = Self::NAMES.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
                Error::UnknownProfile { name: name.to_owned(), known }
            },
        )
    }

    /// Checks what parameters there are.
    ///
    /// # Errors
    /// [`Error::Profile`] names the entry or layer that cannot be, [`Error::Medium`] the coefficient of a layer.
    pub fn validate(&self) -> Result<(), Error> {
        match self {
            Self::Multipole(layers) => layers.validate(),
            Self::Tabulated(table) => table.validate(),
            Self::NormalisedDiffusion(fit) => fit.validate(),
            _ => Ok(()),
        }
    }

    /// What a host's own material multiplies F_t(η, ω_o)·B/π with: 1, or 1/(1 − F_dr,ext). `ior` as in [`Medium::ior`].
    #[must_use]
    pub fn exit_scale(&self, ior: f32) -> f32 {
        match self {
            Self::Dipole => 1.0,
            _ => (1.0 / fresnel::hemispherical_transmittance(f64::from(ior))) as f32,
        }
    }

    /// k of each channel, 0 to below 1, of the gain of entry: the gather counts light whose direction inside has the cosine μ' to the normal
    /// 1/(1 − k (1 − μ')) times, for what enters aslant starts less deep and more of it returns. 0 for all but [`HalfSpace`](Self::HalfSpace) of
    /// [`Entry::Normal`]. A host that gives [`Lighting::Irradiance`](crate::Lighting::Irradiance) may count its light so, or as if all came along
    /// the normal.
    #[must_use]
    pub fn slant(&self, medium: &Medium) -> [f32; 3] {
        match self {
            Self::HalfSpace(Entry::Normal) => {
                Channel::of(medium).map(|channel| albedo::slant(&channel) as f32)
            }
            _ => [0.0; 3],
        }
    }

    /// Whether both scatter the same and differ in how light leaves at most.
    pub(crate) fn scatters_like(&self, other: &Self) -> bool {
        let classical = |profile: &Self| matches!(profile, Self::Dipole | Self::DipoleNormalised);
        self == other || classical(self) && classical(other)
    }

    /// Whether its sources lie off the surface.
    pub(crate) fn is_oriented(&self) -> bool {
        *self == Self::DipoleOriented
    }

    /// Where the sources of such a profile lie, and what they count.
    pub(crate) fn terms(&self, medium: &Medium) -> [TermLayout; 2] {
        if !self.is_oriented() {
            return [TermLayout::default(); 2];
        }
        let channels = Channel::of(medium);
        let term = |sign: f64, depth: &dyn Fn(&Channel) -> f64| TermLayout {
            depth: [0, 1, 2].map(|k| depth(&channels[k]) as f32),
            weight: [0, 1, 2].map(|k| (sign * channels[k].albedo()) as f32),
            ..TermLayout::default()
        };
        let real = |channel: &Channel| 1.0 / channel.extinction();
        let height = |channel: &Channel| -Dipole::classical(channel).height();
        [term(1.0, &real), term(-1.0, &height)]
    }

    /// R_d of each channel of a medium, or the potential about a source that lies off the surface. Channels alike are made once.
    pub(crate) fn channels(&self, medium: &Medium) -> Channels {
        let channels = Channel::of(medium);
        let red = self.radial(medium, &channels[0], 0);
        let alike = |a: usize, b: usize| channels[a] == channels[b] && self.is_grey(a, b);
        let green = if alike(0, 1) { Arc::clone(&red) } else { self.radial(medium, &channels[1], 1) };
        let blue = match () {
            () if alike(0, 2) => Arc::clone(&red),
            () if alike(1, 2) => Arc::clone(&green),
            () => self.radial(medium, &channels[2], 2),
        };
        [red, green, blue]
    }

    /// Whether the profile's own parameters are the same in two channels.
    fn is_grey(&self, a: usize, b: usize) -> bool {
        match self {
            Self::NormalisedDiffusion(BurleyFit::DiffuseMeanFreePath(lengths)) => lengths[a] == lengths[b],
            Self::Multipole(layers) => layers.below.iter().all(|layer| {
                let channels = Channel::of(&layer.medium);
                channels[a] == channels[b]
            }),
            Self::Tabulated(table) => table.values.iter().all(|value| value[a] == value[b]),
            _ => true,
        }
    }

    fn radial(&self, medium: &Medium, channel: &Channel, index: usize) -> Arc<dyn Radial> {
        if self.is_black(channel, index) {
            return Arc::new(Dipole::classical(&Channel { scattering: 0.0, ..*channel }));
        }
        match self {
            Self::HalfSpace(entry) => Arc::new(half_space::half_space(channel, *entry)),
            Self::Dipole | Self::DipoleNormalised => Arc::new(Dipole::classical(channel)),
            Self::DipoleOriented => Arc::new(Potential::new(channel)),
            Self::BetterDipole => Arc::new(Dipole::better(channel)),
            Self::PhotonBeam => Arc::new(beam::beam(channel)),
            Self::WithSingleScattering(diffusion) => Arc::new(match diffusion {
                Diffusion::Dipole => beam::dipole_with_single(channel, &Dipole::classical(channel)),
                Diffusion::BetterDipole => beam::dipole_with_single(channel, &Dipole::better(channel)),
                Diffusion::PhotonBeam => beam::beam_with_single(channel),
            }),
            Self::NormalisedDiffusion(fit) => Arc::new(burley::Burley::new(channel, *fit, index)),
            Self::Multipole(layers) => Arc::new(layers::reflectance(layers, medium, index)),
            Self::Tabulated(table) => Arc::new(tabulated::PowerLaws::new(table, index)),
        }
    }

    /// Whether nothing comes back in this channel.
    fn is_black(&self, channel: &Channel, index: usize) -> bool {
        match self {
            Self::Tabulated(table) => table.values.iter().all(|value| value[index] == 0.0),
            Self::Multipole(layers) => {
                channel.scattering == 0.0
                    && layers.below.iter().all(|layer| layer.medium.sigma_s_prime[index] == 0.0)
            }
            _ => channel.scattering == 0.0,
        }
    }
}
