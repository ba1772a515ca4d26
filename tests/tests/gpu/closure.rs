//! Closed forms: a plane gives back what the dipole says in all.

use std::f64::consts::TAU;
use translume::{DirectionalLight, Light, Medium, Method};
use translume_reference::Dipole;
use translume_tests::{Check, Fixture, Pose, at_most, dipoles, holds, notices, plane};

const SIDE: f32 = 100.0;
const SIZE: u32 = 48;
const TEXEL: f32 = SIDE / SIZE as f32;

/// Reduced albedos of red, green and blue, which share the mean free path, mm.
fn medium(albedo: [f32; 3], mean_free_path: f32, ior: f32) -> Medium {
    let sigma_s_prime = albedo.map(|a| a / mean_free_path);
    Medium { sigma_s_prime, sigma_a: albedo.map(|a| (1.0 - a) / mean_free_path), ior, g: 0.0 }
}

/// What leaves within a square around the point of entry: in direction φ it ends at half the side over the larger of
/// |cos φ| and |sin φ|.
fn within_square(dipole: &Dipole, half: f64) -> f64 {
    const STEPS: u32 = 256;
    let edge = |k: u32| {
        let (sin, cos) = ((f64::from(k) + 0.5) * TAU / f64::from(STEPS)).sin_cos();
        half / sin.abs().max(cos.abs())
    };
    dipole.total() - (0..STEPS).map(|k| dipole.beyond(edge(k))).sum::<f64>() / f64::from(STEPS)
}

const ALBEDOS: [[f32; 3]; 2] = [[0.1, 0.5, 0.9], [0.99, 0.9999, 1.0]];
const IORS: [f32; 5] = [0.8, 1.0, 1.3, 1.5, 2.0];
/// Mean free path in texels: every decade, and more where light wanders about as far as a texel is wide.
const PATHS: [f32; 11] = [1e-3, 1e-2, 0.1, 0.2, 0.3, 0.5, 1.0, 3.0, 10.0, 100.0, 1000.0];

fn square(method: Method) -> Fixture {
    Fixture::new(&plane(SIDE, SIZE), |d| d.method = method)
}

/// Largest relative error of B/E in the middle of a uniformly lit square, over all albedos.
fn closure_error(fixture: &mut Fixture, path: f32, ior: f32, gain: f64) -> f64 {
    let sun = Light::Directional(DirectionalLight { shadow: false, ..Default::default() });
    let mut worst = 0.0_f64;
    for albedo in ALBEDOS {
        let medium = medium(albedo, path * TEXEL, ior);
        fixture.body.set_medium(medium).unwrap();
        fixture.run(&Pose::rest(0).frame(&[sun]));
        let exitance = fixture.exitance();
        let sources = fixture.sources();
        let middle: Vec<usize> = (0..sources.len())
            .filter(|&k| sources[k].position.iter().all(|x| x.abs() < f64::from(TEXEL)))
            .collect();
        assert_eq!(middle.len(), 4);
        for k in middle {
            for (channel, dipole) in dipoles(&medium).iter().enumerate() {
                let measured = gain * exitance[k][channel] / sources[k].irradiance[channel];
                worst = worst.max((measured / within_square(dipole, f64::from(SIDE) / 2.0) - 1.0).abs());
            }
        }
    }
    worst
}

fn closure(fixture: &mut Fixture, path: f32, ior: f32, bound: f64, gain: f64) -> Check {
    let error = closure_error(fixture, path, ior, gain);
    at_most(&format!("closure: plane, mean free path of {path} texels, η = {ior}"), error, bound)
}

/// All pairs: the table's interpolation. Measured at most 0.11 % (a mean free path of a hundredth of a texel).
const EXACT: f64 = 2e-3;

/// What groups of sources and receivers may add, half of the tolerance on an error that has one sign on an evenly lit plane. Measured
/// at most 0.35 %.
const GROUPED: f64 = 5e-3;

#[test]
fn a_plane_returns_the_total_reflectance() {
    for (method, bound) in [(Method::AllPairs, EXACT), (Method::default(), GROUPED)] {
        let mut fixture = square(method);
        for path in PATHS {
            for ior in IORS {
                holds(closure(&mut fixture, path, ior, bound, 1.0));
            }
        }
    }
}

#[test]
fn a_kernel_half_a_per_cent_off_is_noticed() {
    for (method, bound) in [(Method::AllPairs, EXACT), (Method::default(), GROUPED)] {
        let mut fixture = square(method);
        for path in [PATHS[0], PATHS[5], PATHS[10]] {
            notices(closure(&mut fixture, path, 1.3, bound, 1.0 + 2.0 * bound));
            notices(closure(&mut fixture, path, 1.3, bound, 1.0 - 2.0 * bound));
        }
    }
}
