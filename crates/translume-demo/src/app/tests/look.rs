//! What the body is made of, how it is lit and computed, and how the window looks.

use super::window::{Setup, Window, difference, middle};
use crate::scene::SceneLight;
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers, Theme};
use egui_kittest::kittest::Queryable as _;

#[test]
fn a_swatch_gives_its_colour() {
    let mut window = Window::sphere();
    let [red, _, blue] = middle(&window.picture());
    window.click("ketchup");
    window.settle();
    let [ketchup_red, _, ketchup_blue] = middle(&window.picture());
    assert_eq!(window.app().scene.medium.as_deref(), Some("ketchup"));
    assert!(ketchup_red / ketchup_blue > 1.5 * red / blue);
}

#[test]
fn a_coefficient_changes_the_light_of_its_channel() {
    let mut window = Window::sphere();
    let before = middle(&window.picture());
    // Of the two sliders called blue the second is absorption.
    let sliders = window.harness.get_all_by_role_and_label(Role::Slider, "blue");
    sliders.last().unwrap().set_value_accesskit(20.0);
    window.harness.run_steps(2);
    window.settle();
    let after = middle(&window.picture());
    let material = window.app().scene.material.expect("coefficients in place of a name");
    assert!(window.app().scene.medium.is_none() && (material.sigma_a[2] - 20.0).abs() < 0.1);
    assert!(after[2] < 0.6 * before[2], "{after:?} after {before:?}");
    // The tone mapper takes the least channel from all.
    assert!((after[0] / before[0] - 1.0).abs() < 0.1, "{after:?} after {before:?}");
}

#[test]
fn exposure_and_reflection_are_seen() {
    let mut window = Window::sphere();
    let before = window.picture();
    window.slide("exposure, stops", -2.0);
    window.settle();
    let dark = window.picture();
    assert!(middle(&dark)[1] < 0.7 * middle(&before)[1]);
    window.click("surface reflects");
    window.settle();
    assert!(window.app().scene.look.gloss > 0.0);
    assert!(difference(&dark, &window.picture()) > 0.1);
}

#[test]
fn lights_are_added_and_removed() {
    let mut window = Window::sphere();
    let before = middle(&window.picture());
    let lights = |window: &Window| window.app().scene.lights.as_ref().unwrap().len();
    window.click("sun");
    window.settle();
    assert_eq!(lights(&window), 3);
    assert!(matches!(window.app().scene.lights.as_ref().unwrap()[2], SceneLight::Directional { .. }));
    let lit = middle(&window.picture());
    assert!(lit[0] > 1.05 * before[0], "{lit:?} after {before:?}");
    while lights(&window) > 0 {
        window.harness.get_all_by_label("remove").next().unwrap().click_accesskit();
        window.harness.run_steps(2);
    }
    window.settle();
    // The backdrop and its dither are brighter than nothing at all.
    assert!(middle(&window.picture())[1] < 2.0, "no light, no picture");
}

#[test]
fn another_method_gives_the_same_picture_otherwise() {
    let mut window = Window::sphere();
    let before = window.picture();
    window.click("Quality");
    for (method, most) in [("tree", 0.5), ("all-pairs", 0.5), ("pattern", f64::INFINITY)] {
        window.choose("method", method);
        assert_eq!(window.app().scene.quality.method, method);
        window.settle();
        let apart = difference(&before, &window.picture());
        // One percent of linear radiance is half a step of 8 bits at the most.
        assert!(apart > 0.0 && apart < most, "{method}: {apart}");
    }
    window.choose("method", "dual");
    window.choose("texels across the atlas", "128");
    window.until("another atlas", |app| app.loaded.as_ref().is_some_and(|loaded| loaded.atlas.size == 128));
    window.settle();
    assert!(window.app().troubles.is_empty());
}

#[test]
fn keys_have_a_sheet() {
    let mut window = Window::sphere();
    assert!(!window.says("play or pause"));
    window.click("Keys");
    assert!(window.says("play or pause") && window.says("double click"));
    window.key(Modifiers::NONE, Key::F1);
    window.harness.step();
    assert!(!window.says("play or pause"));
}

#[test]
fn the_window_is_light_or_dark() {
    let mut window = Window::with(&Setup { paints: true, ..Setup::default() }, super::window::SPHERE);
    let corner = |window: &mut Window| {
        window.harness.step();
        let image = window.harness.render().unwrap();
        image.get_pixel(image.width() - 3, 40).0[0]
    };
    assert!(corner(&mut window) < 64);
    window.click("View");
    window.click("Light");
    assert_eq!(window.harness.ctx.theme(), Theme::Light);
    window.key(Modifiers::NONE, Key::Escape);
    assert!(corner(&mut window) > 192);
}
