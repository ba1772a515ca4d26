//! What the body is made of, and how it looks.

use super::super::App;
use super::super::events::Choice;
use crate::scene::Material;
use eframe::egui;
use egui::{Color32, Slider};
use std::path::Path;
use translume::{Medium, Profile};

const CHANNELS: [&str; 3] = ["red", "green", "blue"];

pub fn show(app: &mut App, ui: &mut egui::Ui) {
    let medium = match app.scene.medium() {
        Ok(medium) => medium.unwrap_or_default(),
        Err(error) => return app.trouble(&error),
    };
    ui.horizontal_wrapped(|ui| {
        for (name, preset) in Medium::PRESETS {
            let chosen = medium == *preset;
            if swatch(ui, name, preset, chosen).clicked() {
                (app.scene.medium, app.scene.material) = (Some((*name).to_owned()), None);
            }
        }
    });
    albedo(app, ui);
    let mut edited = medium;
    ui.label("reduced scattering, 1/mm");
    coefficients(ui, &mut edited.sigma_s_prime);
    ui.label("absorption, 1/mm");
    coefficients(ui, &mut edited.sigma_a);
    ui.add(Slider::new(&mut edited.ior, 1.0..=2.0).text("index of refraction"));
    ui.add(Slider::new(&mut edited.g, -0.95..=0.95).text("goes straight on, g"));
    if edited != medium {
        edit(app, |medium| *medium = edited);
    }
}

/// Makes it a medium of its own, that no preset names.
pub fn edit(app: &mut App, change: impl FnOnce(&mut Medium)) {
    let mut medium = app.scene.medium().ok().flatten().unwrap_or_default();
    change(&mut medium);
    let Medium { sigma_s_prime, sigma_a, ior, g } = medium;
    app.scene.medium = None;
    app.scene.material = Some(Material { sigma_s_prime, sigma_a, g, eta: ior });
}

fn albedo(app: &mut App, ui: &mut egui::Ui) {
    ui.horizontal_wrapped(|ui| {
        if ui.button("Albedo texture…").clicked() {
            app.ask(Choice::Albedo);
        }
        if let Some(file) = &app.scene.albedo {
            ui.label(file.file_name().unwrap_or_default().to_string_lossy())
                .on_hover_text(file.to_string_lossy());
            if ui.small_button("remove").clicked() {
                app.scene.albedo = None;
            }
        }
    });
}

/// A picture on the model's texture coordinates.
pub fn albedo_from(app: &mut App, path: &Path) {
    app.scene.albedo = Some(std::path::absolute(path).unwrap_or_else(|_| path.to_owned()));
}

fn coefficients(ui: &mut egui::Ui, values: &mut [f32; 3]) {
    for (value, name) in values.iter_mut().zip(CHANNELS) {
        ui.add(Slider::new(value, 0.0..=100.0).logarithmic(true).smallest_positive(1e-4).text(name));
    }
}

/// A button in the colour that a thick block of it has.
fn swatch(ui: &mut egui::Ui, name: &str, medium: &Medium, chosen: bool) -> egui::Response {
    let [r, g, b] = Profile::Dipole
        .reflectance(medium)
        .map_or([0.5; 3], |light| light.total().map(|c| c.clamp(0.0, 1.0) as f32));
    let fill: Color32 = egui::Rgba::from_rgb(r, g, b).into();
    let is_light = 0.3 * r + 0.6 * g + 0.1 * b > 0.25;
    let ink = if is_light { Color32::BLACK } else { Color32::WHITE };
    let button = egui::Button::new(egui::RichText::new(name).color(ink)).fill(fill).selected(false);
    let button =
        if chosen { button.stroke(egui::Stroke::new(2.0, ui.visuals().strong_text_color())) } else { button };
    ui.add(button)
}

pub fn look(app: &mut App, ui: &mut egui::Ui) {
    let look = &mut app.scene.look;
    let mut glossy = look.gloss > 0.0;
    if ui.checkbox(&mut glossy, "surface reflects").changed() {
        look.gloss = if glossy { 0.35 } else { 0.0 };
    }
    if glossy {
        ui.add(Slider::new(&mut look.gloss, 0.03..=1.0).text("roughness"));
    }
    ui.add(Slider::new(&mut look.exposure, -6.0..=6.0).text("exposure, stops"));
}
