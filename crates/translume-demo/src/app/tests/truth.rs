//! What lies behind the picture, and what lies beside it.

use super::super::App;
use super::window::{SPHERE, Setup, Window, difference};
use crate::overlay::Overlay;
use eframe::egui::Vec2;

#[test]
fn every_overlay_is_a_picture_of_its_own() {
    let mut window = Window::sphere();
    window.click("Behind the picture");
    let mut seen = vec![window.picture()];
    for (overlay, name) in Overlay::ALL.into_iter().skip(1) {
        window.choose("shown", name);
        assert_eq!(window.app().overlay, overlay);
        window.until("the overlay's picture", |app| {
            !app.is_waiting && app.ordered.as_ref().is_some_and(|wish| wish.overlay == overlay)
        });
        window.harness.step();
        assert_eq!(window.atlas().map(|atlas| atlas.size), Some([64; 2]), "{name}");
        let picture = window.picture();
        for (k, other) in seen.iter().enumerate().filter(|(_, other)| other.size == picture.size) {
            let apart = difference(&picture, other);
            // On a sphere around the origin positions and normals are alike but for the triangles' corners.
            assert!(apart > 0.1, "{name} and number {k}: {apart}");
        }
        seen.push(picture);
    }
    assert!(window.says("Atlas"));
    window.click("the atlas in a window");
    window.harness.step();
    assert!(!window.app().shows_atlas && !window.says("Atlas"));
    window.choose("shown", "picture");
    window.settle();
    assert_eq!(difference(&seen[0], &window.picture()), 0.0, "the picture is what it was");
}

#[test]
fn errors_are_computed_beside_the_window() {
    let mut window = Window::sphere();
    window.click("Behind the picture");
    window.choose("shown", "error against all pairs");
    window.click("Compute error");
    window.until("the errors", |app| app.judged.is_some());
    window.until("their picture", |app| {
        !app.is_waiting && app.ordered.as_ref().is_some_and(|wish| !wish.errors.is_empty())
    });
    let judged = window.app().judged.as_ref().unwrap();
    // What dual promises, and what a comparison with itself would give.
    assert!(judged.rms < 0.01 && judged.rms > 0.0, "{}", judged.rms);
    assert!(window.says("rms of the mean"));
}

#[test]
fn another_way_lies_beside() {
    let mut window = Window::sphere();
    assert!(window.other().is_none());
    window.click("Beside the picture");
    window.click("another way");
    window.settle();
    let same = window.other().expect("a picture beside");
    assert_eq!(difference(&same, &window.picture()), 0.0);
    window.choose("its profile", "dipole");
    window.until("the dipole", |app| {
        !app.is_waiting
            && app
                .ordered
                .as_ref()
                .is_some_and(|wish| wish.other.as_ref().is_some_and(|other| other.profile == "dipole"))
    });
    window.settle();
    let dipole = window.other().unwrap();
    assert!(difference(&dipole, &window.picture()) > 0.3, "{}", difference(&dipole, &window.picture()));
    // The line between them is in the middle, and moves.
    let camera = window.app().scene.camera;
    let middle = window.view().center();
    window.drag(middle, Vec2::new(50.0, 0.0));
    window.click("nothing");
    window.settle();
    assert_eq!(window.app().scene.camera, camera, "the line was dragged, not the camera");
    assert!(window.other().is_none());
}

#[test]
fn paths_are_followed_and_stopped() {
    // Paths meet no point through a surface that refracts.
    let extended = SPHERE.replace(r#""point", "position""#, r#""sphere", "radius": 5, "center""#);
    let extended = extended.replace(r#""intensity": [3000, 3000, 3000]"#, r#""radiance": [40, 40, 40]"#);
    let mut window = Window::with(&Setup::default(), &extended);
    window.click("Beside the picture");
    window.click("ground truth");
    window.click("Follow paths");
    window.until("a first picture by paths", |app| app.traced.is_some());
    window.harness.step();
    let first = window.paths().expect("a picture by paths");
    assert!(first.pixels.iter().any(|pixel| pixel.r() > 60), "something is lit");
    let noise = |app: &App| app.traced.as_ref().map_or(f64::INFINITY, |traced| traced.noise);
    let begun = noise(window.app());
    window.until("less noise", |app| noise(app) < begun);
    window.harness.step();
    assert!(window.says("so far in"));
    window.click("Stop");
    assert!(window.app().tracing.is_none());
    let ended = noise(window.app());
    std::thread::sleep(std::time::Duration::from_millis(500));
    window.harness.run_steps(3);
    assert_eq!(noise(window.app()), ended, "nothing comes after the end");
    assert!(!window.says("has changed since"));
    window.slide("exposure, stops", 1.0);
    window.settle();
    window.harness.step();
    assert!(window.says("has changed since"));
}
