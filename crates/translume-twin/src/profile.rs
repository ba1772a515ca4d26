//! Media and profiles.

use translume::{BurleyFit, Diffusion, Layer, Medium, Profile};
use translume_reference::profile::{self, Channel, Entry, Numeric, Profile as _, Sheet};
use translume_reference::{Boundary, Dipole};

/// The same coefficients.
#[must_use]
pub fn medium(medium: &Medium) -> translume_reference::Medium {
    translume_reference::Medium {
        sigma_s_prime: medium.sigma_s_prime.map(f64::from),
        sigma_a: medium.sigma_a.map(f64::from),
        ior: medium.ior.into(),
    }
}

/// How light enters: with the profile's own gain, which random walks judge.
#[must_use]
pub fn boundary(profile: &Profile, medium: &Medium) -> Boundary {
    Boundary { ior: medium.ior.into(), slant: profile.slant(medium).map(f64::from) }
}

/// The dipole of each channel.
#[must_use]
pub fn dipoles(medium: &Medium) -> [Dipole; 3] {
    self::medium(medium).dipoles()
}

/// Any profile of each channel, by the twin's own quadrature.
/// `None` for a kind that the reference does not know.
#[must_use]
pub fn profiles(profile: &Profile, medium: &Medium) -> Option<[Numeric; 3]> {
    let [red, green, blue] = [0, 1, 2].map(|channel| numeric(profile, medium, channel));
    Some([red?, green?, blue?])
}

/// For each channel: their totals are then known to some 0.3 %.
const WALKS: u64 = 100_000;

fn channel(medium: &Medium, index: usize) -> Channel {
    let [sigma_s_prime, sigma_a] = [medium.sigma_s_prime[index], medium.sigma_a[index]].map(f64::from);
    Channel { sigma_s_prime, sigma_a, ior: medium.ior.into() }
}

fn numeric(kind: &Profile, medium: &Medium, index: usize) -> Option<Numeric> {
    let colour = channel(medium, index);
    let white = Channel { sigma_s_prime: colour.sigma_t(), sigma_a: 0.0, ..colour };
    let dipole = dipoles(medium)[index];
    Some(match kind {
        Profile::Dipole | Profile::DipoleNormalised => {
            let z = dipole.z[0];
            Numeric::new(|r| dipole.reflectance(r), dipole.sigma_tr, z, [1e-4 * z, 1e4 * z])
        }
        Profile::HalfSpace(entry) => {
            let way = if *entry == translume::Entry::Normal { Entry::Normal } else { Entry::Diffuse };
            profile::half_space(&colour, way, &profile::walks(&colour, way, WALKS).finish())
        }
        Profile::BetterDipole => profile::better_dipole(&colour),
        Profile::PhotonBeam => profile::photon_beam(&colour),
        Profile::WithSingleScattering(Diffusion::Dipole) => profile::with_single(&colour, &dipole, 1.0),
        Profile::WithSingleScattering(Diffusion::BetterDipole) => {
            profile::with_single(&colour, &profile::better_dipole(&colour), 1.0)
        }
        Profile::WithSingleScattering(Diffusion::PhotonBeam) => {
            let total = profile::photon_beam(&white).total();
            profile::with_single(&colour, &profile::photon_beam(&colour), total)
        }
        Profile::NormalisedDiffusion(fit) => {
            let entry = if *fit == BurleyFit::Searchlight { Entry::Normal } else { Entry::Diffuse };
            let length = match fit {
                BurleyFit::DiffuseMeanFreePath(lengths) => Some(f64::from(lengths[index])),
                _ => None,
            };
            profile::normalised_diffusion(&colour, entry, length)
        }
        Profile::Multipole(layers) => {
            let top = Layer { medium: *medium, thickness_mm: layers.thickness_mm };
            let sheet = |layer: &Layer| Sheet {
                channel: channel(&layer.medium, index),
                thickness: layer.thickness_mm.into(),
            };
            let sheets: Vec<_> = std::iter::once(&top).chain(layers.below.iter()).map(sheet).collect();
            profile::stack(&sheets, [3e-3, 15.0], 0.1)
        }
        Profile::Tabulated(table) => {
            let radii: Vec<f64> = table.radii.iter().map(|&r| r.into()).collect();
            let values: Vec<f64> = table.values.iter().map(|v| v[index].into()).collect();
            profile::table(&radii, &values)
        }
        _ => return None,
    })
}
