//! What trades error for time.

use super::super::App;
use super::choice;
use crate::scene::{Quality, THETA, TOLERANCE};
use eframe::egui;
use egui::Slider;
use translume::{Evaluate, Profile, Transport};

/// Six mean free paths of light in milk or skin.
const FINER_BELOW: f32 = 5.0;
const SIZES: [u32; 6] = [64, 128, 256, 512, 1024, 2048];

pub fn show(app: &mut App, ui: &mut egui::Ui) {
    let mut scene = app.scene.clone();
    let quality = &mut scene.quality;
    if choice(ui, "transport", &mut quality.transport, Transport::ALL.map(Transport::name))
        && !matches!(quality.transport.as_str(), "auto" | "classic")
    {
        (quality.method, quality.evaluate) = ("dual".to_owned(), "texel".to_owned());
    }
    choice(ui, "profile", &mut quality.profile, Profile::NAMES.iter().map(|(name, _)| *name));
    method(ui, quality);
    number(ui, "texels across the atlas", &mut quality.atlas, &SIZES);
    choice(ui, "charts", &mut quality.charts, Quality::CHARTS);
    ui.checkbox(&mut quality.even, "charts hold equal areas");
    finer(ui, &mut quality.finer_below);
    number(ui, "texels across a shadow map", &mut quality.shadow, &SIZES[2..]);
    number(ui, "directions of the sky's shadow", &mut quality.directions, &[8, 16, 32, 64, 128, 256]);
    if scene != app.scene {
        app.set(scene);
    }
}

/// Texels of thin parts.
fn finer(ui: &mut egui::Ui, below: &mut Option<f32>) {
    let mut is_on = below.is_some();
    if ui.checkbox(&mut is_on, "finer texels where it is thin").changed() {
        *below = is_on.then_some(FINER_BELOW);
    }
    if let Some(mm) = below {
        ui.add(Slider::new(mm, 0.5..=50.0).logarithmic(true).text("thinner than, mm"));
    }
}

/// Method and its numbers.
pub fn method(ui: &mut egui::Ui, quality: &mut Quality) {
    if choice(ui, "method", &mut quality.method, Quality::METHODS) {
        (quality.tolerance, quality.theta) = (None, None);
        if quality.method != "dual" {
            Transport::Auto.name().clone_into(&mut quality.transport);
            quality.evaluate = "texel".to_owned();
        }
    }
    match quality.method.as_str() {
        "dual" => {
            let mut tolerance = quality.tolerance.unwrap_or(TOLERANCE);
            let slider = Slider::new(&mut tolerance, 0.0001..=0.1).logarithmic(true).text("tolerance");
            if ui.add(slider).changed() {
                (quality.tolerance, quality.theta) = (Some(tolerance), None);
            }
            choice(ui, "evaluated per", &mut quality.evaluate, Evaluate::NAMES.iter().map(|(name, _)| *name));
        }
        "tree" => {
            let mut theta = quality.theta.unwrap_or(THETA);
            if ui.add(Slider::new(&mut theta, 0.05..=2.0).text("opening angle")).changed() {
                quality.theta = Some(theta);
            }
        }
        _ => {}
    }
}

fn number(ui: &mut egui::Ui, label: &str, value: &mut u32, choices: &[u32]) {
    egui::ComboBox::from_label(label).selected_text(value.to_string()).show_ui(ui, |ui| {
        for choice in choices {
            ui.selectable_value(value, *choice, choice.to_string());
        }
    });
}
