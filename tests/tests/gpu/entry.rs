//! The gain of entry: a flat body returns what random walks return that enter at the same angle.

use std::f64::consts::PI;
use translume::{
    AmbientLight, DirectionalLight, Entry, EnvironmentLight, Light, Medium, PointLight, Profile, SphereLight,
};
use translume_reference::half_space::{Entry as Way, Setup};
use translume_tests::{
    Check, Fixture, Model, Pose, at_most, creature, holds, luminous, notices, plane, relative_rmse,
};

const SIDE: f32 = 100.0;
const SIZE: u32 = 48;
const TEXEL: f32 = SIDE / SIZE as f32;
const ALBEDOS: [f32; 3] = [0.5, 0.8, 0.95];
const DIFFUSE: Profile = Profile::HalfSpace(Entry::Diffuse);

/// A mean free path of a quarter of a texel: next to nothing leaves the square.
fn medium(ior: f32) -> Medium {
    let extinction = 4.0 / TEXEL;
    let sigma_s_prime = ALBEDOS.map(|a| a * extinction);
    Medium { sigma_s_prime, sigma_a: ALBEDOS.map(|a| (1.0 - a) * extinction), ior, g: 0.0 }
}

/// What walks return that enter at a cosine to the normal outside; or from all sides.
fn walked(way: Way, ior: f32) -> [f64; 3] {
    let albedos = ALBEDOS.map(f64::from).to_vec();
    let setup = Setup { entry: way, ior: ior.into(), albedos, photons: 60_000, ..Setup::default() };
    let light = setup.finish();
    [0, 1, 2].map(|k| light.reflected[k].all.total.value)
}

/// Largest relative error of what the middle of the square returns of what entered.
fn error(profile: &Profile, ior: f32, light: Light, entered: f64, expected: [f64; 3]) -> f64 {
    let mut fixture = Fixture::new(&plane(SIDE, SIZE), |d| {
        (d.profile, d.medium) = (profile.clone(), medium(ior));
    });
    fixture.run(&Pose::rest(0).frame(&[light]));
    let exitance = fixture.exitance();
    let sources = fixture.sources();
    let middle =
        (0..sources.len()).filter(|&k| sources[k].position.iter().all(|x| x.abs() < f64::from(TEXEL)));
    let each =
        middle.flat_map(|texel| [0, 1, 2].map(|k| (exitance[texel][k] / entered / expected[k] - 1.0).abs()));
    each.fold(0.0, f64::max)
}

/// The walks' noise, 1 % at α' = 0.5, and the sum's and the gain's own of as much.
const BOUND: f64 = 0.025;

#[test]
fn a_plane_returns_what_enters_at_an_angle() {
    for (ior, cosine) in [(1.0_f32, 1.0_f32), (1.0, 0.7), (1.0, 0.3), (1.3, 1.0), (1.3, 0.3)] {
        let outside = f64::from(cosine);
        let inside = (1.0 - (1.0 - outside * outside) / f64::from(ior).powi(2)).sqrt();
        let expected = walked(Way::Aslant(inside), ior);
        let to_light = [(1.0 - cosine * cosine).sqrt(), cosine, 0.0];
        let sun = DirectionalLight { to_light, irradiance: [1.0; 3], shadow: false, ..Default::default() };
        let entered = outside * translume_reference::fresnel::transmittance(ior.into(), outside);
        let what = format!("entry: cosine {cosine}, η {ior}");
        let check = |profile| {
            let error = error(&profile, ior, Light::Directional(sun), entered, expected);
            at_most(&what, error, BOUND)
        };
        holds(check(Profile::default()));
        // Light from all sides returns less than at grazing angles, more than along the normal.
        if cosine != 0.7 {
            notices(check(DIFFUSE));
        }
    }
}

/// The gain's mean over the sky, by a table and by harmonics.
#[test]
fn a_plane_returns_what_enters_from_a_sky() {
    for ior in [1.0_f32, 1.3] {
        let expected = walked(Way::Diffuse, ior);
        let along = walked(Way::Normal, ior);
        let entered = PI * translume_reference::fresnel::hemispherical_transmittance(ior.into());
        let ambient = AmbientLight { radiance: [1.0; 3], shadow: false, ..Default::default() };
        let mut constant = EnvironmentLight { shadow: false, ..Default::default() };
        // The harmonic of order 0 is 1/√(4π).
        constant.coefficients[0] = [(4.0 * PI).sqrt() as f32; 3];
        for light in [Light::Ambient(ambient), Light::Environment(constant)] {
            let check = |profile, expected| {
                at_most(
                    &format!("entry: sky, η {ior}"),
                    error(&profile, ior, light, entered, expected),
                    BOUND,
                )
            };
            holds(check(Profile::default(), expected));
            holds(check(DIFFUSE, expected));
            notices(check(Profile::default(), along));
        }
    }
}

fn lights() -> [Light; 4] {
    let axis = [0.3, 2.0, 0.5];
    [
        Light::Directional(DirectionalLight {
            to_light: [0.5, 0.7, 0.4],
            shadow: false,
            ..Default::default()
        }),
        Light::Point(PointLight { position: [60.0, 80.0, 90.0], shadow: false, ..Default::default() }),
        Light::Sphere(SphereLight { center: [-70.0, 90.0, 60.0], shadow: false, ..Default::default() }),
        Light::Ambient(AmbientLight { axis, half_angle: 1.1, shadow: false, ..Default::default() }),
    ]
}

fn against_twin(light: Light, other: bool) -> Check {
    let model: std::sync::Arc<Model> = creature();
    let mut fixture = Fixture::new(&model, |d| {
        (d.profile, d.medium) = (Profile::default(), Medium { ior: 1.3, ..Medium::KETCHUP });
    });
    let pose = Pose::rest(model.mesh.targets.len());
    fixture.run(&pose.frame(&[light]));
    let gathered = luminous(&fixture.sources());
    if other {
        fixture.body.set_profile(DIFFUSE).unwrap();
    }
    let twin = luminous(&fixture.twin_sources(&pose, &[light], 2));
    // The cone's table has 32 intervals: measured 5e-4, others 6e-5.
    at_most(&format!("entry: {light:?} by the twin"), relative_rmse(&gathered, &twin), 1e-3)
}

/// Every kind of light on a medium whose channels gain differently.
#[test]
fn every_light_gains_as_the_twin_says() {
    for light in lights() {
        holds(against_twin(light, false));
        notices(against_twin(light, true));
    }
}
