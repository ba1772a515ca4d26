//! Pictures that guard what a number cannot say: each is small, and compared by means that another rasteriser keeps.

use std::path::PathBuf;
use std::sync::Arc;
use translume::{AmbientLight, DirectionalLight, Light, Medium, PointLight, Profile};
use translume_tests::{
    Check, Fixture, Model, Pose, Shot, at_most, creature, difference, holds, notices, sphere, teapot,
};

struct Scene {
    name: &'static str,
    model: Arc<Model>,
    medium: Medium,
    mm_per_unit: f32,
    lights: Vec<Light>,
    shot: Shot,
}

fn jade_creature() -> Scene {
    let lamp = PointLight { position: [-20.0, 110.0, -90.0], intensity: [1.2e5; 3], ..Default::default() };
    let sky = AmbientLight { radiance: [0.06; 3], ..Default::default() };
    Scene {
        name: "creature-jade",
        model: creature(),
        medium: Medium::JADE,
        mm_per_unit: 0.4,
        lights: vec![Light::Point(lamp), Light::Ambient(sky)],
        shot: Shot { eye: [60.0, 80.0, 240.0], target: [0.0, 50.0, 0.0], fov: 0.4, size: 96 },
    }
}

fn marble_sphere() -> Scene {
    let sun =
        DirectionalLight { to_light: [0.8, 0.5, 0.4], irradiance: [3.0, 2.8, 2.4], ..Default::default() };
    Scene {
        name: "sphere-marble",
        model: sphere(),
        medium: Medium::MARBLE,
        mm_per_unit: 0.2,
        lights: vec![Light::Directional(sun)],
        shot: Shot { eye: [0.0, 20.0, 220.0], target: [0.0; 3], fov: 0.5, size: 64 },
    }
}

fn skin_teapot() -> Scene {
    let sun = DirectionalLight { to_light: [-0.4, 0.8, 0.6], irradiance: [7.0; 3], ..Default::default() };
    Scene {
        name: "teapot-skin1",
        model: teapot(),
        medium: Medium::SKIN1,
        mm_per_unit: 0.2,
        lights: vec![Light::Directional(sun)],
        shot: Shot { eye: [60.0, 110.0, 190.0], target: [2.0, 22.0, 0.0], fov: 0.42, size: 96 },
    }
}

/// 8-bit RGB under the tone curve √(min(L, 1)).
fn develop(scene: &Scene, gain: f32) -> Vec<u8> {
    let mut fixture = Fixture::new(&scene.model, |d| {
        (d.medium, d.mm_per_unit, d.profile) = (scene.medium, scene.mm_per_unit, Profile::default());
    });
    fixture.run(&Pose::rest(scene.model.mesh.targets.len()).frame(&scene.lights));
    let radiance = scene.shot.take(&fixture);
    let tone = |x: f32| (255.0 * (gain * x).clamp(0.0, 1.0).sqrt()).round() as u8;
    radiance.iter().flat_map(|pixel| pixel[..3].iter().map(|x| tone(*x))).collect()
}

/// Mean absolute difference and largest difference of 8 × 8 block means, of 255. Another rasteriser may choose otherwise at some
/// twenty silhouette pixels, by up to 200: 0.4 in the mean of 9,216, and 3 in a block that holds one. 5 % more light makes 0.7–1.8
/// and 4–5.
const MEAN: f64 = 0.5;
const BLOCK: f64 = 3.5;

fn compare(scene: &Scene, gain: f32) -> Check {
    let picture = develop(scene, gain);
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden").join(format!("{}.png", scene.name));
    let size = scene.shot.size;
    if std::env::var("TRANSLUME_BLESS").is_ok_and(|value| value == "1") && gain == 1.0 {
        image::save_buffer(&path, &picture, size, size, image::ColorType::Rgb8).map_err(|e| e.to_string())?;
    }
    let golden = image::open(&path)
        .map_err(|error| format!("{}: {error}; TRANSLUME_BLESS=1 makes it, then look at it", path.display()))?
        .to_rgb8();
    if golden.dimensions() != (size, size) {
        return Err(format!("{} is not {size}² pixels", path.display()));
    }
    let (mean, block) = difference(&picture, &golden, size as usize);
    at_most(&format!("golden: {}, mean difference", scene.name), mean, MEAN)?;
    at_most(&format!("golden: {}, block difference", scene.name), block, BLOCK)
}

#[test]
fn the_creature_in_jade_lit_from_behind() {
    holds(compare(&jade_creature(), 1.0));
}

#[test]
fn the_sphere_in_marble() {
    holds(compare(&marble_sphere(), 1.0));
}

#[test]
fn the_teapot_in_skin() {
    holds(compare(&skin_teapot(), 1.0));
}

#[test]
fn five_per_cent_more_light_is_noticed() {
    for scene in [jade_creature(), marble_sphere(), skin_teapot()] {
        notices(compare(&scene, 1.05));
    }
}

#[test]
fn a_missing_picture_fails_and_says_how_to_make_it() {
    let scene = Scene { name: "no-such-picture", ..marble_sphere() };
    let message = compare(&scene, 0.999).unwrap_err();
    assert!(message.contains("no-such-picture.png") && message.contains("TRANSLUME_BLESS=1"), "{message}");
}
