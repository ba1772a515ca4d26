//! Films of what is played.

use super::super::export::Export;
use super::super::worker::Order;
use super::super::{App, IN_BROWSER};
use eframe::egui;
use egui::Slider;
use std::path::Path;

pub fn show(app: &mut App, ui: &mut egui::Ui) {
    if IN_BROWSER {
        ui.weak("A page writes no films: use the program.");
        return;
    }
    let settings = &mut app.export;
    ui.add(Slider::new(&mut settings.frames, 2..=600).text("frames of a round"));
    ui.add(Slider::new(&mut settings.rate, 1.0..=60.0).integer().text("frames a second"));
    ui.horizontal(|ui| {
        ui.label("pixels");
        ui.selectable_value(&mut settings.factor, 1, "as in the view");
        ui.selectable_value(&mut settings.factor, 2, "twice as fine");
    });
    let pixels = app.view.pixels().unwrap_or_default().map(|pixels| pixels * app.export.factor);
    let seconds = app.export.frames as f32 / app.export.rate;
    ui.weak(format!("{} × {} pixels, {seconds:.1} s", pixels[0], pixels[1]));
}

/// Sends a round of what is played to the worker.
pub fn start(app: &mut App, path: &Path, is_numbered: bool) {
    let (Some(loaded), Some(view)) = (app.loaded.clone(), app.view.pixels()) else { return };
    match Export::new(app.scene.clone(), loaded, view, app.export, (path, is_numbered)) {
        Ok((export, exporting)) => {
            app.exporting = Some(exporting);
            app.worker.order(Order::Export(Box::new(export)));
        }
        Err(error) => app.trouble(&error),
    }
}
