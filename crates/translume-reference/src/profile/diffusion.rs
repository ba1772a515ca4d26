//! The better dipole and normalised diffusion.

use std::f64::consts::{FRAC_PI_2, PI};

use super::{Channel, Numeric};
use crate::fresnel::transmittance;
use crate::quadrature::integrate;

/// Grosjean's D, mm, and σ_tr, 1/mm.
pub(super) fn grosjean(channel: &Channel) -> (f64, f64) {
    let sigma_t = channel.sigma_t();
    let diffusion = (2.0 * channel.sigma_a + channel.sigma_s_prime) / (3.0 * sigma_t * sigma_t);
    (diffusion, (channel.sigma_a / diffusion).sqrt())
}

/// C₁ and C₂: ∫ F_r cosⁿ sin dθ from inside, straight from the angle.
fn fresnel_moments(ior: f64) -> [f64; 2] {
    [1, 2].map(|n| {
        let reflected =
            |angle: f64| (1.0 - transmittance(1.0 / ior, angle.cos())) * angle.cos().powi(n) * angle.sin();
        let critical = if ior > 1.0 { (1.0 / ior).asin() } else { FRAC_PI_2 };
        // Beyond the critical angle all is reflected; below it 1 − x² takes the root's end away.
        let near =
            integrate(|x: f64| reflected(critical * (1.0 - x * x)) * 2.0 * x * critical, 0.0, 1.0, 1e-11);
        near + integrate(reflected, critical, FRAC_PI_2, 1e-11)
    })
}

/// Exitance from a point source of unit power at a depth: C_φ φ + C_E (−D ∂φ/∂n), with φ of the source and its mirror image.
pub(super) fn point_source(channel: &Channel) -> impl Fn(f64, f64) -> f64 + use<> {
    let (diffusion, sigma_tr) = grosjean(channel);
    let [c1, c2] = fresnel_moments(channel.ior);
    let mirror = 4.0 * diffusion * (1.0 + 3.0 * c2) / (1.0 - 2.0 * c1);
    move |r, depth| {
        let fluence = |z: f64| {
            let d = r.hypot(z);
            (-sigma_tr * d).exp() / (4.0 * PI * diffusion * d)
        };
        let flux = |z: f64| {
            let d = r.hypot(z);
            z * (1.0 + sigma_tr * d) * (-sigma_tr * d).exp() / (4.0 * PI * d.powi(3))
        };
        let virtual_depth = depth + mirror;
        0.25 * (1.0 - 2.0 * c1) * (fluence(depth) - fluence(virtual_depth))
            + 0.5 * (1.0 - 3.0 * c2) * (flux(depth) + flux(virtual_depth))
    }
}

/// d'Eon 2012, "A Better Dipole".
#[must_use]
pub fn better_dipole(channel: &Channel) -> Numeric {
    let source = point_source(channel);
    let mean_free_path = 1.0 / channel.sigma_t();
    let reflectance = |r: f64| channel.albedo().powi(2) * source(r, mean_free_path);
    let range = [1e-4, 1e4].map(|x| x * mean_free_path);
    Numeric::new(reflectance, grosjean(channel).1, mean_free_path, range)
}

/// From where light enters the half-space that normalised diffusion was fitted to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// Along the normal.
    Normal,
    /// From all sides.
    Diffuse,
}

/// Albedo of an index-matched half-space of isotropic scattering, from the closed form of ln H (Chandrasekhar 1950; Fock 1944).
#[must_use]
pub fn half_space_albedo(single: f64, entry: Entry) -> f64 {
    let h = |mu: f64| {
        let exponent = |angle: f64| {
            let cotangent = if angle < 1e-8 { 1.0 } else { angle / angle.tan() };
            (1.0 - single * cotangent).max(1e-300).ln() / (angle.cos().powi(2) + (mu * angle.sin()).powi(2))
        };
        // The logarithm has an end at angle 0 where nothing is absorbed.
        let integral = integrate(|x: f64| exponent(FRAC_PI_2 * x * x) * PI * x, 0.0, 1.0, 1e-10);
        (-mu / PI * integral).exp()
    };
    let root = (1.0 - single).sqrt();
    match entry {
        Entry::Normal => 1.0 - root * h(1.0),
        Entry::Diffuse => 1.0 - root * integrate(|mu| 2.0 * mu * h(mu), 0.0, 1.0, 1e-9),
    }
}

/// Christensen, Burley 2015, eqs. 3 and 5 or 6. `dmfp`: diffuse mean free path, mm, in place of the medium's own length (eqs. 7, 8).
#[must_use]
pub fn normalised_diffusion(channel: &Channel, entry: Entry, dmfp: Option<f64>) -> Numeric {
    let a = half_space_albedo(channel.albedo(), entry);
    let scaling = match (entry, dmfp) {
        (_, Some(_)) => 3.5 + 100.0 * (a - 0.33).powi(4),
        (Entry::Normal, None) => 1.85 - a + 7.0 * (a - 0.8).abs().powi(3),
        (Entry::Diffuse, None) => 1.9 - a + 3.5 * (a - 0.8).powi(2),
    };
    let length = dmfp.unwrap_or(1.0 / channel.sigma_t());
    let reflectance = |r: f64| {
        let x = scaling * r / length;
        a * scaling * ((-x).exp() + (-x / 3.0).exp()) / (8.0 * PI * length * r)
    };
    Numeric::new(reflectance, scaling / (3.0 * length), 0.0, [1e-6 * length, 1e2 * length])
}
