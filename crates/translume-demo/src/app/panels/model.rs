//! The model: which, how large, and how it moves.

use super::super::App;
use super::super::playback::Play;
use crate::model::Model;
use crate::scene::{Round, SceneAnimation, Up};
use eframe::egui;
use egui::Slider;
use translume_mesh::builtin;

pub fn show(app: &mut App, ui: &mut egui::Ui) {
    ui.horizontal_wrapped(|ui| {
        for name in builtin::NAMES {
            if ui.button(*name).clicked() {
                app.open(name);
            }
        }
    });
    let Some(loaded) = app.loaded.clone() else {
        ui.weak("opening…");
        return;
    };
    let model = &loaded.opened.model;
    let triangles = model.mesh.triangles.len();
    ui.label(format!(
        "{}: {triangles} triangles, {} texels in {} charts",
        model.mesh.name,
        loaded.atlas.texels.len(),
        loaded.atlas.report.charts
    ));
    if let Ok(diagonal) = model.diagonal() {
        let mut size = diagonal * app.scene.mm_per_unit();
        if ui.add(Slider::new(&mut size, 1.0..=10_000.0).logarithmic(true).text("mm across")).changed() {
            app.scene.mm_per_unit = Some(size / diagonal);
        }
    }
    shape(app, ui);
    motion(app, ui, model);
}

/// What makes it another mesh.
fn shape(app: &mut App, ui: &mut egui::Ui) {
    let mut scene = app.scene.clone();
    ui.horizontal(|ui| {
        ui.label("melts into");
        ui.selectable_value(&mut scene.into, None, "its own");
        ui.selectable_value(&mut scene.into, Some(Round::Egg), "an egg");
        ui.selectable_value(&mut scene.into, Some(Round::Sphere), "a sphere");
    });
    ui.horizontal(|ui| {
        ui.label("up is");
        ui.selectable_value(&mut scene.up, Up::Y, "y");
        ui.selectable_value(&mut scene.up, Up::Z, "z");
    });
    if scene != app.scene {
        app.set(scene);
    }
}

fn motion(app: &mut App, ui: &mut egui::Ui, model: &Model) {
    let play = Play::of(&app.scene, model);
    ui.horizontal(|ui| {
        let name = if app.playback.playing { "Pause" } else { "Play" };
        if ui.button(name).clicked() {
            app.playback.playing = !app.playback.playing;
        }
        ui.add(Slider::new(&mut app.playback.speed, 0.1..=4.0).logarithmic(true).text("speed"));
    });
    ui.add(Slider::new(&mut app.playback.phase, 0.0..=1.0).text("moment"));
    let animations = &model.rig.animations;
    if !animations.is_empty() {
        let named = |k: usize| match animations[k].name.as_str() {
            "" => format!("animation {k}"),
            name => name.to_owned(),
        };
        let chosen = match &app.scene.animation {
            Some(animation) => animation.to_string(),
            None => "none".to_owned(),
        };
        egui::ComboBox::from_label("animation").selected_text(chosen).show_ui(ui, |ui| {
            if ui.selectable_label(app.scene.animation.is_none(), "none").clicked() {
                (app.scene.animation, app.scene.time) = (None, None);
            }
            for k in 0..animations.len() {
                if ui.selectable_label(false, named(k)).clicked() {
                    app.scene.animation = Some(SceneAnimation::Index(k));
                }
            }
        });
    }
    if play != Play::Morph || !app.playback.playing {
        weights(app, ui, model, play);
    }
    let warp = &mut app.scene.warp;
    ui.add(Slider::new(&mut warp.twist_deg, -360.0..=360.0).text("twist °"));
    ui.add(Slider::new(&mut warp.bend_deg, -270.0..=270.0).text("bend °"));
    let reach = 0.05 * model.mesh.diagonal();
    ui.add(Slider::new(&mut warp.inflate, -reach..=reach).text("inflate"));
}

/// Of the morph targets at this moment.
fn weights(app: &mut App, ui: &mut egui::Ui, model: &Model, play: Play) {
    let targets = model.mesh.targets.len();
    let mut now = app.scene.clone();
    if now.morph.is_empty() {
        now.morph.clone_from(&model.rig.weights);
    }
    now.morph.resize(targets, 0.0);
    if play == Play::Morph {
        app.playback.apply(play, &mut now, targets);
    }
    let mut changed = false;
    for (k, weight) in now.morph.iter_mut().enumerate() {
        let name = match model.mesh.targets[k].name.as_str() {
            "" => format!("morph {k}"),
            name => name.to_owned(),
        };
        changed |= ui.add(Slider::new(weight, 0.0..=1.0).text(name)).changed();
    }
    if changed {
        (app.playback.phase, app.scene.morph) = (0.0, now.morph);
    }
}
