//! The solver against what is known exactly, and against paths.

use super::*;
use crate::Surface;
use crate::path::{Ball, Volume};
use crate::testing::octasphere;
use std::f64::consts::PI;

const BALL: Ball = Ball { center: [0.0; 3], radius: 10.0 };

/// One site a triangle, moved out to the exact sphere and as large as its part of it.
fn sites(level: u32) -> Vec<Site> {
    let (positions, triangles) = octasphere(BALL.radius, level);
    let surface = Surface::flat(positions, triangles);
    let count = surface.triangles.len() as u32;
    let total: f64 = (0..count).map(|triangle| surface.area(triangle)).sum();
    let site = |triangle: u32| {
        let normal = DVec3::from(surface.point(triangle, [1.0 / 3.0, 1.0 / 3.0])).normalize();
        let area = surface.area(triangle) * 4.0 * PI * BALL.radius * BALL.radius / total;
        Site { position: (normal * BALL.radius).to_array(), normal: normal.to_array(), area }
    };
    (0..count).map(site).collect()
}

fn sky(shadow: bool) -> Light {
    Light::Ambient { radiance: [1.0; 3], axis: [0.0, 1.0, 0.0], half_angle: PI, shadow }
}

fn sun() -> Light {
    Light::Directional { to_light: [0.0, 0.0, 1.0], irradiance: [PI; 3], shadow: true, region: None }
}

fn mean(values: impl Iterator<Item = [f64; 3]>, areas: &[Site]) -> [f64; 3] {
    let total: f64 = areas.iter().map(|site| site.area).sum();
    let mut sum = [0.0; 3];
    values.zip(areas).for_each(|(value, site)| crate::rgb::accumulate(&mut sum, value, site.area / total));
    sum
}

/// Without absorption all light that enters leaves: π of it, less what crosses unscattered, 2E₃-like and known for a sphere.
#[test]
fn nothing_is_lost_without_absorption() {
    for (ior, bound) in [(1.0, 0.02), (1.3, 0.02)] {
        let volume = Volume { sigma_s: [0.7, 2.0, 6.0], sigma_a: [0.0; 3], g: 0.0, ior };
        let lights = [sky(true)];
        let body = Body { shape: &BALL, volume, lights: &lights };
        let sites = sites(3);
        let solution = Solution::new(body, sites.clone(), 4);
        let exitance = mean((0..sites.len()).map(|site| solution.exitance(site)), &sites);
        for (k, found) in exitance.into_iter().enumerate() {
            // Refracted light keeps within the critical angle of the normal.
            let least = f64::sqrt(1.0 - 1.0 / (ior * ior));
            let steps = 1000;
            let crossing = |step: i32| {
                let cosine = least + (1.0 - least) * (f64::from(step) + 0.5) / f64::from(steps);
                2.0 * cosine * (-volume.sigma_s[k] * 2.0 * BALL.radius * cosine).exp() * (1.0 - least)
                    / f64::from(steps)
            };
            let through = (0..steps).map(crossing).sum::<f64>() / (1.0 - least * least);
            let entered = PI * crate::fresnel::hemispherical_transmittance(ior) * (1.0 - through);
            assert!((found / entered - 1.0).abs() < bound, "{ior} {k}: {found} {entered}");
        }
    }
}

/// A site far larger than a mean free path returns what a half-space does, however few there are.
#[test]
fn coarse_sites_become_a_half_space() {
    let volume = Volume { sigma_s: [20.0, 100.0, 500.0], sigma_a: [0.4, 5.0, 100.0], g: 0.0, ior: 1.0 };
    let lights = [sun()];
    let sites = sites(3);
    let solution = Solution::new(Body { shape: &BALL, volume, lights: &lights }, sites.clone(), 6);
    let lit = (0..sites.len()).max_by(|&a, &b| sites[a].normal[2].total_cmp(&sites[b].normal[2])).unwrap();
    let cosine = sites[lit].normal[2];
    for (k, medium) in solution.medium.iter().enumerate() {
        // Continuous sources of a plane, α' (1 + …) in closed form: ∫ e^−z/μ half_space(0, z) dz/μ.
        let exact = medium.robin * medium.albedo * PI * cosine
            / ((medium.diffusion * medium.decay + medium.robin)
                * (1.0 + medium.decay * cosine / medium.extinction));
        let found = solution.exitance(lit)[k];
        // Three strata for an exponential, and the shift of depths by up to a tenth of a mean free path.
        assert!((found / exact - 1.0).abs() < 0.05, "{k}: {found} {exact}");
    }
    assert!(solution.residual().iter().all(|share| *share < 1e-2), "{:?}", solution.residual());
}

/// More steps leave less, and the dark is dark.
#[test]
fn steps_contract() {
    let volume = Volume { sigma_s: [0.6, 2.0, 5.0], sigma_a: [0.006, 0.04, 0.26], g: 0.0, ior: 1.0 };
    let lights = [sun()];
    let residual =
        |steps| Solution::new(Body { shape: &BALL, volume, lights: &lights }, sites(2), steps).residual();
    let (two, five) = (residual(2), residual(5));
    for k in 0..3 {
        assert!(five[k] < 0.05 * two[k] && two[k] < 0.2, "{two:?} {five:?}");
    }
    let dark = Solution::new(Body { shape: &BALL, volume, lights: &[] }, sites(1), 3);
    assert!(dark.fluence().iter().flatten().all(|value| *value == 0.0));
}

/// φ right under a site is that of the site.
#[test]
fn fluence_is_continuous() {
    let volume = Volume { sigma_s: [0.6, 2.0, 5.0], sigma_a: [0.006, 0.04, 0.26], g: 0.0, ior: 1.0 };
    let lights = [sun()];
    let sites = sites(3);
    let solution = Solution::new(Body { shape: &BALL, volume, lights: &lights }, sites.clone(), 7);
    for index in (0..sites.len()).step_by(37) {
        let below = DVec3::from(sites[index].position) - DVec3::from(sites[index].normal) * 1e-7;
        let found = solution.fluence_at(below.to_array());
        for k in 0..3 {
            let on = solution.fluence()[index][k];
            let most = solution.fluence().iter().map(|value| value[k]).fold(0.0, f64::max);
            // What the solver leaves, in the norm that weighs the dark.
            assert!((found[k] - on).abs() < 0.02 * on + 1e-3 * most, "{index} {k}: {} {on}", found[k]);
        }
    }
}

/// What neither scatters nor absorbs, what only does one of both, and what is hardly there.
#[test]
fn hard_media_stay_finite() {
    let lights = [sun(), sky(true)];
    for (sigma_s, sigma_a) in
        [([0.0; 3], [0.0; 3]), ([0.0, 0.0, 1e3], [1.0, 1e3, 0.0]), ([1e-6, 1e-3, 1e3], [0.0; 3])]
    {
        for ior in [0.8, 1.0, 1.5] {
            let volume = Volume { sigma_s, sigma_a, g: 0.0, ior };
            let sites = sites(1);
            let solution = Solution::new(Body { shape: &BALL, volume, lights: &lights }, sites.clone(), 4);
            let layers = solution.layers();
            for site in 0..sites.len() {
                let seen = Seen {
                    sites: vec![(site, 1.0)],
                    cosine: 0.5,
                    chord: 10.0,
                    along: [(1.0, None), (2.0, Some(0))],
                    far: Some((0, 0.5)),
                };
                let radiance = layers.radiance(&seen);
                let exitance = solution.exitance(site);
                // As much leaves as enters, π of either light, and a part of it for a site so coarse.
                let is_sound = |value: f64| value.is_finite() && (-0.2..20.0).contains(&value);
                assert!(
                    radiance.into_iter().chain(exitance).all(is_sound),
                    "{sigma_s:?} {ior}: {radiance:?} {exitance:?}"
                );
            }
        }
    }
}
