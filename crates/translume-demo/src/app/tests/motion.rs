//! What moves, and what takes it back.

use super::window::{Setup, Window, difference, melting};
use crate::scene::Round;
use eframe::egui::{Key, Modifiers};

#[test]
fn a_morph_plays_and_stops() {
    let mut window = Window::with(&Setup::default(), &melting());
    assert_eq!(window.app().loaded.as_ref().unwrap().opened.model.mesh.targets.len(), 1);
    let still = window.picture();
    window.click("Play");
    assert!(window.app().playback.playing);
    window.until("a quarter of a round", |app| app.playback.phase > 0.25);
    window.until("its picture", |app| {
        app.ordered.as_ref().is_some_and(|wish| wish.scene.morph.first().is_some_and(|weight| *weight > 0.4))
    });
    // Pictures that move are of a quarter of the samples, which alone makes a difference of about 0.2.
    window.until_unlike(&still, 1.0);

    window.click("Pause");
    window.settle();
    let (phase, picture) = (window.app().playback.phase, window.picture());
    window.harness.run_steps(30);
    window.settle();
    assert_eq!((window.app().playback.phase, difference(&picture, &window.picture())), (phase, 0.0));

    window.key(Modifiers::NONE, Key::Space);
    window.harness.run_steps(3);
    assert_ne!(window.app().playback.phase, phase);
}

#[test]
fn sliders_move_what_stands_still() {
    let mut window = Window::with(&Setup::default(), &melting());
    let mut last = window.picture();
    for (slider, value) in [("moment", 0.5), ("twist °", 200.0), ("bend °", 90.0), ("inflate", -2.0)] {
        window.slide(slider, value);
        window.settle();
        let picture = window.picture();
        assert!(difference(&last, &picture) > 0.3, "{slider}: {}", difference(&last, &picture));
        last = picture;
    }
    let scene = &window.app().ordered.as_ref().unwrap().scene;
    assert_eq!(scene.morph, [1.0]);
    assert_eq!((scene.warp.twist_deg, scene.warp.bend_deg), (200.0, 90.0));
}

#[test]
fn a_body_without_motion_is_walked_around() {
    let mut window = Window::sphere();
    let eye = window.app().scene.camera.unwrap().eye;
    window.click("Play");
    window.until("a turn begun", |app| app.playback.phase > 0.1);
    let wish = |window: &Window| window.app().ordered.as_ref().unwrap().scene.camera.unwrap().eye;
    window.until("its picture", |app| {
        app.ordered.as_ref().is_some_and(|wish| wish.scene.camera.is_some_and(|camera| camera.eye != eye))
    });
    assert_ne!(wish(&window), eye);
    assert_eq!(window.app().scene.camera.unwrap().eye, eye, "where the user put it");
}

#[test]
fn changes_are_taken_back_and_made_again() {
    let mut window = Window::sphere();
    // A change counts once it has stood for a second.
    window.harness.run_steps(40);
    window.click("ketchup");
    window.harness.run_steps(40);
    window.slide("exposure, stops", 2.0);
    window.harness.run_steps(40);
    let set = |window: &Window| {
        let scene = &window.app().scene;
        (scene.medium.clone().unwrap_or_default(), scene.look.exposure)
    };
    assert_eq!(set(&window), ("ketchup".to_owned(), 2.0));
    let camera = window.app().scene.camera;
    window.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(set(&window), ("ketchup".to_owned(), 0.0));
    window.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(set(&window), ("wax".to_owned(), 0.0));
    window.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(set(&window), ("ketchup".to_owned(), 0.0));
    window.click("Edit");
    window.click("Redo");
    assert_eq!(set(&window), ("ketchup".to_owned(), 2.0));
    assert_eq!(window.app().scene.camera, camera, "the camera is no change");
}

#[test]
fn a_melted_mesh_is_another_and_comes_back() {
    let mut window = Window::sphere();
    window.harness.run_steps(40);
    window.click("a sphere");
    window.until("a target", |app| {
        app.loaded.as_ref().is_some_and(|loaded| !loaded.opened.model.mesh.targets.is_empty())
    });
    assert_eq!(window.app().scene.into, Some(Round::Sphere));
    window.harness.run_steps(40);
    window.key(Modifiers::COMMAND, Key::Z);
    window.until("its own shape", |app| {
        app.loaded.as_ref().is_some_and(|loaded| loaded.opened.model.mesh.targets.is_empty())
    });
    assert_eq!(window.app().scene.into, None);
}
