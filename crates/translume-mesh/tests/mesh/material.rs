//! From a material to the coefficients of a medium.

use proptest::prelude::*;
use translume_mesh::material::{Material, Scatter, ScatterDraft, Scattering, Volume};

fn material(color: f32, distance: f32, multiscatter: f32, anisotropy: f32, draft: ScatterDraft) -> Material {
    Material {
        volume: Some(Volume {
            thickness: 1.0,
            attenuation_distance: distance,
            attenuation_color: [color; 3],
        }),
        scatter: Some(Scatter { draft, multiscatter_color: [multiscatter; 3], anisotropy }),
        ..Material::default()
    }
}

/// σ_s and σ_a in 1/m as the drafts have them, with their own constants.
fn as_drafted(material: &Material) -> (f64, f64) {
    let (volume, scatter) = (material.volume.unwrap(), material.scatter.unwrap());
    let sigma_t = -f64::from(volume.attenuation_color[0]).ln() / f64::from(volume.attenuation_distance);
    let (c, g) = (f64::from(scatter.multiscatter_color[0]), f64::from(scatter.anisotropy));
    let s = 4.09712 + 4.20863 * c - (9.59217 + 41.6808 * c + 17.7126 * c * c).sqrt();
    let albedo = match scatter.draft {
        ScatterDraft::Scatter => (1.0 - s * s) / (1.0 - g * s * s),
        _ => 1.0 - s * s,
    };
    (sigma_t * albedo, sigma_t * (1.0 - albedo))
}

/// The constants of the drafts have six digits, and s is a difference of numbers below 10: 1e-5 in the albedo.
#[test]
fn coefficients_are_those_of_the_drafts() {
    let check = |material: &Material, gain: f64| {
        let (sigma_s, sigma_a) = as_drafted(material);
        let found = material.scattering().unwrap();
        let g = f64::from(material.scatter.unwrap().anisotropy);
        let bound = 2e-5 * (sigma_s + sigma_a) / 1000.0;
        (f64::from(found.sigma_s_prime[0]) - gain * sigma_s * (1.0 - g) / 1000.0).abs() < bound
            && (f64::from(found.sigma_a[0]) - gain * sigma_a / 1000.0).abs() < bound
    };
    for draft in [ScatterDraft::VolumeScatter, ScatterDraft::Scatter] {
        for (color, distance, multiscatter, g) in
            [(0.5, 0.01, 0.5, 0.0), (0.9, 2.0, 0.95, 0.8), (0.01, 0.001, 0.05, -0.7), (0.3, 1.0, 0.999, 0.3)]
        {
            let material = material(color, distance, multiscatter, g, draft);
            assert!(check(&material, 1.0), "{material:?} {:?}", material.scattering());
            assert!(!check(&material, 1.001), "a thousandth more must be noticed");
        }
    }
}

/// A half of white light is gone after a centimetre: 69.3/m. Half of what a deep volume sends back: s = 0.2972.
#[test]
fn a_worked_example() {
    let Scattering { sigma_s_prime, sigma_a, ior, g } =
        material(0.5, 0.01, 0.5, 0.0, ScatterDraft::VolumeScatter).scattering().unwrap();
    assert!((sigma_s_prime[1] - 0.063_19).abs() < 1e-4, "{sigma_s_prime:?}");
    assert!((sigma_a[1] - 0.006_12).abs() < 1e-4, "{sigma_a:?}");
    assert!((sigma_s_prime[1] + sigma_a[1] - 2.0_f32.ln() / 10.0).abs() < 1e-6);
    assert_eq!((ior, g), (1.5, 0.0));
}

/// The reduced albedo of the newer draft does not depend on g.
#[test]
fn the_newer_draft_keeps_the_colour_at_any_anisotropy() {
    let reduced = |g: f32, draft| {
        let found = material(0.5, 0.01, 0.6, g, draft).scattering().unwrap();
        found.sigma_s_prime[0] / (found.sigma_s_prime[0] + found.sigma_a[0])
    };
    let [isotropic, forward] = [0.0, 0.9].map(|g| reduced(g, ScatterDraft::Scatter));
    assert!((isotropic - forward).abs() < 1e-6, "{isotropic} {forward}");
    let [isotropic, forward] = [0.0, 0.9].map(|g| reduced(g, ScatterDraft::VolumeScatter));
    assert!((isotropic - forward).abs() > 0.1, "the older one does not: {isotropic} {forward}");
}

#[test]
fn ends_are_exact() {
    for draft in [ScatterDraft::VolumeScatter, ScatterDraft::Scatter] {
        let white = material(0.5, 0.01, 1.0, 0.3, draft).scattering().unwrap();
        assert_eq!(white.sigma_a, [0.0; 3]);
        assert!((white.sigma_s_prime[0] - 0.7 * 2.0_f32.ln() / 10.0).abs() < 1e-7);

        let mut mixed = material(0.5, 0.01, 0.5, 0.0, draft);
        if let (Some(volume), Some(scatter)) = (&mut mixed.volume, &mut mixed.scatter) {
            volume.attenuation_color = [1.0, 0.0, 0.5];
            scatter.multiscatter_color = [0.5, 0.5, 0.0];
        }
        let mixed = mixed.scattering().unwrap();
        assert_eq!((mixed.sigma_s_prime[0], mixed.sigma_a[0]), (0.0, 0.0), "white light stays white");
        assert!(mixed.sigma_a[0].is_sign_positive());
        // e⁻⁸⁷ after a centimetre.
        let black = mixed.sigma_s_prime[1] + mixed.sigma_a[1];
        assert!((black - 8.7337).abs() < 1e-3, "{black}");
        assert_eq!(mixed.sigma_s_prime[2], 0.0, "nothing comes back");
        assert!((mixed.sigma_a[2] - 2.0_f32.ln() / 10.0).abs() < 1e-7);
    }
}

#[test]
fn what_does_not_scatter_is_no_medium() {
    let medium = material(0.5, 0.01, 0.5, 0.0, ScatterDraft::Scatter);
    assert!(medium.scattering().is_some());
    let altered = |change: &dyn Fn(&mut Material)| {
        let mut material = medium.clone();
        change(&mut material);
        material.scattering()
    };
    assert_eq!(altered(&|m| m.volume = None), None);
    assert_eq!(altered(&|m| m.scatter = None), None);
    assert_eq!(altered(&|m| m.ior = 0.0), None);
    let thin = |m: &mut Material| m.volume.as_mut().unwrap().thickness = 0.0;
    assert_eq!(altered(&thin), None);
    let older = |m: &mut Material| m.scatter.as_mut().unwrap().draft = ScatterDraft::VolumeScatter;
    assert_eq!(
        altered(&|m| {
            older(m);
            thin(m);
        }),
        altered(&older)
    );
    for (color, distance, multiscatter) in [(0.5, f32::INFINITY, 0.5), (1.0, 0.01, 0.5), (0.5, 0.01, 0.0)] {
        let clear = material(color, distance, multiscatter, 0.0, ScatterDraft::Scatter);
        assert_eq!(clear.scattering(), None, "{clear:?}");
    }
}

proptest! {
    #[test]
    fn no_coefficient_is_ever_none(
        color in 0.0_f32..=1.0,
        multiscatter in prop_oneof![0.0_f32..=1.0, Just(0.0), Just(1.0), Just(f32::MIN_POSITIVE), Just(1e-45)],
        anisotropy in prop_oneof![-1.0_f32..=1.0, Just(1.0), Just(-1.0)],
        distance in prop_oneof![1e-37_f32..1e30, Just(1e-38), Just(f32::INFINITY)],
        newer: bool,
    ) {
        let draft = if newer { ScatterDraft::Scatter } else { ScatterDraft::VolumeScatter };
        if let Some(found) = material(color, distance, multiscatter, anisotropy, draft).scattering() {
            for sigma in found.sigma_s_prime.into_iter().chain(found.sigma_a) {
                prop_assert!((0.0..=f32::MAX).contains(&sigma), "{found:?}");
            }
        }
    }
}
