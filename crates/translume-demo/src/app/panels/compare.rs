//! How right the picture is: what lies behind it, and what lies beside it.

use super::super::truth;
use super::super::{App, IN_BROWSER};
use super::{choice, quality};
use crate::overlay::{MOST_ERROR, Overlay, heat};
use crate::scene::Quality;
use eframe::egui;
use translume::Profile;

/// What is seen to the right of the line.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Beside {
    #[default]
    Nothing,
    /// The same scene, computed in another way.
    Other(Quality),
    /// The same scene by paths of light.
    Paths,
}

pub fn overlays(app: &mut App, ui: &mut egui::Ui) {
    egui::ComboBox::from_label("shown").selected_text(name(app.overlay)).show_ui(ui, |ui| {
        for (overlay, name) in Overlay::ALL {
            ui.selectable_value(&mut app.overlay, overlay, name);
        }
    });
    if app.overlay != Overlay::None {
        ui.checkbox(&mut app.shows_atlas, "the atlas in a window");
    }
    if app.overlay == Overlay::Error {
        errors(app, ui);
    }
    if let Some(counters) = app.counters {
        egui::Grid::new("counters").num_columns(2).striped(true).show(ui, |ui| {
            let mut row = |name: &str, value: String| {
                ui.label(name);
                ui.monospace(value);
                ui.end_row();
            };
            row("transport", counters.transport.name().to_owned());
            row("texels", counters.texels.to_string());
            row("evaluations a texel", format!("{:.1}", counters.evaluations));
            if let Some([words, overflow]) = counters.lists {
                row("words of lists a texel", format!("{:.1}", words as f32 / counters.texels.max(1) as f32));
                row("groups without room", overflow.to_string());
            }
        });
    }
}

fn name(overlay: Overlay) -> &'static str {
    Overlay::ALL.iter().find(|(other, _)| *other == overlay).map_or("", |(_, name)| name)
}

fn errors(app: &mut App, ui: &mut egui::Ui) {
    ui.horizontal(|ui| {
        if app.judging.is_some() {
            ui.spinner();
            ui.label("all pairs…");
            if ui.button("Stop").clicked() {
                app.judging = None;
            }
        } else if ui
            .button("Compute error")
            .on_hover_text("the classical scatter against all pairs of texels: seconds on a graphics card, minutes without")
            .clicked()
        {
            app.judge();
        }
    });
    let Some(judged) = &app.judged else { return };
    let [rms, most] = [judged.rms, judged.most].map(|error| 100.0 * error);
    ui.label(format!("{rms:.2} % (rms of the mean), 99 % below {most:.2} %; {:.1} s", judged.seconds));
    scale(ui);
}

/// The scale of colours.
fn scale(ui: &mut egui::Ui) {
    let (rect, _) = ui.allocate_exact_size(egui::vec2(ui.available_width(), 12.0), egui::Sense::hover());
    const STEPS: usize = 64;
    for k in 0..STEPS {
        let [from, to] = [k, k + 1].map(|k| k as f32 / STEPS as f32);
        let part = egui::Rect::from_x_y_ranges(
            rect.left() + rect.width() * from..=rect.left() + rect.width() * to,
            rect.y_range(),
        );
        let [r, g, b] = heat(from).map(|c| (255.0 * c) as u8);
        ui.painter().rect_filled(part, 0.0, egui::Color32::from_rgb(r, g, b));
    }
    ui.label(format!("0 to {:.0} % of the mean", 100.0 * MOST_ERROR));
}

pub fn beside(app: &mut App, ui: &mut egui::Ui) {
    let before = app.beside.clone();
    ui.horizontal(|ui| {
        ui.selectable_value(&mut app.beside, Beside::Nothing, "nothing");
        let is_other = matches!(app.beside, Beside::Other(_));
        if ui.selectable_label(is_other, "another way").clicked() && !is_other {
            app.beside = Beside::Other(app.scene.quality.clone());
        }
        ui.selectable_value(&mut app.beside, Beside::Paths, "ground truth");
    });
    match &mut app.beside {
        Beside::Nothing => {}
        Beside::Other(other) => {
            choice(ui, "its profile", &mut other.profile, Profile::NAMES.iter().map(|(name, _)| *name));
            quality::method(ui, other);
        }
        Beside::Paths => paths(app, ui),
    }
    if app.beside != before {
        app.tracing = None;
    }
}

fn paths(app: &mut App, ui: &mut egui::Ui) {
    if IN_BROWSER {
        ui.weak("Paths would keep this page standing still for minutes: use the program.");
        return;
    }
    let refracts = app.scene.medium().ok().flatten().unwrap_or_default().ior != 1.0;
    if refracts
        && ui
            .button("Index of refraction 1 on both sides")
            .on_hover_text("paths then meet lamps, and are quick")
            .clicked()
    {
        super::medium::edit(app, |medium| medium.ior = 1.0);
    }
    ui.horizontal(|ui| {
        if app.tracing.is_some() {
            ui.spinner();
            if ui.button("Stop").clicked() {
                app.tracing = None;
            }
        } else if ui
            .button("Follow paths")
            .on_hover_text("the scene as it stands now; motion is paused")
            .clicked()
        {
            app.trace();
        }
    });
    if let Some(traced) = &app.traced {
        let state = if traced.done { "done" } else { "so far" };
        ui.label(format!("noise {:.1} %, {state} in {:.0} s", 100.0 * traced.noise, traced.seconds));
        if traced.widened {
            ui.label("Paths cannot meet a lamp without extent through a surface that refracts: points are spheres, suns are wide here.");
        }
        if app.traced_scene != app.ordered.as_ref().map(|wish| wish.scene.clone()) {
            ui.label("the picture has changed since");
        }
    }
}

impl App {
    pub(in crate::app) fn judge(&mut self) {
        if let Some(wish) = &self.ordered {
            self.judging =
                Some(truth::judge(wish.scene.clone(), wish.loaded.clone(), &self.court, &self.events));
        }
    }

    fn trace(&mut self) {
        self.playback.playing = false;
        if let Some(wish) = &self.ordered {
            self.traced = None;
            self.traced_scene = Some(wish.scene.clone());
            self.tracing = Some(truth::follow(wish.scene.clone(), wish.loaded.clone(), &self.events));
        }
    }
}

/// The overlay as it lies in the atlas.
pub fn atlas(app: &mut App, context: &egui::Context) {
    let Some(texture) = app.atlas.as_ref().filter(|_| app.shows_atlas && app.overlay != Overlay::None) else {
        return;
    };
    let window = egui::Window::new("Atlas").default_size([300.0, 320.0]);
    let window = window.default_pos(app.view.corner());
    window.open(&mut app.shows_atlas).show(context, |ui| {
        let side = ui.available_width().max(64.0);
        ui.add(egui::Image::new(texture).fit_to_exact_size(egui::Vec2::splat(side)));
    });
}
