//! The menu, and files.

use super::super::events::Choice;
use super::super::worker::{Order, Wish};
use super::super::{App, IN_BROWSER};
use crate::overlay::Overlay;
use crate::picture::Output;
use eframe::egui;
use std::path::Path;
use std::sync::Arc;
use translume_mesh::builtin;

/// Meshes.
pub const MODELS: &[&str] = &["obj", "gltf", "glb", "ply"];
/// Skies.
pub const MAPS: &[&str] = &["exr", "hdr"];
/// Albedo.
pub const TEXTURES: &[&str] = &["png", "jpg", "jpeg"];

pub fn menu(app: &mut App, ui: &mut egui::Ui) {
    egui::MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| file(app, ui));
        ui.menu_button("Edit", |ui| edit(app, ui));
        ui.menu_button("View", |ui| view(app, ui));
        if ui.button("Keys").clicked() {
            app.shows_keys = !app.shows_keys;
        }
    });
}

fn file(app: &mut App, ui: &mut egui::Ui) {
    if ui.button("Open…").clicked() {
        app.ask(Choice::Open);
    }
    ui.menu_button("Built-in models", |ui| {
        for name in builtin::NAMES {
            if ui.button(*name).clicked() {
                app.open(name);
            }
        }
    });
    if !IN_BROWSER {
        recent(app, ui);
    }
    ui.separator();
    if IN_BROWSER {
        ui.weak("A page writes no pictures: use the program.");
    } else {
        pictures(app, ui);
    }
    if ui.button("Save scene…").clicked() {
        app.ask(Choice::SaveScene);
    }
    if ui.button("Copy scene as JSON").clicked() {
        copy(app, ui.ctx());
    }
    if !IN_BROWSER {
        ui.separator();
        if ui.button("Quit").clicked() {
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }
}

fn recent(app: &mut App, ui: &mut egui::Ui) {
    ui.menu_button("Recent files", |ui| {
        if app.recent.is_empty() {
            ui.weak("none yet");
        }
        for path in app.recent.clone() {
            if ui.button(path.display().to_string()).clicked() {
                app.open(&path.to_string_lossy());
            }
        }
    });
}

fn pictures(app: &mut App, ui: &mut egui::Ui) {
    if ui.button("Save picture…").clicked() {
        app.ask(Choice::SavePicture);
    }
    ui.add_enabled_ui(app.exporting.is_none(), |ui| {
        if ui.button("Save animation…").clicked() {
            app.ask(Choice::SaveAnimation);
        }
        if ui.button("Save image sequence…").clicked() {
            app.ask(Choice::SaveSequence);
        }
    });
}

fn edit(app: &mut App, ui: &mut egui::Ui) {
    if ui.button("Undo").clicked() {
        app.undo(false);
    }
    if ui.button("Redo").clicked() {
        app.undo(true);
    }
}

fn view(app: &mut App, ui: &mut egui::Ui) {
    if ui.button("Frame all").clicked() {
        app.frame_all();
    }
    ui.separator();
    // In words: the fonts have no picture of a screen.
    let mut theme = ui.ctx().options(|options| options.theme_preference);
    ui.selectable_value(&mut theme, egui::ThemePreference::Light, "Light");
    ui.selectable_value(&mut theme, egui::ThemePreference::Dark, "Dark");
    ui.selectable_value(&mut theme, egui::ThemePreference::System, "As the system");
    ui.ctx().set_theme(theme);
}

/// Asks where a file is; waits for the answer.
#[cfg(not(target_arch = "wasm32"))]
pub fn dialogue(choice: Choice) -> Option<std::path::PathBuf> {
    let dialogue = rfd::FileDialog::new();
    match choice {
        Choice::Open => {
            let all = [MODELS, MAPS, TEXTURES, &["json"]].concat();
            dialogue.add_filter("models, scenes, skies, textures", &all).pick_file()
        }
        Choice::Environment => dialogue.add_filter("skies", MAPS).pick_file(),
        Choice::Albedo => dialogue.add_filter("textures", TEXTURES).pick_file(),
        Choice::SaveScene => dialogue.set_file_name("scene.json").save_file(),
        Choice::SavePicture => dialogue.set_file_name("picture.png").save_file(),
        Choice::SaveAnimation => dialogue.set_file_name("morph.png").save_file(),
        Choice::SaveSequence => dialogue.set_file_name("morph_%04d.png").save_file(),
    }
}

/// A file was chosen.
pub fn chosen(app: &mut App, choice: Choice, path: &Path) {
    match choice {
        Choice::Open => app.open(&path.to_string_lossy()),
        Choice::Environment => super::light_from(app, path),
        Choice::Albedo => super::albedo_from(app, path),
        Choice::SaveScene => save_scene(app, path),
        Choice::SavePicture => save_picture(app, path),
        Choice::SaveAnimation => super::export::start(app, path, false),
        Choice::SaveSequence => super::export::start(app, path, true),
    }
}

/// The scene at this moment.
fn json(app: &App) -> Option<String> {
    let scene = app.moment(app.loaded.as_ref()?, app.view.pixels()?);
    serde_json::to_string_pretty(&scene).ok()
}

pub fn copy(app: &mut App, context: &egui::Context) {
    if let Some(text) = json(app) {
        context.copy_text(text);
        app.notices.push("the scene is in the clipboard".to_owned());
    }
}

fn save_scene(app: &mut App, path: &Path) {
    let Some(text) = json(app) else { return };
    #[cfg(target_arch = "wasm32")]
    super::super::web::give(path, text, &app.events);
    #[cfg(not(target_arch = "wasm32"))]
    match std::fs::write(path, text) {
        Ok(()) => app.notices.push(format!("{} is written", path.display())),
        Err(error) => app.trouble(&format!("{}: cannot be written: {error}", path.display())),
    }
}

fn save_picture(app: &mut App, path: &Path) {
    let (Some(loaded), Some(pixels)) = (app.loaded.clone(), app.view.pixels()) else { return };
    match Output::new(path) {
        Ok(output) => {
            let scene = app.moment(&loaded, pixels);
            let (overlay, errors) = (Overlay::None, Arc::default());
            let samples = output.format.samples();
            let wish = Wish { scene, loaded, pixels, samples, moving: false, overlay, errors, other: None };
            app.worker.order(Order::Write(wish, output, path.to_owned()));
        }
        Err(error) => app.trouble(&error),
    }
}
