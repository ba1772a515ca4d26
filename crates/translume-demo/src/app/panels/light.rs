//! Lights.

use super::super::App;
use super::super::events::Choice;
use crate::environment::Environment;
use crate::scene::SceneLight;
use eframe::egui;
use egui::{DragValue, Slider};
use std::path::Path;

pub fn show(app: &mut App, ui: &mut egui::Ui) {
    let mut removed = None;
    for (k, light) in app.scene.lights.iter_mut().flatten().enumerate() {
        ui.push_id(k, |ui| {
            ui.horizontal(|ui| {
                ui.strong(light.name());
                if ui.small_button("remove").clicked() {
                    removed = Some(k);
                }
            });
            edit(ui, light);
        });
        ui.separator();
    }
    if let (Some(k), Some(lights)) = (removed, &mut app.scene.lights) {
        lights.remove(k);
    }
    ui.horizontal_wrapped(|ui| {
        ui.label("Add");
        for (name, make) in KINDS {
            if ui.button(*name).clicked() {
                let light = make(app);
                app.scene.lights.get_or_insert_default().push(light);
            }
        }
        if ui.button("sky from a file…").clicked() {
            app.ask(Choice::Environment);
        }
    });
}

type Make = fn(&App) -> SceneLight;

const KINDS: &[(&str, Make)] = &[
    ("sun", |_| SceneLight::Directional {
        to_light: [0.4, 0.8, 0.4],
        irradiance: [1.5; 3],
        shadow: true,
        lit_region: None,
    }),
    ("point", |app| SceneLight::Point {
        position: beside(app),
        intensity: [2.0 * square(app); 3],
        shadow: true,
        lit_region: None,
    }),
    ("sphere", |app| SceneLight::Sphere {
        center: beside(app),
        radius: 0.1 * square(app).sqrt(),
        radiance: [60.0; 3],
        shadow: true,
    }),
    ("sky", |_| SceneLight::ConstantEnv { radiance: [0.2; 3], shadow: false }),
];

/// Squared size of what is looked at: intensities in proportion light alike whatever the unit.
fn square(app: &App) -> f32 {
    app.scene
        .camera
        .map_or(1.0, |camera| 0.02 * glam::Vec3::from(camera.eye).distance_squared(camera.target.into()))
}

/// A place to the right of and above what is looked at.
fn beside(app: &App) -> [f32; 3] {
    let size = square(app).sqrt();
    let target = app.scene.camera.map_or([0.0; 3], |camera| camera.target);
    [target[0] + size, target[1] + size, target[2] + size]
}

fn edit(ui: &mut egui::Ui, light: &mut SceneLight) {
    match light {
        SceneLight::Environment(environment) => {
            ui.label(environment.file.file_name().unwrap_or_default().to_string_lossy());
            ui.add(Slider::new(&mut environment.scale, 0.01..=100.0).logarithmic(true).text("brightness"));
            ui.add(Slider::new(&mut environment.rotation_deg, -180.0..=180.0).text("turned by °"));
            ui.checkbox(&mut environment.split, "the sun casts sharp shadows");
        }
        SceneLight::Spot { inner_angle_deg, outer_angle_deg, .. } => {
            ui.add(Slider::new(outer_angle_deg, 1.0..=89.0).text("half angle °"));
            *inner_angle_deg = inner_angle_deg.min(*outer_angle_deg);
            ui.add(Slider::new(inner_angle_deg, 0.0..=*outer_angle_deg).text("full within °"));
        }
        SceneLight::Sphere { radius, .. } => {
            ui.horizontal(|ui| {
                let (label, speed) = (ui.label("radius"), 0.01 * *radius);
                ui.add(DragValue::new(radius).speed(speed).range(1e-6..=1e6)).labelled_by(label.id);
            });
        }
        _ => {}
    }
    if let Some(rgb) = light.brightness_mut() {
        colour(ui, rgb);
    }
    ui.checkbox(light.shadow_mut(), "shadows");
}

/// A colour and how strong it is.
fn colour(ui: &mut egui::Ui, rgb: &mut [f32; 3]) {
    ui.horizontal(|ui| {
        let strength = rgb.iter().copied().fold(0.0, f32::max);
        let mut hue = if strength > 0.0 { rgb.map(|c| c / strength) } else { [1.0; 3] };
        let (mut strength, speed) = (strength, 0.01 * strength.max(0.01));
        let hues = ui.color_edit_button_rgb(&mut hue);
        let value = ui.add(DragValue::new(&mut strength).speed(speed).range(0.0..=1e12));
        let value = value.labelled_by(ui.label("strength").id);
        if hues.changed() || value.changed() {
            *rgb = hue.map(|c| c * strength);
        }
    });
}

/// Light from a map alone, and a turn that it had.
pub fn light_from(app: &mut App, path: &Path) {
    let file = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let mut environment = Environment::new(file);
    let lights = app.scene.lights.get_or_insert_default();
    let old = lights.iter().find_map(|light| match light {
        SceneLight::Environment(old) => Some(old.rotation_deg),
        _ => None,
    });
    environment.rotation_deg = old.unwrap_or(0.0);
    *lights = vec![SceneLight::Environment(environment)];
}
