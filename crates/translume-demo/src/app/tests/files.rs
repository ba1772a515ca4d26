//! Files that come and go.

use super::super::App;
use super::super::events::{Choice, Event};
use super::super::panels;
use super::window::{SPHERE, Setup, Window, difference, middle, obj};
use crate::scene::{Scene, Shape};
use std::path::Path;
use std::time::Duration;
use translume_mesh::builtin;

fn triangles(app: &App) -> usize {
    app.loaded.as_ref().map_or(0, |loaded| loaded.opened.model.mesh.triangles.len())
}

#[test]
fn a_built_in_opens_from_the_menu() {
    let mut window = Window::sphere();
    let [red, _, blue] = middle(&window.picture());
    window.click("File");
    window.click("Built-in models");
    window.click_first("torus-knot");
    window.until("the knot", |app| triangles(app) > 320);
    window.settle();
    assert!(matches!(&window.app().scene.shape, Shape::Builtin { name, .. } if name == "torus-knot"));
    // A software adapter is not asked for as much as a graphics card.
    let software = window.app().adapter.as_ref().is_some_and(|adapter| adapter.is_software);
    assert_eq!(window.app().scene.quality.atlas, if software { 256 } else { 512 });
    // In jade, as every model; and wax is not green.
    let [jade_red, _, jade_blue] = middle(&window.picture());
    assert!(jade_red / jade_blue < 0.8 * red / blue);
}

#[test]
fn models_and_scenes_open_where_they_are_dropped() {
    let mut window = Window::sphere();
    let model = window.file("coarse.obj", &obj(&builtin::sphere([0.0; 3], 20.0, 1)));
    window.drop_file(&model);
    window.until("80 triangles", |app| triangles(app) == 80);
    assert_eq!(window.app().recent.first(), Some(&model));
    // Without a unit it is as large as something in a hand: 100 mm from corner to corner.
    let diagonal = window.app().loaded.as_ref().unwrap().opened.model.diagonal().unwrap();
    assert!((window.app().scene.mm_per_unit() * diagonal - 100.0).abs() < 0.01);

    let scene = window.file("other.json", &SPHERE.replace("wax", "ketchup"));
    window.drop_file(&scene);
    window.until("the scene's model", |app| triangles(app) == 320);
    assert_eq!(window.app().scene.medium.as_deref(), Some("ketchup"));
    assert_eq!(window.app().scene.mm_per_unit, Some(1.0));
    window.settle();
    // Both are remembered, the newest first, and only the sphere's colour is another.
    assert_eq!(window.app().recent[..2], [scene, model]);
    let [red, green, _] = middle(&window.picture());
    assert!(red > 1.3 * green, "ketchup is red: {red} {green}");
}

#[test]
fn a_bad_file_says_why_and_the_window_goes_on() {
    let mut window = Window::sphere();
    let bad = [
        ("broken.obj", "v 0 0 nothing\nf 1 2 3\n", "broken.obj"),
        ("broken.json", "{ \"shape\": 3 }", "is not a scene"),
        ("strange.xyz", "what is this", "strange.xyz"),
    ];
    for (name, text, words) in bad {
        let path = window.file(name, text);
        window.drop_file(&path);
        window.until(name, |app| app.troubles.iter().any(|trouble| trouble.contains(words)));
        window.harness.step();
        assert!(window.says(words), "{name} is spoken of in the window");
    }
    window.drop_file(Path::new("/nowhere/at.all.obj"));
    window.until("a file that is not there", |app| app.troubles.len() == 4);
    assert_eq!(triangles(window.app()), 320);

    let before = middle(&window.picture());
    window.app_mut().scene.look.exposure = -2.0;
    window.settle();
    assert!(middle(&window.picture())[1] < 0.7 * before[1], "it still draws");
    for left in (0..4).rev() {
        window.click_first("close");
        assert_eq!(window.app().troubles.len(), left);
    }
}

#[test]
fn what_is_being_opened_can_be_stopped() {
    let mut window = Window::sphere();
    // 81,920 triangles: unwrapping them takes seconds.
    let large = window.file("large.obj", &obj(&builtin::sphere([0.0; 3], 20.0, 6)));
    window.drop_file(&large);
    window.until("progress", |app| app.job.as_ref().is_some_and(|job| job.stage != "starting"));
    window.harness.step();
    window.click("Cancel");
    assert!(window.app().job.is_none());
    assert_eq!(triangles(window.app()), 320);
    // The work ends, rather than being ignored: nothing is heard of it any more. A stage tells of itself a hundred times.
    std::thread::sleep(Duration::from_millis(300));
    let _ = window.app_mut().inbox.try_iter().count();
    std::thread::sleep(Duration::from_millis(500));
    let heard = window.app_mut().inbox.try_iter();
    let working =
        heard.filter(|event| matches!(event, Event::Progress { .. } | Event::Opened { .. })).count();
    assert_eq!(working, 0);
    // The next file is opened as ever.
    let model = window.file("coarse.obj", &obj(&builtin::sphere([0.0; 3], 20.0, 1)));
    window.drop_file(&model);
    window.until("80 triangles", |app| triangles(app) == 80);
}

#[test]
fn pictures_and_scenes_are_saved() {
    let mut window = Window::sphere();
    window.app_mut().scene.look.exposure = 0.5;
    window.settle();
    let [png, exr, json] = ["a.png", "a.exr", "a.json"].map(|name| window.path(name));
    panels::chosen(window.app_mut(), Choice::SavePicture, &png);
    panels::chosen(window.app_mut(), Choice::SavePicture, &exr);
    panels::chosen(window.app_mut(), Choice::SaveScene, &json);
    window.until("three notices", |app| app.notices.len() == 3);
    // The file is what the window shows: the same samples, developed by the processor. One step of 8 bits of dither apart.
    let shown = window.picture();
    let saved = image::open(&png).unwrap().to_rgba8();
    assert_eq!([saved.width() as usize, saved.height() as usize], shown.size);
    let saved = eframe::egui::ColorImage::from_rgba_unmultiplied(shown.size, &saved);
    assert!(difference(&shown, &saved) < 0.6, "{}", difference(&shown, &saved));
    assert!(std::fs::metadata(&exr).unwrap().len() > 1000);
    let scene = Scene::read(&json).unwrap();
    assert_eq!(scene, window.app().ordered.as_ref().unwrap().scene);

    panels::chosen(window.app_mut(), Choice::SavePicture, Path::new("/nowhere/a.png"));
    panels::chosen(window.app_mut(), Choice::SavePicture, Path::new("a.gif"));
    panels::chosen(window.app_mut(), Choice::SaveScene, Path::new("/nowhere/a.json"));
    assert_eq!(window.app().troubles.len(), 3);
}

#[test]
fn the_first_model_is_told_of() {
    let mut window = Window::bare(&Setup::default(), "sphere");
    window.until("the sphere", |app| app.loaded.is_some());
    window.harness.step();
    assert!(window.says("20480 triangles"));
    let missing = Window::bare(&Setup::default(), "no-such-model.obj");
    let mut window = missing;
    window.until("words", |app| app.troubles.iter().any(|trouble| trouble.contains("no-such-model")));
    assert!(window.app().loaded.is_none());
}
