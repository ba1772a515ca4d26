//! The line at the bottom: who draws, how fast, and what went wrong.

use super::super::{App, IN_BROWSER};
use eframe::egui;
use egui::{ProgressBar, RichText};

pub fn show(app: &mut App, ui: &mut egui::Ui) {
    troubles(app, ui);
    // In one line, lest the picture's size depends on what is said.
    ui.horizontal(|ui| {
        let say = |ui: &mut egui::Ui, words: RichText| ui.add(egui::Label::new(words).truncate());
        if let Some(job) = &app.job {
            let bar = ProgressBar::new(job.share.unwrap_or(0.0)).text(job.stage).desired_width(200.0);
            ui.add(bar.animate(job.share.is_none()));
            if IN_BROWSER {
                ui.label("the page stands still meanwhile");
            } else if ui.button("Cancel").clicked() {
                app.job = None;
            }
        }
        if let Some(exporting) = &app.exporting {
            let words = format!("frame {} of {}", exporting.done, exporting.total);
            let share = exporting.done as f32 / exporting.total as f32;
            ui.add(ProgressBar::new(share).text(words).desired_width(200.0));
            if ui.button("Cancel export").clicked() {
                exporting.cancel();
            }
        }
        match &app.adapter {
            None => ui.spinner(),
            Some(adapter) => {
                say(ui, RichText::new(&adapter.name));
                if adapter.is_software {
                    let note = "the processor draws this: a graphics card is a hundred times faster";
                    say(ui, RichText::new(note).color(ui.visuals().warn_fg_color));
                }
                ui.separator()
            }
        };
        if let Some(ms) = app.frames.median() {
            ui.label(format!("{ms:.0} ms a picture"));
        }
        if let Some(notice) = app.notices.last() {
            ui.separator();
            say(ui, RichText::new(notice));
        }
    });
}

fn troubles(app: &mut App, ui: &mut egui::Ui) {
    let mut closed = None;
    for (k, words) in app.troubles.iter().enumerate() {
        ui.horizontal_wrapped(|ui| {
            if ui.small_button("close").clicked() {
                closed = Some(k);
            }
            ui.label(RichText::new(words).color(ui.visuals().error_fg_color));
        });
    }
    if let Some(k) = closed {
        app.troubles.remove(k);
    }
}
