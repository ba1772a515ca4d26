//! One round of what is played, frame by frame into files, while the window goes on.

use super::loaded::Loaded;
use super::playback::{Play, Playback};
use super::worker::Wish;
use crate::error::Error;
use crate::film::{Film, Numbered, is_pattern};
use crate::overlay::Overlay;
use crate::picture::{Develop, Format, Output, Picture};
use crate::scene::Scene;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

/// How long a window that closes waits for files to be tidied away: a frame's time on a slow adapter.
const PATIENCE: Duration = Duration::from_secs(5);

/// What the user sets.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// 2..=600.
    pub frames: u32,
    /// Frames a second.
    pub rate: f32,
    /// Pixels along each side per pixel of the view, 1 or 2.
    pub factor: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self { frames: 48, rate: 24.0, factor: 1 }
    }
}

/// Work under way, as the window knows it.
pub struct Exporting {
    pub done: u32,
    pub total: u32,
    cancelled: Arc<AtomicBool>,
    ended: Receiver<()>,
}

impl Exporting {
    /// Nothing stays behind.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Cancels and waits until nothing is left.
    pub fn end(self) {
        self.cancel();
        // Nothing is ever sent: the other end goes when the files have gone.
        let _ = self.ended.recv_timeout(PATIENCE);
    }
}

/// The same as the worker knows it.
pub struct Export {
    scene: Scene,
    loaded: Arc<Loaded>,
    pixels: [u32; 2],
    play: Play,
    done: u32,
    pub total: u32,
    files: Files,
    cancelled: Arc<AtomicBool>,
    /// After the files, which go first.
    _ended: Sender<()>,
}

enum Files {
    Film(Box<Film>, PathBuf),
    Numbered(Numbered),
}

impl Export {
    /// Of what a scene plays in a view of so many pixels; numbered files if asked for, or if the name has a number's place.
    pub fn new(
        scene: Scene,
        loaded: Arc<Loaded>,
        view: [u32; 2],
        settings: Settings,
        (path, is_numbered): (&Path, bool),
    ) -> Result<(Self, Exporting), Error> {
        let Settings { frames: total, rate, factor } = settings;
        let files = if is_numbered || is_pattern(path) {
            Files::Numbered(Numbered::new(path, total)?)
        } else {
            let mut output = Output::new(path)?;
            output.frame_seconds = 1.0 / rate;
            Files::Film(Box::new(output.film(total)?), path.to_owned())
        };
        let cancelled = Arc::new(AtomicBool::new(false));
        let (sender, ended) = channel();
        let play = Play::of(&scene, &loaded.opened.model);
        let pixels = view.map(|pixels| pixels * factor);
        let exporting = Exporting { done: 0, total, cancelled: Arc::clone(&cancelled), ended };
        let export = Self { scene, loaded, pixels, play, done: 0, total, files, cancelled, _ended: sender };
        Ok((export, exporting))
    }

    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    fn format(&self) -> Format {
        match &self.files {
            Files::Film(..) => Format::Png,
            Files::Numbered(numbered) => numbered.format,
        }
    }

    /// What becomes of the samples of a frame.
    pub fn develop(&self) -> Develop {
        self.format().develop(self.scene.look.exposure)
    }

    /// The frame to draw next, or `None` where all are there.
    pub fn next(&self) -> Option<Wish> {
        let phase = self.done as f32 / self.total as f32;
        let playback = Playback { playing: true, phase, ..Playback::default() };
        (self.done < self.total).then(|| Wish {
            scene: playback.moment(&self.scene, &self.loaded.opened.model, self.pixels),
            loaded: Arc::clone(&self.loaded),
            pixels: self.pixels,
            samples: self.format().samples(),
            moving: self.play != Play::Turn,
            overlay: Overlay::None,
            errors: Arc::default(),
            other: None,
        })
    }

    /// How many frames there are now.
    pub fn add(&mut self, picture: &Picture) -> Result<u32, Error> {
        match &mut self.files {
            Files::Film(film, _) => film.add(picture)?,
            Files::Numbered(numbered) => numbered.add(picture)?,
        }
        self.done += 1;
        Ok(self.done)
    }

    /// Puts what was written in its place, and says where that is.
    pub fn finish(self) -> Result<PathBuf, Error> {
        match self.files {
            Files::Film(film, path) => film.finish().map(|()| path),
            Files::Numbered(numbered) => numbered.finish(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::events::{Event, Events};
    use super::super::loaded::{Job, Wanted};
    use super::super::worker::{Order, Worker};
    use super::*;
    use crate::scene::Quality;
    use eframe::egui;

    const VIEW: [u32; 2] = [32, 24];

    struct Desk {
        directory: tempfile::TempDir,
        scene: Scene,
        loaded: Arc<Loaded>,
        events: Events,
        inbox: Receiver<Event>,
    }

    impl Desk {
        fn new() -> Self {
            let mut scene = Scene::of_model("creature");
            scene.quality = Quality { atlas: 64, shadow: 128, directions: 8, ..Quality::default() };
            let (events, inbox) = Events::new(egui::Context::default());
            let _job = Job::start(Wanted { scene, assumes_size: true }, None, &events);
            let opened = inbox.iter().find_map(|event| match event {
                Event::Opened { result, .. } => Some(result.unwrap()),
                _ => None,
            });
            let (scene, loaded) = *opened.unwrap();
            Self { directory: tempfile::tempdir().unwrap(), scene, loaded, events, inbox }
        }

        fn export(&self, name: &str, frames: u32) -> Result<(Export, Exporting), Error> {
            let settings = Settings { frames, factor: 2, ..Settings::default() };
            let path = self.directory.path().join(name);
            Export::new(self.scene.clone(), Arc::clone(&self.loaded), VIEW, settings, (&path, false))
        }

        fn files(&self) -> Vec<String> {
            let files = std::fs::read_dir(self.directory.path()).unwrap();
            let mut names: Vec<_> =
                files.map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
            names.sort();
            names
        }
    }

    #[test]
    fn frames_are_those_of_a_round() {
        let desk = Desk::new();
        let (mut export, _) = desk.export("%d.png", 4).unwrap();
        let mut weights = Vec::new();
        while let Some(wish) = export.next() {
            assert_eq!(wish.pixels, [64, 48], "twice the view");
            weights.push(wish.scene.morph[0]);
            export.add(&Picture { width: 1, height: 1, pixels: vec![[0.5; 3]] }).unwrap();
        }
        // There and back in four steps: exact but for the rounding of a cosine.
        let errors = weights.iter().zip([0.0, 0.5, 1.0, 0.5]).map(|(a, b): (&f32, f32)| (a - b).abs());
        assert!(weights.len() == 4 && errors.fold(0.0, f32::max) < 1e-6, "{weights:?}");
    }

    #[test]
    fn the_window_goes_on_while_a_film_is_written() {
        let desk = Desk::new();
        let worker = Worker::start(&desk.events);
        let (export, exporting) = desk.export("film.png", 3).unwrap();
        let wish = Wish { pixels: VIEW, ..export.next().unwrap() };
        worker.order(Order::Export(Box::new(export)));
        let mut heard = Vec::new();
        for event in desk.inbox.iter() {
            match event {
                Event::Exporting { done } => {
                    heard.push("frame");
                    if done == 1 {
                        worker.order(Order::Show(wish.clone()));
                    }
                }
                Event::Shown(shown) => heard.push(if shown.is_ok() { "shown" } else { "trouble" }),
                Event::Exported(result) => {
                    assert!(result.unwrap().unwrap().ends_with("film.png"));
                    break;
                }
                _ => {}
            }
        }
        heard.sort_unstable();
        assert_eq!(heard, ["frame", "frame", "frame", "shown"]);
        exporting.end();
        assert_eq!(desk.files(), ["film.png"]);

        let (export, exporting) = desk.export("f%02d.exr", 500).unwrap();
        worker.order(Order::Export(Box::new(export)));
        desk.inbox.iter().find(|event| matches!(event, Event::Exporting { done: 2 })).unwrap();
        assert_eq!(desk.files().len(), 2, "frames wait in a folder");
        exporting.cancel();
        assert!(desk.inbox.iter().any(|event| matches!(event, Event::Exported(Ok(None)))));
        assert_eq!(desk.files(), ["film.png"]);
        let words = desk.export("film.exr", 3).err().unwrap().to_string();
        assert!(words.contains("film.exr: only a PNG can be animated"), "{words}");
    }
}
