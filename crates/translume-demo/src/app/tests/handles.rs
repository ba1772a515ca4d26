//! Hands on the picture: the camera and the lights.

use super::super::orbit;
use super::window::{Setup, Window, difference};
use crate::scene::{SceneCamera, SceneLight};
use eframe::egui::{Key, Modifiers, Pos2, Vec2};
use glam::Vec3;

fn camera(window: &Window) -> SceneCamera {
    window.app().scene.camera.unwrap()
}

fn distance(camera: &SceneCamera) -> f32 {
    Vec3::from(camera.eye).distance(camera.target.into())
}

fn light(window: &Window) -> [f32; 3] {
    match window.app().scene.lights.as_ref().unwrap()[0] {
        SceneLight::Point { position, .. } => position,
        ref other => panic!("{other:?}"),
    }
}

/// Where a point is on the screen.
fn place(window: &Window, point: [f32; 3]) -> Pos2 {
    let frame = orbit::Frame::of(&orbit::shaped(camera(window), window.app().view.pixels().unwrap()));
    let (place, _) = frame.project(point.into()).unwrap();
    window.view().lerp_inside(Vec2::new(place.x, place.y))
}

#[test]
fn a_light_follows_its_handle_and_the_camera_stays() {
    let mut window = Window::sphere();
    let (before, camera_before, picture) = (light(&window), camera(&window), window.picture());
    let from = place(&window, before);
    assert!(window.view().contains(from), "{from} is in the picture");
    let by = Vec2::new(-70.0, 35.0);
    window.drag(from, by);
    assert_eq!(camera(&window), camera_before);
    // Rounding of positions of size 100 in pixels.
    assert!((place(&window, light(&window)) - from - by).length() < 0.5);
    let depth = |point| {
        let frame = orbit::Frame::of(&camera_before);
        frame.project(Vec3::from(point)).unwrap().1
    };
    assert!((depth(light(&window)) / depth(before) - 1.0).abs() < 1e-3, "neither nearer nor farther");
    window.settle();
    assert!(difference(&picture, &window.picture()) > 0.5);
}

#[test]
fn elsewhere_the_camera_is_turned_moved_and_brought_nearer() {
    let mut window = Window::sphere();
    let (first, lights) = (camera(&window), light(&window));
    let middle = window.view().center();
    window.drag(middle, Vec2::new(60.0, 20.0));
    let turned = camera(&window);
    assert!((distance(&turned) / distance(&first) - 1.0).abs() < 1e-3);
    assert!(Vec3::from(turned.eye).distance(first.eye.into()) > 0.2 * distance(&first));
    assert_eq!(turned.target, first.target);

    window.harness.event(eframe::egui::Event::ModifiersChanged(Modifiers::SHIFT));
    window.drag(middle, Vec2::new(60.0, 20.0));
    window.harness.event(eframe::egui::Event::ModifiersChanged(Modifiers::NONE));
    window.harness.step();
    let moved = camera(&window);
    let step = Vec3::from(moved.eye) - Vec3::from(turned.eye);
    assert!(step.length() > 1.0);
    assert!((Vec3::from(moved.target) - Vec3::from(turned.target)).distance(step) < 1e-3);

    let before = distance(&moved);
    window.wheel(middle, 100.0);
    let near = camera(&window);
    assert!(distance(&near) < 0.95 * before, "{} of {before}", distance(&near));
    window.wheel(middle, -200.0);
    assert!(distance(&camera(&window)) > 1.05 * before);
    assert_eq!(light(&window), lights);
}

#[test]
fn everything_comes_back_into_sight() {
    let mut window = Window::sphere();
    let framed = camera(&window);
    let lost = SceneCamera { eye: [300.0, 10.0, 0.0], target: [250.0, 0.0, 0.0], ..framed };
    type Act = fn(&mut Window);
    let acts: [Act; 3] = [
        |window| {
            let middle = window.view().center();
            for _ in 0..2 {
                window.harness.hover_at(middle);
                window.harness.drag_at(middle);
                window.harness.event(eframe::egui::Event::PointerButton {
                    pos: middle,
                    button: eframe::egui::PointerButton::Primary,
                    pressed: false,
                    modifiers: Modifiers::NONE,
                });
            }
            window.harness.run_steps(2);
        },
        |window| window.key(Modifiers::NONE, Key::F),
        |window| {
            window.click("View");
            window.click("Frame all");
        },
    ];
    for (k, act) in acts.into_iter().enumerate() {
        window.app_mut().scene.camera = Some(lost);
        window.harness.run_steps(15);
        act(&mut window);
        assert_eq!(camera(&window), framed, "{k}");
    }
    window.settle();
}

#[test]
fn pictures_have_the_pixels_of_the_screen() {
    let mut window = Window::with(&Setup { size: [760.0, 420.0], ..Setup::default() }, super::window::SPHERE);
    let [width, height] = window.picture().size;
    let view = window.view();
    assert_eq!([width as f32, height as f32], [view.width().round(), view.height().round()]);
    window.harness.set_size(Vec2::new(820.0, 380.0));
    window.settle();
    let view = window.view();
    assert_eq!(window.picture().size, [view.width().round() as usize, view.height().round() as usize]);
    assert_ne!(window.picture().size, [width, height]);

    let dense = Setup { size: [760.0, 420.0], pixels_per_point: 2.0, ..Setup::default() };
    let window = Window::with(&dense, super::window::SPHERE);
    let size = window.view().size() * 2.0;
    assert_eq!(window.picture().size, [size.x.round() as usize, size.y.round() as usize]);
}
