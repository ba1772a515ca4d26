//! The window: a model, its light and what it is made of, and a picture that follows every change.
//!
//! The window's thread never waits: models are opened by [`loaded::Job`], pictures drawn by [`worker::Worker`], and both tell what
//! they have done through [`events`]. What the picture shows is a [`Scene`], the same that `translume render --scene` takes.

mod easel;
mod events;
mod export;
mod ground;
mod hear;
mod loaded;
mod orbit;
mod order;
mod panels;
mod playback;
mod task;
#[cfg(test)]
mod tests;
mod truth;
mod viewport;
#[cfg(target_arch = "wasm32")]
pub mod web;
mod worker;

#[cfg(not(target_arch = "wasm32"))]
use crate::error::Error;
use crate::overlay::Overlay;
use crate::scene::{Quality, Scene};
use eframe::egui;
use egui::util::undoer::Undoer;
use events::{Choice, Event, Events};
use export::{Exporting, Settings};
use loaded::{Job, Loaded, Wanted};
use playback::Playback;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use task::Task;
use truth::{Court, Judged, Traced};
use worker::{Adapter, Counters, Wish, Worker};

/// What is shown first.
const FIRST: &str = "creature";
/// Whether the window is a page: it has one thread and no disk.
const IN_BROWSER: bool = cfg!(target_arch = "wasm32");
/// What was done that is remembered.
const NOTICES: usize = 8;
/// Files that are remembered.
const RECENT: usize = 8;

/// Everything that is kept between runs.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
struct Memory {
    scene: Option<Scene>,
    recent: Vec<PathBuf>,
    playback: Playback,
    export: Settings,
}

/// What the window opens with.
enum First {
    Name(String),
    Scene(Box<Scene>),
}

/// The program's window.
pub struct App {
    /// What the user has set.
    scene: Scene,
    loaded: Option<Arc<Loaded>>,
    job: Option<Job>,
    export: Settings,
    exporting: Option<Exporting>,
    /// Whether the job's scene takes the place of all that is set, and not only of the model.
    replaces: bool,
    playback: Playback,
    recent: Vec<PathBuf>,
    undoer: Undoer<Scene>,

    events: Events,
    inbox: Receiver<Event>,
    worker: Worker,
    adapter: Option<Adapter>,
    /// What is opened once the adapter is known.
    first: Option<First>,
    /// The picture that the worker is at, or was at last.
    ordered: Option<Wish>,
    /// What is set in a picture that could be shown.
    good: Option<Scene>,
    /// What was set when the last picture was ordered.
    asked: Option<Scene>,
    is_waiting: bool,
    picture: Option<egui::TextureHandle>,
    overlay: Overlay,
    atlas: Option<egui::TextureHandle>,
    shows_atlas: bool,
    counters: Option<Counters>,
    judging: Option<Task>,
    court: Court,
    judged: Option<Judged>,
    no_errors: Arc<Vec<f32>>,
    beside: panels::Beside,
    /// The picture beside, where there is one.
    other: Option<egui::TextureHandle>,
    tracing: Option<Task>,
    traced: Option<Traced>,
    /// What was traced.
    traced_scene: Option<Scene>,
    paths: Option<egui::TextureHandle>,
    frames: panels::Frames,
    /// When something last changed, and when the window was last drawn; seconds.
    changed: f64,
    drawn: f64,
    troubles: Vec<String>,
    notices: Vec<String>,
    shows_keys: bool,
    view: viewport::Viewport,
}

/// Opens the window, on a model or a scene if one is named, and stays until it is closed.
#[cfg(not(target_arch = "wasm32"))]
pub fn run(name: Option<&str>) -> Result<(), Error> {
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Translume")
            .with_app_id("translume")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([720.0, 480.0])
            .with_drag_and_drop(true),
        ..Default::default()
    };
    let start: eframe::AppCreator<'_> = Box::new(|context| Ok(Box::new(App::new(context, name))));
    eframe::run_native("translume", options, start).map_err(|error| Error::Window(error.to_string()))
}

impl App {
    /// With what was set when it was last closed, or with the model or scene of this name.
    pub fn new(context: &eframe::CreationContext<'_>, name: Option<&str>) -> Self {
        let memory =
            context.storage.and_then(|storage| eframe::get_value::<Memory>(storage, eframe::APP_KEY));
        let Memory { scene, recent, playback, export } = memory.unwrap_or_default();
        let (events, inbox) = Events::new(context.egui_ctx.clone());
        let mut app = Self {
            scene: Scene::of_model(FIRST),
            loaded: None,
            job: None,
            export,
            exporting: None,
            replaces: true,
            playback,
            recent,
            undoer: Undoer::default(),
            worker: Worker::start(&events),
            events,
            inbox,
            adapter: None,
            first: None,
            ordered: None,
            good: None,
            asked: None,
            is_waiting: false,
            picture: None,
            overlay: Overlay::None,
            atlas: None,
            shows_atlas: true,
            counters: None,
            judging: None,
            court: Court::default(),
            judged: None,
            no_errors: Arc::default(),
            beside: panels::Beside::Nothing,
            other: None,
            tracing: None,
            traced: None,
            traced_scene: None,
            paths: None,
            frames: panels::Frames::default(),
            changed: 0.0,
            drawn: 0.0,
            troubles: Vec::new(),
            notices: Vec::new(),
            shows_keys: false,
            view: viewport::Viewport::default(),
        };
        app.first = Some(match (name, scene) {
            (None, Some(scene)) => First::Scene(Box::new(scene)),
            (name, _) => First::Name(name.unwrap_or(FIRST).to_owned()),
        });
        app
    }

    /// Opens a model or a scene, or takes a map of the sky for the light or a picture for the albedo.
    fn open(&mut self, name: &str) {
        let path = Path::new(name);
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        if panels::MAPS.contains(&ending.as_str()) {
            return panels::light_from(self, path);
        }
        if panels::TEXTURES.contains(&ending.as_str()) {
            return panels::albedo_from(self, path);
        }
        match loaded::scene_of(name, self.quality()) {
            Ok(wanted) => {
                self.remember(name);
                self.start(wanted, true);
            }
            Err(error) => self.trouble(&error),
        }
    }

    /// What a model is computed with if nothing is said: a processor gets a quarter of the texels, and so does a page, which unwraps on one.
    fn quality(&self) -> Quality {
        if IN_BROWSER || self.adapter.as_ref().is_some_and(|adapter| adapter.is_software) {
            Quality { atlas: 256, shadow: 1024, directions: 64, ..Quality::default() }
        } else {
            Quality::default()
        }
    }

    fn remember(&mut self, name: &str) {
        let Ok(path) = std::path::absolute(name) else { return };
        if path.is_file() {
            self.recent.retain(|other| *other != path);
            self.recent.insert(0, path);
            self.recent.truncate(RECENT);
        }
    }

    /// Opens the model of a scene; what was being opened is dropped.
    fn start(&mut self, wanted: Wanted, replaces: bool) {
        self.replaces = replaces;
        self.job = Some(Job::start(wanted, self.loaded.as_ref(), &self.events));
    }

    /// Makes this the scene, and its model another if it asks for that.
    fn set(&mut self, scene: Scene) {
        if self.loaded.as_ref().is_some_and(|loaded| loaded.fits(&scene)) {
            self.scene = scene;
        } else {
            self.start(Wanted { scene, assumes_size: false }, false);
        }
    }

    fn trouble(&mut self, error: &dyn std::fmt::Display) {
        let words = error.to_string();
        if !self.troubles.contains(&words) {
            self.troubles.push(words);
        }
    }

    /// Keeps changes for [`Self::undo`]; where the camera stands is not one.
    fn note(&mut self, now: f64) {
        let state = Scene { camera: None, ..self.scene.clone() };
        self.undoer.feed_state(now, &state);
    }

    fn undo(&mut self, again: bool) {
        let state = Scene { camera: None, ..self.scene.clone() };
        let other = if again { self.undoer.redo(&state) } else { self.undoer.undo(&state) };
        if let Some(other) = other.cloned() {
            let camera = self.scene.camera;
            self.set(Scene { camera, ..other });
        }
    }

    /// The model as large as the view.
    fn frame_all(&mut self) {
        let Some(loaded) = &self.loaded else { return };
        let scene = Scene { camera: None, ..self.scene.clone() };
        match loaded.opened.subject(&scene) {
            Ok(subject) => {
                self.scene.camera = Some(crate::setup::camera(&scene, &subject, crate::setup::VIEW));
            }
            Err(error) => self.trouble(&error),
        }
    }

    /// Asks for a file without keeping the window waiting.
    fn ask(&self, choice: Choice) {
        // Nobody would answer.
        if cfg!(test) {
            return;
        }
        #[cfg(target_arch = "wasm32")]
        web::ask(choice, &self.events);
        #[cfg(not(target_arch = "wasm32"))]
        {
            let events = self.events.clone();
            std::thread::spawn(move || {
                if let Some(path) = panels::dialogue(choice) {
                    events.send(Event::Chosen(choice, path));
                }
            });
        }
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        let now = context.input(|input| input.time);
        self.hear(&context);
        if let Some(play) = self.play() {
            self.playback.advance(play, (now - self.drawn).clamp(0.0, 1.0) as f32);
        }
        self.drawn = now;
        // The last one is shown.
        self.notices.drain(..self.notices.len().saturating_sub(NOTICES));
        panels::keys(self, &context);
        let dropped = context.input(|input| input.raw.dropped_files.clone());
        #[cfg(target_arch = "wasm32")]
        if !dropped.is_empty() {
            web::take(dropped, &self.events);
        }
        #[cfg(not(target_arch = "wasm32"))]
        for path in dropped.iter().map(|file| file.path().to_owned()) {
            self.open(&path.to_string_lossy());
        }
        panels::show(self, ui);
        viewport::show(self, ui);
        self.note(now);
        self.order(&context, now);
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        let scene = self.loaded.as_ref().map(|_| self.scene.clone());
        // What was handed to a page is gone with it.
        let scene = scene.filter(|scene| !IN_BROWSER || scene.shape.file(Path::new("")).is_none());
        let (recent, playback, export) = (self.recent.clone(), self.playback, self.export);
        let memory = Memory { scene, recent, playback, export };
        eframe::set_value(storage, eframe::APP_KEY, &memory);
    }

    fn on_exit(&mut self) {
        if let Some(exporting) = self.exporting.take() {
            exporting.end();
        }
        self.frames.tell();
    }
}
