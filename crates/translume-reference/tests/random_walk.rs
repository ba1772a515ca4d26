//! Profiles against random walks in a half-space: the truth that they approximate.

#![allow(clippy::print_stderr, reason = "measured figures, for `--nocapture`")]

use translume_reference::Dipole;
use translume_reference::half_space::{Entry as Way, Setup};
use translume_reference::profile::{
    Channel, Entry, Profile, better_dipole, half_space_albedo, normalised_diffusion, photon_beam, with_single,
};

const WALKS: u64 = 60_000;
/// Radii of the rings, in mean free paths: half an octave each.
const RINGS: usize = 20;

fn edge(ring: usize) -> f64 {
    0.05 * 2.0_f64.powf(0.5 * ring as f64)
}

/// What leaves in each ring, and in all, of unit power that enters at a point. Unit extinction, isotropic scattering.
fn walk(albedo: f64, ior: f64, entry: Entry) -> ([f64; RINGS], f64) {
    let entry = if entry == Entry::Normal { Way::Normal } else { Way::Cosine };
    let edges = (0..RINGS).map(edge).collect();
    let setup =
        Setup { entry, ior, albedos: vec![albedo], edges, photons: WALKS, seed: 7, ..Setup::default() };
    let all = &setup.finish().reflected[0].all;
    (std::array::from_fn(|ring| all.rings[ring].value), all.total.value)
}

/// Σ |walks − profile| over the rings, over what leaves in all: the error of shape and energy that Christensen and Burley quote.
fn error(profile: &dyn Profile, rings: &[f64; RINGS], total: f64) -> f64 {
    let mut inner = 0.0;
    let off = (0..RINGS).map(|k| {
        let enclosed = profile.enclosed(edge(k));
        let ring = enclosed - inner;
        inner = enclosed;
        (rings[k] - ring).abs()
    });
    off.sum::<f64>() / total
}

fn channel(albedo: f64, ior: f64) -> Channel {
    Channel { sigma_s_prime: albedo, sigma_a: 1.0 - albedo, ior }
}

/// Chandrasekhar's exact albedo; the walks' noise is 0.3 %.
#[test]
fn walks_return_the_exact_albedo() {
    for entry in [Entry::Normal, Entry::Diffuse] {
        for albedo in [0.5, 0.9, 0.99] {
            let total = walk(albedo, 1.0, entry).1;
            assert!(
                (total / half_space_albedo(albedo, entry) - 1.0).abs() < 0.01,
                "{entry:?} {albedo}: {total}"
            );
            assert!((total / half_space_albedo(0.97 * albedo, entry) - 1.0).abs() > 0.01);
        }
    }
}

/// Christensen and Burley 2015 give 5.5 % on average over albedos for light along the normal and 3.9 % for diffuse light.
#[test]
fn normalised_diffusion_follows_the_walks() {
    for (entry, bound) in [(Entry::Normal, 0.09), (Entry::Diffuse, 0.07)] {
        for albedo in [0.5, 0.9, 0.99] {
            let (rings, total) = walk(albedo, 1.0, entry);
            let found = error(&normalised_diffusion(&channel(albedo, 1.0), entry, None), &rings, total);
            eprintln!("normalised diffusion, {entry:?}, α' {albedo}: {found:.3}");
            assert!(found < bound, "{entry:?} {albedo}: {found}");
            let wide = normalised_diffusion(&channel(albedo, 1.0), entry, Some(100.0));
            assert!(error(&wide, &rings, total) > bound, "another length must be noticed");
        }
    }
}

/// How far each profile is from the truth along the normal, for docs/method.md.
#[test]
fn profiles_stand_in_their_order() {
    for ior in [1.0, 1.3] {
        for albedo in [0.5, 0.9, 0.99] {
            let (rings, total) = walk(albedo, ior, Entry::Normal);
            let (medium, white) = (channel(albedo, ior), channel(1.0, ior));
            let classical = Dipole::new(albedo, 1.0 - albedo, ior);
            let better = better_dipole(&medium);
            let beam = photon_beam(&medium);
            let beam_single = with_single(&medium, &beam, photon_beam(&white).total());
            let better_single = with_single(&medium, &better, 1.0);
            let dipole_single = with_single(&medium, &classical, 1.0);
            let burley = normalised_diffusion(&medium, Entry::Normal, None);
            let all: [(&str, &dyn Profile); 7] = [
                ("dipole", &classical),
                ("dipole, single", &dipole_single),
                ("better dipole", &better),
                ("better dipole, single", &better_single),
                ("photon beam", &beam),
                ("photon beam, single", &beam_single),
                ("normalised diffusion", &burley),
            ];
            let errors = all.map(|(name, profile)| {
                let found = error(profile, &rings, total);
                eprintln!(
                    "η {ior}, α' {albedo}, {name}: error {found:.3}, total {:.3} of {total:.3}",
                    profile.total()
                );
                found
            });
            // The order the documentation promises.
            assert!(
                errors[5] < errors[3] && errors[3] < errors[1].max(errors[2]),
                "{ior} {albedo}: {errors:?}"
            );
            assert!(errors[5] < 0.5 * errors[0], "{ior} {albedo}: {errors:?}");
        }
    }
}
