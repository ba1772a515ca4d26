//! Every profile against the reference's, which gets R_d by other formulas or adaptive quadrature and its integrals by splines.

use super::*;
use translume_reference::profile as twin;
use translume_reference::profile::{Channel as TwinChannel, Entry, Numeric, Profile as _, Sheet};

fn channel(medium: &Medium) -> TwinChannel {
    let [sigma_s_prime, sigma_a] = [medium.sigma_s_prime[0], medium.sigma_a[0]].map(f64::from);
    TwinChannel { sigma_s_prime, sigma_a, ior: medium.ior.into() }
}

/// Largest relative difference of R_d, of what is enclosed and of the total, from a hundredth of a mean free path to ten.
fn difference(profile: &Profile, medium: &Medium, twin: &Numeric) -> f64 {
    let radial = &profile.channels(medium)[0];
    let mean_free_path = 1.0 / channel(medium).sigma_t();
    let mut worst = (radial.total() / twin.total() - 1.0).abs();
    for r in [0.01, 0.05, 0.2, 0.77, 2.0, 5.0, 10.0].map(|r| r * mean_free_path) {
        let value = radial.scaled_reflectance(r) * (-radial.decay() * r).exp();
        worst = worst.max((value / twin.reflectance(r) - 1.0).abs());
        worst = worst.max((radial.enclosed(r) / twin.enclosed(r) - 1.0).abs());
        let ring = radial.scaled_ring(r, r.hypot(0.3 * r)) * (-radial.decay() * r).exp();
        worst = worst.max((ring / twin.ring(r, 0.3 * r) - 1.0).abs());
    }
    worst
}

fn media() -> [Medium; 4] {
    let grey = |s: f32, a: f32, ior: f32| Medium { sigma_s_prime: [s; 3], sigma_a: [a; 3], ior, g: 0.0 };
    [grey(1.09, 0.013, 1.3), grey(0.5, 0.5, 1.5), grey(0.9, 0.1, 0.8), grey(30.0, 0.0, 1.0)]
}

/// The same of the medium and of one with 2 % more absorption and scattering.
fn follows(profile: &Profile, tolerance: f64, twin: impl Fn(&TwinChannel) -> Numeric) {
    for medium in media() {
        let same = channel(&medium);
        let found = difference(profile, &medium, &twin(&same));
        assert!(found < tolerance, "{profile:?} {medium:?}: {found:e}");
        let other = TwinChannel { sigma_s_prime: 1.02 * same.sigma_s_prime, ..same };
        let noticed = difference(profile, &medium, &twin(&other));
        assert!(noticed > tolerance, "{profile:?} {medium:?}: 2 % of σ_s' must be noticed, {noticed:e}");
    }
}

/// Fresnel moments by 2048 midpoints and by adaptive quadrature.
#[test]
fn better_dipole() {
    follows(&Profile::BetterDipole, 1e-5, twin::better_dipole);
}

/// 64 nodes along the beam, and cubic interpolation.
#[test]
fn photon_beam() {
    follows(&Profile::PhotonBeam, 2e-4, twin::photon_beam);
}

#[test]
fn single_scattering() {
    let white =
        |channel: &TwinChannel| TwinChannel { sigma_s_prime: channel.sigma_t(), sigma_a: 0.0, ..*channel };
    follows(&Profile::WithSingleScattering(Diffusion::PhotonBeam), 2e-4, |channel| {
        let total = twin::photon_beam(&white(channel)).total();
        twin::with_single(channel, &twin::photon_beam(channel), total)
    });
    follows(&Profile::WithSingleScattering(Diffusion::BetterDipole), 2e-4, |channel| {
        twin::with_single(channel, &twin::better_dipole(channel), 1.0)
    });
    follows(&Profile::WithSingleScattering(Diffusion::Dipole), 2e-4, |channel| {
        let TwinChannel { sigma_s_prime, sigma_a, ior } = *channel;
        let dipole = translume_reference::Dipole::new(sigma_s_prime, sigma_a, ior);
        twin::with_single(channel, &dipole, 1.0)
    });
}

/// Albedo from a Gauss rule and from the closed form of H.
#[test]
fn normalised_diffusion() {
    let fit = |fit| Profile::NormalisedDiffusion(fit);
    follows(&fit(BurleyFit::Searchlight), 1e-4, |c| twin::normalised_diffusion(c, Entry::Normal, None));
    follows(&fit(BurleyFit::Diffuse), 1e-4, |c| twin::normalised_diffusion(c, Entry::Diffuse, None));
    // The albedo alone depends on the medium here, and without absorption it is 1 whatever the scattering.
    let by_hand = fit(BurleyFit::DiffuseMeanFreePath([0.7; 3]));
    for medium in &media()[..3] {
        let twin = |dmfp| twin::normalised_diffusion(&channel(medium), Entry::Diffuse, Some(dmfp));
        let [same, other] = [f64::from(0.7_f32), 0.71].map(|dmfp| difference(&by_hand, medium, &twin(dmfp)));
        assert!(same < 1e-4 && other > 1e-4, "{medium:?}: {same:e} {other:e}");
    }
}

#[test]
fn layers_over_each_other() {
    let [top, middle, bottom] = [media()[0], media()[1], media()[2]];
    let layer = |medium: Medium, thickness_mm: f32| Layer { medium, thickness_mm };
    for (thickness_mm, below) in [
        (2.0, vec![]),
        (0.4, vec![layer(bottom, f32::INFINITY)]),
        (0.6, vec![layer(middle, 0.5), layer(bottom, 3.0)]),
    ] {
        let profile = Profile::Multipole(Layers { thickness_mm, below: below.clone().into() });
        let twin = |gain: f64| {
            let all = std::iter::once(layer(top, thickness_mm)).chain(below.iter().copied());
            let sheet =
                |l: Layer| Sheet { channel: channel(&l.medium), thickness: gain * f64::from(l.thickness_mm) };
            twin::stack(&all.map(sheet).collect::<Vec<_>>(), [3e-3, 5.0], 0.1)
        };
        let radial = &profile.channels(&top)[0];
        let error = |twin: &Numeric| {
            let at = |r: f64| {
                radial.scaled_reflectance(r) * (-radial.decay() * r).exp() / twin.reflectance(r) - 1.0
            };
            let ring = |r: f64| radial.enclosed(r) / twin.enclosed(r) - 1.0;
            let radii = [0.01, 0.1, 0.3, 1.0, 2.0, 4.0];
            radii.iter().map(|&r| at(r).abs().max(ring(r).abs())).fold(0.0, f64::max)
        };
        // Ogata's rule and the interpolations. Measured 2e-4.
        assert!(error(&twin(1.0)) < 3e-4, "{below:?}: {:e}", error(&twin(1.0)));
        assert!(error(&twin(1.02)) > 1e-3, "{below:?}: 2 % of thickness must be noticed");
    }
}

#[test]
fn tables() {
    let radii = [0.02_f32, 0.1, 0.4, 1.0, 3.0, 8.0];
    let values = [1.0_f32, 0.6, 0.15, 0.035, 0.001, 1e-5];
    let table = Table { radii: radii.into(), values: values.map(|v| [v; 3]).into() };
    let twin = |gain: f64| twin::table(&radii.map(f64::from), &values.map(f64::from).map(|v| v.powf(gain)));
    let profile = Profile::Tabulated(table);
    let found = difference(&profile, &media()[0], &twin(1.0));
    // The twin's spline rounds the kinks off.
    assert!(found < 0.02, "{found:e}");
    assert!(difference(&profile, &media()[0], &twin(1.03)) > 0.02, "steeper values must be noticed");
}
