//! Profiles against random walks in a half-space: the truth that they approximate.

#![allow(clippy::print_stderr, reason = "measured figures, for `--nocapture`")]

use std::f64::consts::TAU;
use translume_reference::Dipole;
use translume_reference::fresnel::transmittance;
use translume_reference::profile::{
    Channel, Entry, Profile, better_dipole, half_space_albedo, normalised_diffusion, photon_beam, with_single,
};

const WALKS: u32 = 60_000;
/// Radii of the rings, in mean free paths: half an octave each.
const RINGS: usize = 20;

fn edge(ring: usize) -> f64 {
    0.05 * 2.0_f64.powf(0.5 * ring as f64)
}

/// Splitmix64, 0..1.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// What leaves in each ring, in all, and the share of it that was scattered once, of unit power that enters at a point. Unit extinction,
/// isotropic scattering.
fn walk(albedo: f64, ior: f64, entry: Entry) -> ([f64; RINGS], f64) {
    let mut dice = Dice(7);
    let (mut rings, mut total) = ([0.0; RINGS], 0.0);
    for _ in 0..WALKS {
        let down = if entry == Entry::Normal { 1.0 } else { dice.roll().sqrt() };
        let mut direction = [(1.0 - down * down).sqrt(), 0.0, down];
        let mut place = [0.0_f64; 3];
        let mut weight = 1.0;
        while weight > 1e-4 {
            let mut step = -(1.0 - dice.roll()).ln();
            // Through the surface in part; the rest turns back.
            while place[2] + step * direction[2] < 0.0 {
                let way = -place[2] / direction[2];
                (0..3).for_each(|k| place[k] += way * direction[k]);
                place[2] = 0.0;
                let leaves = weight * transmittance(1.0 / ior, -direction[2]);
                total += leaves;
                let r = place[0].hypot(place[1]);
                if let Some(ring) = (0..RINGS).find(|&k| r < edge(k)) {
                    rings[ring] += leaves;
                }
                weight -= leaves;
                direction[2] = -direction[2];
                step -= way;
            }
            (0..3).for_each(|k| place[k] += step * direction[k]);
            weight *= albedo;
            let (cosine, angle) = (2.0 * dice.roll() - 1.0, TAU * dice.roll());
            let sine = (1.0 - cosine * cosine).sqrt();
            direction = [sine * angle.cos(), sine * angle.sin(), cosine];
        }
    }
    let scale = 1.0 / f64::from(WALKS);
    (rings.map(|x| x * scale), total * scale)
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
