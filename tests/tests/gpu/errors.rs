//! What is refused, in words, and that it leaves the body as it was.

use glam::{Mat4, Vec3};
use std::sync::Arc;
use translume::{DirectionalLight, Frame, Light, Lighting, Medium, PointLight};
use translume_tests::{Fixture, Model, Pose, creature, gpu, sphere};

fn lamp() -> Light {
    Light::Point(PointLight {
        position: [0.0, 60.0, 150.0],
        intensity: [1e4; 3],
        shadow: false,
        ..Default::default()
    })
}

/// The text names the element, and the next good frame finds nothing changed.
#[track_caller]
fn refused(fixture: &mut Fixture, bad: &Frame<'_>, words: &[&str]) {
    let pose = Pose::rest(1);
    let lights = [lamp()];
    let good = pose.frame(&lights);
    fixture.run(&good);
    let before = fixture.exitance();
    let message = fixture.prepare(bad).expect_err(&format!("{words:?} was accepted")).to_string();
    assert!(words.iter().all(|word| message.contains(word)), "[{}] {message}", gpu().adapter_name);
    assert!(fixture.body.pending().is_empty(), "[{}] a refused frame left work", gpu().adapter_name);
    fixture.run(&good);
    assert_eq!(before, fixture.exitance(), "[{}] after: {message}", gpu().adapter_name);
}

#[test]
fn bad_frames_are_refused_by_name() {
    let mut fixture = Fixture::new(&creature(), |_| ());
    let pose = |weights: &[f32]| Pose { weights: weights.to_vec(), ..Pose::rest(1) };
    let lights = [lamp()];
    refused(&mut fixture, &pose(&[0.1, 0.2]).frame(&lights), &["2 morph weights", "1 target"]);
    refused(&mut fixture, &pose(&[f32::NAN]).frame(&lights), &["morph weight 0", "NaN"]);
    let flat = Pose { model: Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0)), ..Pose::rest(1) };
    refused(&mut fixture, &flat.frame(&lights), &["model matrix"]);
    let lost = Pose { model: Mat4::from_translation(Vec3::new(f32::NAN, 0.0, 0.0)), ..Pose::rest(1) };
    refused(&mut fixture, &lost.frame(&lights), &["model matrix"]);

    let black_hole = Light::Point(PointLight { intensity: [1.0, -1.0, 1.0], ..Default::default() });
    refused(&mut fixture, &pose(&[0.3]).frame(&[lamp(), black_hole]), &["light 1", "colour"]);
    let nowhere = Light::Point(PointLight { position: [f32::NAN; 3], ..Default::default() });
    refused(&mut fixture, &pose(&[0.3]).frame(&[nowhere]), &["light 0", "finite"]);
    let aimless = Light::Directional(DirectionalLight { to_light: [0.0; 3], ..Default::default() });
    refused(&mut fixture, &pose(&[0.3]).frame(&[aimless]), &["light 0", "direction"]);
    refused(&mut fixture, &pose(&[0.3]).frame(&[lamp(); 65]), &["65", "64"]);
    let near = Light::Point(PointLight { position: [0.0, 60.0, 60.0], ..Default::default() });
    refused(&mut fixture, &pose(&[0.3]).frame(&[near; 11]), &["66 depth maps", "64"]);
}

#[test]
fn sixty_four_lights_are_accepted() {
    let mut fixture = Fixture::new(&creature(), |_| ());
    let frame = Frame { lighting: Lighting::Lights(&[lamp(); 64]), ..Frame::default() };
    fixture.prepare(&frame).unwrap();
}

#[test]
fn a_bad_medium_is_refused_and_the_old_one_stays() {
    let mut fixture = Fixture::new(&creature(), |d| d.medium = Medium::JADE);
    let bad = Medium { sigma_a: [0.1, f32::NAN, 0.1], ..Medium::JADE };
    let message = fixture.body.set_medium(bad).unwrap_err().to_string();
    assert!(message.contains("sigma_a (green)"), "[{}] {message}", gpu().adapter_name);
    assert_eq!(*fixture.body.medium(), Medium::JADE);
    let message = Fixture::try_new(&creature(), |d| d.medium = bad).err().unwrap().to_string();
    assert!(message.contains("sigma_a (green)"), "[{}] {message}", gpu().adapter_name);
}

#[test]
fn bad_bodies_are_refused_by_name() {
    let stranger = Arc::new(Model { mesh: creature().mesh.clone(), atlas: sphere().atlas.clone() });
    let message = Fixture::try_new(&stranger, |_| ()).err().unwrap().to_string();
    assert!(
        message.contains("creature") && message.contains("another mesh"),
        "[{}] {message}",
        gpu().adapter_name
    );
    for scale in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let message = Fixture::try_new(&sphere(), |d| d.mm_per_unit = scale).err().unwrap().to_string();
        assert!(message.contains("mm per unit"), "[{}] {message}", gpu().adapter_name);
    }
    let message = Fixture::try_new(&sphere(), |d| d.shadow_resolution = 8).err().unwrap().to_string();
    assert!(message.contains("depth maps"), "[{}] {message}", gpu().adapter_name);
    Fixture::try_new(&sphere(), |d| d.shadow_resolution = 16).map(|_| ()).unwrap();
}
