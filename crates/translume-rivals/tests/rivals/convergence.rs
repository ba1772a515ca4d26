//! More samples, less error.

use crate::scene::{Picture, Scene, error, scaled, sun};
use translume::{Light, Medium, PointLight};
use translume_mesh::builtin;
use translume_rivals::{Rival, ScreenSpace, TranslucentShadowMap};
use translume_tests::{Check, Shot, at_most, dipoles, holds, notices};

const SIZE: u32 = 64;

fn creature() -> Scene {
    let lamp = PointLight { position: [-30.0, 40.0, -80.0], intensity: [1e4; 3], ..Default::default() };
    let shot = Shot { eye: [0.0, 15.0, 230.0], target: [0.0; 3], fov: 0.42, size: SIZE };
    Scene {
        mesh: scaled(builtin::creature_with(5000), 100.0),
        medium: Medium::SKIMMILK,
        lights: vec![Light::Point(lamp), Light::Directional(sun([0.6, 0.7, 0.5]))],
        shot,
    }
}

/// Each picture has at most 0.7 times the error of the one before, and the last at most `last`.
fn falls(pictures: &[Picture], judge: &Picture, last: f64) -> Check {
    let errors: Vec<_> = pictures.iter().map(|picture| error(picture, judge, SIZE as usize)[0]).collect();
    let worst = errors.windows(2).map(|pair| pair[1] / pair[0]).fold(0.0, f64::max);
    println!("{errors:.3?}");
    at_most("error over that of fewer samples", worst, 0.7)?;
    at_most("error of most samples", errors[errors.len() - 1], last)
}

#[test]
fn translucent_shadow_maps_tend_to_the_integral() {
    let scene = creature();
    let judge = scene.judge(dipoles(&scene.medium), 4, 2.0);
    let picture = |(rings, spokes)| {
        let settings = TranslucentShadowMap { rings, spokes, ..Default::default() };
        scene.picture(Rival::TranslucentShadowMap(settings))
    };
    let mut pictures: Vec<_> = [(1, 4), (4, 5), (10, 12)].map(picture).into();
    // What is left is the map: one depth a texel, edges of shadows; measured 2.5 %.
    holds(falls(&pictures, &judge, 0.06));
    pictures.swap(1, 2);
    notices(falls(&pictures, &judge, 1.0));
}

/// Its own limit, not the integral: the picture knows nothing of what the eye does not see.
#[test]
fn screen_space_tends_to_a_limit() {
    let scene = creature();
    let picture = |samples| scene.picture(Rival::ScreenSpace(ScreenSpace { samples, ..Default::default() }));
    let limit = picture(1024);
    let mut pictures: Vec<_> = [3, 11, 55, 200].map(picture).into();
    // The midpoint rule of 200 points on a picture of 64²; measured 0.8 %.
    holds(falls(&pictures, &limit, 0.03));
    pictures.swap(1, 2);
    notices(falls(&pictures, &limit, 1.0));

    // Turned discs make noise, but it averages out.
    let turned = |samples| {
        let settings = ScreenSpace { samples, rotate: true, ..Default::default() };
        let [rmse, _] = error(&scene.picture(Rival::ScreenSpace(settings)), &limit, SIZE as usize);
        at_most(&format!("{samples} samples turned at every pixel"), rmse, 0.02)
    };
    holds(turned(1024));
    notices(turned(11));
}
