//! What holds for every profile.

use super::*;
use std::f64::consts::{LN_2, TAU};
use std::sync::LazyLock;

fn fat() -> Medium {
    Medium { sigma_s_prime: [1.2, 1.1, 1.0], sigma_a: [0.002, 0.004, 0.01], ior: 1.4, g: 0.0 }
}

fn layers(thickness_mm: f32, below: &[Layer]) -> Profile {
    Profile::Multipole(Layers { thickness_mm, below: below.into() })
}

fn table() -> Profile {
    let radii = [0.02, 0.1, 0.4, 1.0, 3.0, 8.0];
    let values = radii.map(|r: f32| [1.0, 0.6, 0.3].map(|width: f32| 0.1 * (-r / width).exp() / (r + 0.05)));
    Profile::Tabulated(Table { radii: radii.into(), values: values.into() })
}

/// Every profile, with something for each parameter.
fn profiles() -> Vec<Profile> {
    let mut all: Vec<_> =
        Profile::NAMES.iter().map(|(_, profile)| profile.clone()).filter(|p| !p.is_oriented()).collect();
    all.push(Profile::NormalisedDiffusion(BurleyFit::DiffuseMeanFreePath([0.5, 1.0, 8.0])));
    all.extend([
        layers(0.3, &[]),
        layers(f32::INFINITY, &[]),
        layers(1.0, &[Layer { medium: fat(), thickness_mm: f32::INFINITY }]),
        layers(
            0.05,
            &[Layer { medium: Medium::SKIN1, thickness_mm: 2.0 }, Layer { medium: fat(), thickness_mm: 6.0 }],
        ),
        table(),
    ]);
    all
}

/// α' of {0.1, …, 1} at every index of refraction; three albedos to a medium.
fn media() -> Vec<Medium> {
    let albedos = [[0.1_f32, 0.5, 0.9], [0.99, 0.9999, 1.0]];
    let with = |ior: f32| {
        albedos.map(|albedo| Medium { sigma_s_prime: albedo, sigma_a: albedo.map(|a| 1.0 - a), ior, g: 0.0 })
    };
    [0.8, 1.0, 1.3, 1.5, 2.0].into_iter().flat_map(with).collect()
}

/// Every profile of every medium, made once for all tests.
static ALL: LazyLock<Vec<(String, Arc<dyn Radial>)>> = LazyLock::new(|| {
    let mut all = Vec::new();
    for profile in profiles() {
        for medium in media() {
            for (channel, radial) in profile.channels(&medium).into_iter().enumerate() {
                let albedo = medium.sigma_s_prime[channel];
                all.push((format!("{profile:?}, α' {albedo}, η {}", medium.ior), radial));
            }
        }
    }
    all
});

fn each(test: impl Fn(&dyn Radial, &str)) {
    ALL.iter().for_each(|(name, radial)| test(&**radial, name));
}

fn value(radial: &dyn Radial, r: f64) -> f64 {
    radial.scaled_reflectance(r) * (-radial.decay() * r).exp()
}

/// Midpoint rule over ln r from far below to far above every length.
fn integrate(radial: &dyn Radial, gain: f64) -> f64 {
    let (low, high, steps) = (1e-6_f64.ln(), 1e8_f64.ln(), 6000);
    let width = (high - low) / f64::from(steps);
    let ring = |k: i32| {
        let r = (low + width * (f64::from(k) + 0.5)).exp();
        gain * value(radial, r) * TAU * r * r * width
    };
    (0..steps).map(ring).sum()
}

#[test]
fn the_plane_returns_the_total() {
    each(|radial, name| {
        // 2e-5: the midpoint rule at the kinks of tables and at its cut-offs; without absorption 1e-6 of the light is beyond 10⁶ mm.
        let error = integrate(radial, 1.0) / radial.total() - 1.0;
        assert!(error.abs() < 2e-5, "{name}: {error}");
        let bright = integrate(radial, 1.001) / radial.total() - 1.0;
        assert!(bright.abs() > 2e-5, "{name}: a brighter profile must be noticed");
    });
}

#[test]
fn nothing_gives_back_more_than_it_got() {
    each(|radial, name| {
        // Rounding, and the 2e-6 that sampling loses or gains.
        assert!((0.0..=1.0 + 1e-5).contains(&radial.total()), "{name}: {}", radial.total());
    });
    // A table of twice the energy is such a sibling: it is refused.
    let Profile::Tabulated(mut table) = table() else { panic!("a table") };
    table.values = table.values.iter().map(|v| v.map(|x| 20.0 * x)).collect();
    let message = Profile::Tabulated(table).validate().unwrap_err().to_string();
    assert!(message.contains("gives back") && message.contains("red"), "{message}");
}

#[test]
fn rings_add_up_to_the_plane() {
    each(|radial, name| {
        for r in [1e-6, 1e-3, 0.1, 1.0, 30.0] {
            let outside = radial.scaled_ring(r, 1e12) * (-radial.decay() * r).exp();
            let error = (radial.enclosed(r) + outside) / radial.total() - 1.0;
            // What lies beyond 10¹² mm without absorption.
            assert!(error.abs() <= 1e-8, "{name} at {r}: {error}");
            let thin = radial.scaled_ring(r, r * (1.0 + 1e-9)) / (TAU * r * r * 1e-9);
            // Rounding of so narrow a ring.
            assert!((thin / radial.scaled_reflectance(r) - 1.0).abs() < 1e-6, "{name} at {r}: {thin}");
            assert!((1.001 * thin / radial.scaled_reflectance(r) - 1.0).abs() > 1e-6, "{name}");
            let parts = radial.enclosed(r) + radial.scaled_ring(r, 2.0 * r) * (-radial.decay() * r).exp();
            assert!((parts / radial.enclosed(2.0 * r) - 1.0).abs() < 1e-6, "{name} at {r}");
        }
    });
}

/// Coefficients from 10⁻⁶ to 10⁶ 1/mm, none at all, one of the two: every texel of the table is a number.
#[test]
fn hard_media_stay_finite() {
    use crate::kernel_table::{KernelRange, KernelTableLayout, build};
    let layout = KernelTableLayout::new(KernelRange { least_spread: 0.5, longest: 20.0 });
    let mut media = vec![(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
    media.extend([1e-6, 1e-3, 1e3, 1e6].map(|scale| (scale, 0.1 * scale)));
    for (scattering, absorption) in media {
        for profile in profiles() {
            let medium =
                Medium { sigma_s_prime: [scattering; 3], sigma_a: [absorption; 3], ior: 1.3, g: 0.0 };
            let channels = profile.channels(&medium);
            assert!(Arc::ptr_eq(&channels[0], &channels[2]) || !profile.is_grey(0, 2));
            let texels = build(layout, &channels);
            assert!(
                texels.iter().flatten().all(|ln| ln.is_finite() && *ln >= -80.0),
                "{profile:?} {scattering} {absorption}"
            );
        }
    }
}

/// d'Eon's total in closed form, α'²/2·e^(−√(3(1 − α')/(2 − α')))·(C_E(1 + x) + C_φ/(σ_tr D)·(1 − x)), x = e^(−4A√((1 − α')(2 − α')/3)…).
#[test]
fn the_better_dipole_has_its_published_total() {
    for medium in media() {
        let radials = Profile::BetterDipole.channels(&medium);
        for (channel, radial) in Channel::of(&medium).iter().zip(&radials) {
            let albedo = channel.albedo();
            let [open, open_flux] = [1, 2].map(|n| fresnel::transmitted_moment(1.0 / channel.ior, n));
            let boundary = (2.0 - open_flux) / open;
            let depth = (3.0 * (1.0 - albedo) / (2.0 - albedo)).sqrt();
            let root = ((1.0 - albedo) * (2.0 - albedo) / 3.0).sqrt().max(1e-9);
            let x = (-4.0 * boundary * root).exp();
            let mix = 0.5 * open_flux * (1.0 + x) + 0.25 * open / root * (1.0 - x);
            let expected = 0.5 * albedo * albedo * (-depth).exp() * mix;
            // Rounding of 1 − x where nothing is absorbed.
            assert!((radial.total() / expected - 1.0).abs() < 1e-6, "{channel:?}: {expected}");
            let once = expected / albedo;
            assert!(albedo > 0.9999 || (radial.total() / once - 1.0).abs() > 1e-6, "one α' is not two");
        }
    }
}

/// Without internal reflection (1 − ln 2)/2 of α' leaves after one scattering.
#[test]
fn single_scattering_has_its_closed_form() {
    for albedo in [0.01, 0.2, 0.9] {
        let medium = Medium { sigma_s_prime: [albedo; 3], sigma_a: [1.0 - albedo; 3], ior: 1.0, g: 0.0 };
        let [with, without] = [Profile::WithSingleScattering(Diffusion::Dipole), Profile::Dipole]
            .map(|profile| profile.channels(&medium)[0].total());
        let share = 0.5 * (1.0 - LN_2);
        let expected = share * f64::from(albedo) + (1.0 - share) * without;
        // Sampling.
        assert!((with / expected - 1.0).abs() < 1e-5, "{albedo}: {with} {expected}");
        assert!(
            (with / (without + share * f64::from(albedo)) - 1.0).abs() > 1e-5,
            "the dipole keeps the rest"
        );
    }
}

#[test]
fn interpolation_follows_the_profile() {
    let channel = Channel { scattering: 1.0, absorption: 0.05, ior: 1.3 };
    let shape = sampled::Shape { decay: 0.2, smooth_length: 1.0, range: [1e-3, 1e2] };
    let dipole = Dipole::better(&channel);
    let excess = dipole.decay() - shape.decay;
    let sampled = sampled::Sampled::new(&shape, |r| dipole.scaled_reflectance(r) * (-excess * r).exp());
    let worst = (0..500)
        .map(|k| 1.1e-3 * 1.023_f64.powi(k))
        .map(|r| (value(&sampled, r) / value(&dipole, r) - 1.0).abs())
        .fold(0.0, f64::max);
    assert!(worst < 1e-4, "{worst}");
    for (inner, outer) in [(0.0, 0.3), (0.1, 0.11), (0.3, 4.0), (5.0, 5.0001), (3.0, 60.0)] {
        let exact = dipole.scaled_ring(inner, outer) * (-excess * inner).exp();
        let error = sampled.scaled_ring(inner, outer) / exact - 1.0;
        assert!(error.abs() < 1e-4, "{inner} {outer}: {error}");
    }
}

/// A slab of many mean free paths is the classical dipole; a thin one is not.
#[test]
fn a_thick_slab_is_the_dipole() {
    let error = |thickness: f32, medium: &Medium| {
        let slab = layers(thickness, &[]).channels(medium);
        let dipole = Profile::Dipole.channels(medium);
        let at = |k: usize, r: f64| (value(&*slab[k], r) / value(&*dipole[k], r) - 1.0).abs();
        let within = [0.01, 0.1, 0.5, 1.0, 2.0, 5.0];
        (0..3).flat_map(|k| within.map(|r| at(k, r))).fold(0.0, f64::max)
    };
    for medium in [Medium::SKIN1, Medium::KETCHUP, Medium::SPECTRALON] {
        assert!(error(f32::INFINITY, &medium) < 1e-4, "{medium:?}: {}", error(f32::INFINITY, &medium));
    }
    // In red, with 1/σ_tr of 3.7 mm, the least.
    assert!(error(60.0, &Medium::SKIN1) < 1e-4, "{}", error(60.0, &Medium::SKIN1));
    assert!(error(1.0, &Medium::SKIN1) > 0.1);
}

/// Layers of the same medium and of nothing: the stack loses no energy without absorption, and nothing between is nothing.
#[test]
fn layers_keep_energy() {
    let clear = Medium { sigma_s_prime: [0.0; 3], sigma_a: [0.0; 3], ior: 1.3, g: 0.0 };
    let white = Medium { sigma_s_prime: [1.0, 3.0, 10.0], sigma_a: [0.0; 3], ior: 1.3, g: 0.0 };
    let half_space = [Layer { medium: white, thickness_mm: f32::INFINITY }];
    for radial in layers(0.7, &half_space).channels(&white) {
        // What the tail beyond the samples holds is only extrapolated.
        assert!((radial.total() - 1.0).abs() < 2e-4, "{}", radial.total());
    }
    let [over, bare] =
        [layers(0.7, &half_space).channels(&clear), layers(f32::INFINITY, &[]).channels(&white)];
    for (over, bare) in over.iter().zip(&bare) {
        // A half-space under a window of its own index is one whose inner boundary is open instead of sealed.
        assert!(over.total() > 0.99 && value(&**over, 0.01) / value(&**bare, 0.01) > 1.0);
    }
    let refused = layers(f32::INFINITY, &half_space).validate().unwrap_err().to_string();
    assert!(refused.contains("layer 0") && refused.contains("infinite"), "{refused}");
    assert!(layers(0.0, &half_space).validate().is_err() && layers(f32::NAN, &[]).validate().is_err());
}

/// Integrated over the plane, what leaves below and what leaves above are what entered.
#[test]
fn a_white_slab_passes_what_it_does_not_return() {
    let white = Medium { sigma_s_prime: [1.0; 3], sigma_a: [0.0; 3], ior: 1.3, g: 0.0 };
    let slab = Layers { thickness_mm: 2.0, below: Arc::new([]) };
    let returned = Profile::Multipole(slab.clone()).channels(&white)[0].total();
    let through: f64 = (0..400)
        .map(|k| 0.1 * (f64::from(k) + 0.5))
        .map(|r| f64::from(slab.transmittance(&white, r as f32).unwrap()[0]) * TAU * r * 0.1)
        .sum();
    let unscattered = (-2.0_f64).exp();
    // The sum over rings of 0.1 mm; without what went through unscattered 14 % would be missing.
    assert!((returned + through + unscattered - 1.0).abs() < 1e-3, "{returned} {through}");
    assert!((returned + through - 1.0).abs() > 1e-3);
    assert!(slab.transmittance(&Medium { ior: 0.0, ..white }, 1.0).is_err());
}

#[test]
fn impossible_tables_are_named() {
    let refused = |radii: &[f32], values: &[f32]| {
        let values: Vec<[f32; 3]> = values.iter().map(|&v| [0.001, v, 0.001]).collect();
        let mut values = values;
        if let Some(last) = values.last_mut() {
            (last[0], last[2]) = (0.0005, 0.0005);
        }
        let table = Table { radii: radii.into(), values: values.into() };
        Profile::Tabulated(table).validate().map_err(|error| error.to_string())
    };
    assert!(refused(&[1.0, 2.0], &[0.02, 0.01]).is_ok());
    for (radii, values, word) in [
        (&[1.0, 2.0][..], &[0.02][..], "as many values"),
        (&[1.0], &[0.02], "at least two"),
        (&[2.0, 1.0], &[0.02, 0.01], "radius 1"),
        (&[0.0, 1.0], &[0.02, 0.01], "radius 0"),
        (&[1.0, f32::INFINITY], &[0.02, 0.01], "radius 1"),
        (&[1.0, 2.0], &[0.02, -0.01], "entry 1"),
        (&[1.0, 2.0], &[f32::NAN, 0.01], "green"),
        (&[1.0, 2.0], &[0.01, 0.01], "does not fall"),
    ] {
        let message = refused(radii, values).unwrap_err();
        assert!(message.contains(word), "{radii:?} {values:?}: {message}");
    }
    let lengths = BurleyFit::DiffuseMeanFreePath([1.0, 0.0, 1.0]);
    let message = Profile::NormalisedDiffusion(lengths).validate().unwrap_err().to_string();
    assert!(message.contains("green"), "{message}");
}

#[test]
fn every_name_leads_to_its_profile() {
    for (name, profile) in Profile::NAMES {
        assert_eq!(Profile::named(name).as_ref(), Ok(profile));
    }
    assert!(Profile::named("bipole").unwrap_err().to_string().contains("dipole-normalised"));
    assert!(Profile::Dipole.scatters_like(&Profile::DipoleNormalised));
    assert!(!Profile::Dipole.scatters_like(&Profile::BetterDipole));
}
