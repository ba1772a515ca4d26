//! An hour in the hands of a monkey.

use super::super::App;
use super::super::panels::Beside;
use super::window::{SPHERE, Setup, Window, melting, obj};
use crate::overlay::Overlay;
use eframe::egui;
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::kittest::Queryable as _;
use std::path::PathBuf;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use translume::Transport;
use translume_mesh::builtin;

/// Seconds that pass in the window, however long they take.
const HOUR: f64 = 3600.0;
/// From so many seconds on, growth is what stays behind.
const LONG: f64 = 60.0;
/// glibc keeps what was freed: in an arena for each of many threads, and from blocks that grow with the largest ever freed. With those two
/// fixed, resident memory is what the program holds. Without, it rose from 375 to 654 MB within half an hour of the window's time and stayed there.
const HELD: [(&str, &str); 3] =
    [("MALLOC_ARENA_MAX", "1"), ("MALLOC_MMAP_THRESHOLD_", "131072"), ("MALLOC_TRIM_THRESHOLD_", "131072")];
/// So many times memory is looked at, the last time at the end; it counts from the second on, after a third.
const LOOKS: usize = 6;

static PANICS: AtomicUsize = AtomicUsize::new(0);

/// In a process of its own, whose memory is that of one window. `TRANSLUME_MONKEY_SECONDS` says for how long, `TRANSLUME_MONKEY_SEED` where
/// its random numbers begin.
#[test]
fn monkey() {
    let program = std::env::current_exe().unwrap();
    let words = ["app::tests::monkey::alone", "--exact", "--ignored", "--nocapture"];
    let output = Command::new(program).args(words).envs(HELD).output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(output.status.success() && out.contains("1 passed"), "{out}\n{err}");
    println!("{}", out.lines().filter(|line| line.starts_with("monkey")).collect::<Vec<_>>().join("\n"));
}

fn variable(name: &str, otherwise: f64) -> f64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(otherwise)
}

/// Of this process, where Linux tells.
fn threads() -> usize {
    std::fs::read_dir("/proc/self/task").map_or(0, Iterator::count)
}

/// Splitmix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1_u64 << 24) as f32
    }

    fn pick<'a, T>(&mut self, choices: &'a [T]) -> &'a T {
        &choices[self.below(choices.len())]
    }
}

struct Monkey {
    window: Window,
    random: Random,
    files: Vec<PathBuf>,
    size: Vec2,
    /// At rest.
    threads: Option<usize>,
}

impl Monkey {
    fn new(seed: u64) -> Self {
        let window = Window::with(
            &Setup { size: [720.0, 480.0], step: 0.5, allows_tofu: true, ..Setup::default() },
            SPHERE,
        );
        let files = vec![
            window.file("round.obj", &obj(&builtin::sphere([0.0; 3], 20.0, 2))),
            window.file("coarse.obj", &obj(&builtin::sphere([0.0; 3], 1.0, 1))),
            window.file("melting.json", &melting()),
            window.path("scene.json"),
            window.file("broken.obj", "v 0 0 nothing\nf 1 2 3\n"),
            window.file("broken.json", "{ \"shape\": 3 }"),
            window.file("empty.glb", ""),
            window.file("dark.exr", "no picture"),
            PathBuf::from("/nowhere/at.all.obj"),
        ];
        Self { window, random: Random(seed), files, size: Vec2::new(720.0, 480.0), threads: None }
    }

    /// Of the window, seconds.
    fn time(&self) -> f64 {
        self.window.harness.ctx.time()
    }

    fn place(&mut self) -> Pos2 {
        Pos2::new(self.random.unit() * self.size.x, self.random.unit() * self.size.y)
    }

    fn act(&mut self) {
        match self.random.below(16) {
            0..=5 => self.click_something(),
            6 => self.slide_something(),
            7 | 8 => self.drag(),
            9 => self.click_somewhere(),
            10 => self.turn_the_wheel(),
            11 | 12 => self.press_keys(),
            13 => self.type_something(),
            14 => {
                let file = self.files[self.random.below(self.files.len())].clone();
                self.window.drop_file(&file);
            }
            _ => {
                self.size = Vec2::new(
                    360.0 + 120.0 * self.random.below(5) as f32,
                    300.0 + 90.0 * self.random.below(4) as f32,
                );
                self.window.harness.set_size(self.size);
            }
        }
    }

    /// What large models and atlases need is no leak, but as good as one to the eye; all pairs of them take minutes.
    fn is_large(label: &str) -> bool {
        builtin::NAMES.contains(&label) || matches!(label, "256" | "512" | "1024" | "2048" | "all-pairs")
    }

    /// Everything once, so that what is kept for the next time is there: the first other model costs 60 MB, and forty more nothing.
    fn warm_up(&mut self) {
        for file in &self.files[..4] {
            let before = self.window.app().loaded.as_ref().map(|loaded| loaded.id);
            self.window.drop_file(file);
            self.window.until("the model", |app| app.loaded.as_ref().map(|loaded| loaded.id) != before);
            for method in ["tree", "pattern", "dual"] {
                self.window.app_mut().scene.quality.method = method.to_owned();
                self.window.settle();
            }
            for (overlay, _) in Overlay::ALL {
                self.window.app_mut().overlay = overlay;
                self.window.settle();
            }
        }
        // Their kernels stay, too: 80 MB in lavapipe. A solver holds as much as the finest atlas of either picture asks for.
        for atlas in [128, 64] {
            let mut scene = self.window.app().scene.clone();
            scene.quality.atlas = atlas;
            self.window.app_mut().set(scene);
            let is_there = |app: &App| app.loaded.as_ref().is_some_and(|loaded| loaded.atlas.size == atlas);
            self.window.until("the atlas", is_there);
            for transport in Transport::ALL.into_iter().rev() {
                self.window.app_mut().scene.quality.transport = transport.name().to_owned();
                let quality = self.window.app().scene.quality.clone();
                self.window.app_mut().beside = Beside::Other(quality);
                self.window.settle();
            }
        }
        self.window.app_mut().beside = Beside::Nothing;
        // The court stays, and its device has threads of its own.
        self.window.app_mut().judge();
        self.window.until("the error", |app| app.judged.is_some());
        self.threads = None;
    }

    fn click_something(&mut self) {
        let roles = [Role::Button, Role::CheckBox, Role::RadioButton, Role::ComboBox, Role::SpinButton];
        let nodes = self.window.harness.query_all_by(move |node| {
            roles.contains(&node.role()) && !node.label().is_some_and(|label| Self::is_large(&label))
        });
        let nodes: Vec<_> = nodes.collect();
        if let Some(node) = nodes.get(self.random.below(nodes.len())) {
            match self.random.below(3) {
                0 => node.click(),
                1 => node.click_secondary(),
                _ => node.click_accesskit(),
            }
        }
    }

    fn slide_something(&mut self) {
        let sliders: Vec<_> = self.window.harness.query_all_by_role(Role::Slider).collect();
        let value = match self.random.below(8) {
            0 => -1e9,
            1 => 1e9,
            2 => 0.0,
            _ => f64::from(self.random.unit()) * *self.random.pick(&[1.0, 10.0, 300.0]),
        };
        if let Some(slider) = sliders.get(self.random.below(sliders.len())) {
            slider.set_value_accesskit(value);
        }
    }

    fn button(&self, pos: Pos2, button: PointerButton, pressed: bool, modifiers: Modifiers) {
        self.window.harness.event(Event::PointerButton { pos, button, pressed, modifiers });
    }

    fn drag(&mut self) {
        let [from, to] = [self.place(), self.place()];
        let button =
            *self.random.pick(&[PointerButton::Primary, PointerButton::Primary, PointerButton::Secondary]);
        let modifiers = *self.random.pick(&[Modifiers::NONE, Modifiers::SHIFT, Modifiers::COMMAND]);
        self.window.harness.hover_at(from);
        self.button(from, button, true, modifiers);
        for k in 1..=3 {
            self.window.harness.hover_at(from.lerp(to, k as f32 / 3.0));
        }
        self.button(to, button, false, modifiers);
    }

    fn click_somewhere(&mut self) {
        let place = self.place();
        self.window.harness.hover_at(place);
        for _ in 0..=self.random.below(2) {
            self.button(place, PointerButton::Primary, true, Modifiers::NONE);
            self.button(place, PointerButton::Primary, false, Modifiers::NONE);
        }
    }

    fn turn_the_wheel(&mut self) {
        let (place, by) = (self.place(), *self.random.pick(&[-2000.0, -50.0, 50.0, 2000.0]));
        self.window.harness.hover_at(place);
        self.window.harness.event(Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: Vec2::new(0.0, by),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: *self.random.pick(&[Modifiers::NONE, Modifiers::COMMAND]),
        });
    }

    fn press_keys(&mut self) {
        let redo = Modifiers::COMMAND | Modifiers::SHIFT;
        let (modifiers, key) = *self.random.pick(&[
            (Modifiers::NONE, Key::Space),
            (Modifiers::NONE, Key::F),
            (Modifiers::NONE, Key::F1),
            (Modifiers::NONE, Key::Escape),
            (Modifiers::NONE, Key::Tab),
            (Modifiers::NONE, Key::Enter),
            (Modifiers::NONE, Key::ArrowRight),
            (Modifiers::COMMAND, Key::O),
            (Modifiers::COMMAND, Key::S),
            (Modifiers::COMMAND, Key::Z),
            (redo, Key::Z),
            (redo, Key::C),
        ]);
        self.window.harness.key_press_modifiers(modifiers, key);
    }

    fn type_something(&mut self) {
        let text = *self.random.pick(&["7", "-1", "1e30", "nan", "inf", "0", "", "abc", "½"]);
        self.window.harness.event(Event::Text(text.to_owned()));
        if self.random.below(2) == 0 {
            self.window.harness.key_press(Key::Enter);
        }
    }

    /// Everything as it was in the beginning but for what a monkey leaves behind; then resident memory, bytes.
    fn at_rest(&mut self) -> f64 {
        self.size = Vec2::new(720.0, 480.0);
        self.window.harness.set_size(self.size);
        // Time goes by in steps again.
        self.window.harness.input_mut().time = None;
        self.window.harness.key_press(Key::Enter);
        self.window.harness.step();
        let app = self.window.app_mut();
        (app.job, app.tracing, app.judging, app.judged, app.traced) = (None, None, None, None, None);
        (app.overlay, app.beside, app.playback.playing) = (Overlay::None, Beside::Nothing, false);
        app.troubles.clear();
        let scene = self.window.path("scene.json");
        let before = self.window.app().loaded.as_ref().map(|loaded| loaded.id);
        self.window.drop_file(&scene);
        self.window.until("the first scene again", |app| {
            app.job.is_none() && app.loaded.as_ref().map(|loaded| loaded.id) != before
        });
        self.window.app_mut().playback.phase = 0.0;
        self.window.settle();
        // Work that was ended holds a device until it has seen that.
        let start = Instant::now();
        while threads() > *self.threads.get_or_insert_with(threads) {
            assert!(start.elapsed() < Duration::from_secs(60), "threads stay behind");
            std::thread::sleep(Duration::from_millis(20));
        }
        let statm = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
        4096.0 * statm.split_whitespace().nth(1).and_then(|pages| pages.parse().ok()).unwrap_or(1.0)
    }
}

#[test]
#[ignore = "`monkey` runs it"]
fn alone() {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        PANICS.fetch_add(1, Ordering::Relaxed);
        hook(info);
    }));
    let seconds = variable("TRANSLUME_MONKEY_SECONDS", 20.0);
    let seed = variable("TRANSLUME_MONKEY_SEED", 1.0) as u64;
    let mut monkey = Monkey::new(seed);
    monkey.at_rest();
    monkey.warm_up();
    let (start, began) = (Instant::now(), monkey.time());
    let (mut acts, mut looks) = (0, Vec::new());
    loop {
        let share = start.elapsed().as_secs_f64() / seconds;
        if share * LOOKS as f64 >= (looks.len() + 1) as f64 {
            looks.push(monkey.at_rest());
        }
        if looks.len() == LOOKS {
            break;
        }
        monkey.act();
        acts += 1;
        let now = monkey.time().max(began + HOUR * share);
        monkey.window.harness.input_mut().time = Some(now);
        monkey.window.harness.step();
        assert_eq!(PANICS.load(Ordering::Relaxed), 0, "act {acts} of seed {seed}");
        std::thread::sleep(Duration::from_millis(1));
    }
    let grown = looks[LOOKS - 1] / looks[1] - 1.0;
    let pictures = monkey.window.app().frames.median();
    println!(
        "monkey: {acts} acts, {:.0} s of the window's time in {:.0} s, median picture {pictures:?} ms",
        monkey.time() - began,
        start.elapsed().as_secs_f64()
    );
    let megabytes: Vec<_> = looks.iter().map(|bytes| format!("{:.1}", bytes / 1e6)).collect();
    println!("monkey: {} MB, {:+.1} % after a third", megabytes.join(", "), 100.0 * grown);
    assert_eq!(PANICS.load(Ordering::Relaxed), 0);
    // What is promised of an hour. In seconds, what is needed for the first time and kept weighs more: 1.4 and 4.0 % in two runs of 20 s on lavapipe. A picture that stays
    // behind for every act would be more than tenfold.
    let most = if seconds < LONG { 0.15 } else { 0.05 };
    assert!(grown < most, "{grown}");
}
