//! The window as a page: a browser has one thread, no disk, and dialogues of its own.

use super::App;
use super::events::{Choice, Event, Events};
use super::panels::{MAPS, MODELS, TEXTURES};
use crate::files;
use eframe::{WebOptions, WebRunner, egui};
use gloo_timers::future::TimeoutFuture;
use std::path::{Path, PathBuf};
use translume_mesh::load::LoadError;
use wasm_bindgen::JsCast as _;
use wasm_bindgen_futures::spawn_local;

/// Longer than a picture of the window takes, ms.
const PICTURE_MS: u32 = 50;

/// Opens the window on the page's element `canvas`; what goes wrong is said in the element `words`.
pub fn start() {
    console_error_panic_hook::set_once();
    // A console that somebody else writes to already stays as it is.
    let _ = eframe::WebLogger::init(log::LevelFilter::Info);
    let Some(document) = web_sys::window().and_then(|window| window.document()) else { return };
    let words = document.get_element_by_id("words");
    let canvas = document.get_element_by_id("canvas").and_then(|element| element.dyn_into().ok());
    spawn_local(async move {
        let result = match canvas {
            Some(canvas) => {
                let start: eframe::AppCreator<'_> = Box::new(|context| Ok(Box::new(App::new(context, None))));
                WebRunner::new().start(canvas, WebOptions::default(), start).await
            }
            None => Err("the page has no canvas of the id `canvas`; add one".into()),
        };
        if let Some(words) = words {
            match result {
                Ok(()) => words.remove(),
                Err(error) => words.set_text_content(Some(&format!(
                    "No window can be opened: {error:?}. Translume needs WebGPU, which newer browsers have."
                ))),
            }
        }
    });
}

/// Ends once the window has been drawn again.
pub async fn next_picture() {
    TimeoutFuture::new(PICTURE_MS).await;
}

/// Takes files that were dropped onto the page and opens the scene among them, else the model: what it refers to is among the others.
pub fn take(dropped: Vec<egui::DroppedFileHandle>, events: &Events) {
    let events = events.clone();
    spawn_local(async move {
        let mut paths = Vec::new();
        for file in dropped {
            match file.bytes_async().await {
                Ok(bytes) => {
                    files::hand_over(file.path().to_owned(), bytes);
                    paths.push(file.path().to_owned());
                }
                Err(reason) => {
                    let file = file.path().display().to_string();
                    events.send(Event::Written(Err(LoadError::Read { file, reason }.into())));
                }
            }
        }
        let first = paths.into_iter().max_by_key(|path| rank(path));
        first.into_iter().for_each(|path| events.send(Event::Chosen(Choice::Open, path)));
    });
}

fn rank(path: &Path) -> u8 {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    match ending.as_str() {
        "json" => 2,
        ending if MODELS.contains(&ending) => 1,
        _ => 0,
    }
}

/// Asks for a file, or names the one that is to be written.
pub fn ask(choice: Choice, events: &Events) {
    let events = events.clone();
    spawn_local(async move {
        let dialogue = rfd::AsyncFileDialog::new();
        let dialogue = match choice {
            Choice::Open => dialogue
                .add_filter("models, scenes, skies, textures", &[MODELS, MAPS, TEXTURES, &["json"]].concat()),
            Choice::Environment => dialogue.add_filter("skies", MAPS),
            Choice::Albedo => dialogue.add_filter("textures", TEXTURES),
            Choice::SaveScene => return events.send(Event::Chosen(choice, PathBuf::from("scene.json"))),
            Choice::SavePicture | Choice::SaveAnimation | Choice::SaveSequence => return,
        };
        if let Some(file) = dialogue.pick_file().await {
            let path = PathBuf::from(file.file_name());
            files::hand_over(path.clone(), file.read().await);
            events.send(Event::Chosen(choice, path));
        }
    });
}

/// Hands a file to the user, as a download.
pub fn give(path: &Path, text: String, events: &Events) {
    let (path, events) = (path.to_owned(), events.clone());
    spawn_local(async move {
        let name = path.to_string_lossy();
        if let Some(file) = rfd::AsyncFileDialog::new().set_file_name(name).save_file().await
            && file.write(text.as_bytes()).await.is_ok()
        {
            events.send(Event::Written(Ok(path.clone())));
        }
    });
}
