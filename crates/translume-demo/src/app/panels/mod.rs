//! What stands around the picture.

mod compare;
mod export;
mod file;
mod frames;
mod keys;
mod light;
mod medium;
mod model;
mod quality;
mod status;

pub use compare::Beside;
#[cfg(target_arch = "wasm32")]
pub use file::MODELS;
#[cfg(not(target_arch = "wasm32"))]
pub use file::dialogue;
pub use file::{MAPS, TEXTURES, chosen};
pub use frames::Frames;
pub use keys::keys;
pub use light::light_from;
pub use medium::albedo_from;

use super::App;
use eframe::egui;

/// Points across.
const WIDTH: f32 = 280.0;

pub fn show(app: &mut App, ui: &mut egui::Ui) {
    egui::Panel::top("menu").show(ui, |ui| file::menu(app, ui));
    egui::Panel::bottom("status").show(ui, |ui| status::show(app, ui));
    side(egui::Panel::left("object"), ui, |ui| {
        section(ui, "Model", true, |ui| model::show(app, ui));
        section(ui, "Medium", true, |ui| medium::show(app, ui));
        section(ui, "Look", true, |ui| medium::look(app, ui));
    });
    side(egui::Panel::right("scene"), ui, |ui| {
        section(ui, "Lights", true, |ui| light::show(app, ui));
        section(ui, "Quality", false, |ui| quality::show(app, ui));
        section(ui, "Behind the picture", false, |ui| compare::overlays(app, ui));
        section(ui, "Beside the picture", false, |ui| compare::beside(app, ui));
        section(ui, "Export", false, |ui| export::show(app, ui));
        section(ui, "Timings", true, |ui| app.frames.show(ui));
    });
    compare::atlas(app, ui.ctx());
    keys::sheet(app, ui.ctx());
}

fn side(panel: egui::Panel, ui: &mut egui::Ui, contents: impl FnOnce(&mut egui::Ui)) {
    panel.resizable(true).default_size(WIDTH).show(ui, |ui| {
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, contents);
    });
}

fn section(ui: &mut egui::Ui, name: &str, open: bool, contents: impl FnOnce(&mut egui::Ui)) {
    egui::CollapsingHeader::new(name).default_open(open).show(ui, |ui| contents(ui));
}

/// A choice among names.
fn choice(
    ui: &mut egui::Ui,
    label: &str,
    value: &mut String,
    names: impl IntoIterator<Item = &'static str>,
) -> bool {
    let before = value.clone();
    egui::ComboBox::from_label(label).selected_text(value.as_str()).show_ui(ui, |ui| {
        for name in names {
            ui.selectable_value(value, name.to_owned(), name);
        }
    });
    *value != before
}
