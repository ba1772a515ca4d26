//! The window's thread never waits for the others.

use super::window::{SPHERE, Setup, Window, obj};
use std::time::{Duration, Instant};
use translume_mesh::builtin;

/// How long this thread was kept from a processor so far, as Linux counts; elsewhere that is not known.
fn queued() -> Duration {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = text.split_whitespace().nth(1).and_then(|word| word.parse().ok());
    Duration::from_nanos(nanoseconds.unwrap_or(0))
}

/// The longest step until something is so: by the clock, and without the time that others had the processor.
fn longest(window: &mut Window, is_done: impl Fn(&Window) -> bool) -> [Duration; 2] {
    let (start, mut longest) = (Instant::now(), [Duration::ZERO; 2]);
    while !is_done(window) {
        assert!(start.elapsed() < Duration::from_secs(60), "not done in a minute");
        let (clock, others) = (Instant::now(), queued());
        window.harness.step();
        let wall = clock.elapsed();
        let own = wall.saturating_sub(queued() - others);
        longest = [longest[0].max(wall), longest[1].max(own)];
        std::thread::sleep(Duration::from_millis(2));
    }
    longest
}

#[test]
fn the_window_answers_while_models_open_and_pictures_are_drawn() {
    let mut window = Window::with(&Setup { size: [1280.0, 800.0], ..Setup::default() }, SPHERE);
    window.app_mut().playback.playing = true;
    // 20,480 triangles, and pictures that go on being drawn.
    let model = window.file("model.obj", &obj(&builtin::sphere([0.0; 3], 20.0, 5)));
    let before = window.app().loaded.as_ref().map(|loaded| loaded.id);
    window.drop_file(&model);
    let opening =
        longest(&mut window, |window| window.app().loaded.as_ref().map(|loaded| loaded.id) != before);
    window.app_mut().playback.playing = false;
    let drawing = longest(&mut window, |window| {
        window.app().ordered.as_ref().is_some_and(|wish| wish.samples == 2) && !window.app().is_waiting
    });
    for (name, [wall, own]) in [("opening", opening), ("drawing", drawing)] {
        println!("{name}: longest step {wall:.1?}, of which not in a queue for a processor {own:.1?}");
        // What is promised of the window's thread. A picture alone takes longer than that here: waiting for one would be seen.
        assert!(own < Duration::from_millis(50), "{name}: {own:?}");
    }
    assert!(window.app().frames.median().unwrap() > 0.0);
}
