//! What the window looks like, held against pictures that were looked at.
//!
//! `UPDATE_SNAPSHOTS=true cargo test -p translume-demo snapshots` makes those that differ anew; look at them before they are
//! committed.

use super::super::panels::Frames;
use super::super::worker::Adapter;
use super::window::{SPHERE, Setup, Window};
use eframe::egui::Theme;
use egui_kittest::SnapshotOptions;

/// A small window, in which nothing tells of the machine and its speed.
fn window(theme: Theme) -> Window {
    let mut window =
        Window::with(&Setup { size: [720.0, 480.0], theme, paints: true, ..Setup::default() }, SPHERE);
    window.app_mut().adapter = Some(Adapter { name: "some adapter".to_owned(), is_software: false });
    window.app_mut().frames = Frames::default();
    window.harness.run_steps(4);
    window
}

/// Squared distances of colours up to 0.6, the library's own, which hides no step of more than two or three of 255. Ten pixels may be further
/// apart, as rasterisers may differ at the silhouette: none was in repeated runs on Mesa's lavapipe, and a letter has more.
fn check(window: &mut Window, name: &str) {
    let options = SnapshotOptions::new().threshold(0.6).max_failed_pixels(10);
    window.harness.check_accessibility();
    window.harness.snapshot_options(name, &options);
}

#[test]
fn a_sphere_of_wax() {
    check(&mut window(Theme::Dark), "wax");
}

#[test]
fn in_a_light_window() {
    let mut window = window(Theme::Light);
    window.harness.mask(window.view());
    check(&mut window, "light");
}

#[test]
fn the_sheet_of_keys() {
    let mut window = window(Theme::Dark);
    window.click("Keys");
    window.harness.run_steps(4);
    check(&mut window, "keys");
}

#[test]
fn an_error() {
    let mut window = window(Theme::Dark);
    window.app_mut().trouble(&"teapot.obj: line 3: \"v 0 0 nothing\" is no vertex; give three numbers");
    window.settle();
    window.app_mut().frames = Frames::default();
    window.harness.run_steps(4);
    window.harness.mask(window.view());
    check(&mut window, "error");
}

#[test]
fn a_difference_and_a_lack_are_noticed() {
    let mut window = window(Theme::Dark);
    let options = SnapshotOptions::new().threshold(0.6).max_failed_pixels(10);
    window.slide("exposure, stops", 0.25);
    window.settle();
    window.app_mut().frames = Frames::default();
    window.harness.run_steps(4);
    let image = window.harness.render().unwrap();
    // In a folder of its own: what failed is left beside what it was held against.
    let (folder, golden) = (window.path(""), concat!(env!("CARGO_MANIFEST_DIR"), "/tests/snapshots/wax.png"));
    std::fs::copy(golden, folder.join("wax.png")).unwrap();
    let options = options.output_path(folder);
    for name in ["wax", "missing"] {
        assert!(egui_kittest::try_image_snapshot_options(&image, name, &options).is_err(), "{name}");
    }
}
