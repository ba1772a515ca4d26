//! The keyboard.

use super::super::App;
use super::super::events::Choice;
use super::file;
use eframe::egui;
use egui::{Key, KeyboardShortcut, Modifiers};

type Action = fn(&mut App, &egui::Context);

/// A shortcut is also pressed when Shift is held with it: those with Shift come first.
const SHORTCUTS: &[(Modifiers, Key, &str, Action)] = &[
    (Modifiers::NONE, Key::Space, "play or pause", |app, _| app.playback.playing = !app.playback.playing),
    (Modifiers::NONE, Key::F, "see all of the model", |app, _| app.frame_all()),
    (Modifiers::COMMAND, Key::O, "open a model, a scene or a sky", |app, _| app.ask(Choice::Open)),
    (Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::S, "save the scene", |app, _| {
        app.ask(Choice::SaveScene);
    }),
    (Modifiers::COMMAND, Key::S, "save the picture", |app, _| app.ask(Choice::SavePicture)),
    (Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::C, "copy the scene as JSON", file::copy),
    (Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z, "redo", |app, _| app.undo(true)),
    (Modifiers::COMMAND, Key::Z, "undo", |app, _| app.undo(false)),
    (Modifiers::NONE, Key::Escape, "stop what is being opened", |app, _| app.job = None),
    (Modifiers::COMMAND, Key::Q, "quit", |_, context| {
        context.send_viewport_cmd(egui::ViewportCommand::Close);
    }),
    (Modifiers::NONE, Key::F1, "show or hide this sheet", |app, _| app.shows_keys = !app.shows_keys),
];

const MOUSE: &[(&str, &str)] = &[
    ("drag", "turn around the model"),
    ("right drag, Shift drag", "move across"),
    ("wheel, pinch", "nearer and farther"),
    ("double click", "see all of the model"),
    ("drag a light's dot", "move the light"),
    ("drop a file", "open it"),
];

pub fn keys(app: &mut App, context: &egui::Context) {
    if context.text_edit_focused() {
        return;
    }
    for &(modifiers, key, _, action) in SHORTCUTS {
        if context.input_mut(|input| input.consume_shortcut(&KeyboardShortcut::new(modifiers, key))) {
            action(app, context);
        }
    }
}

/// What keys and the mouse do.
pub fn sheet(app: &mut App, context: &egui::Context) {
    let middle = context.content_rect().center();
    let window = egui::Window::new("Keys and mouse").pivot(egui::Align2::CENTER_CENTER).default_pos(middle);
    window.open(&mut app.shows_keys).resizable(false).collapsible(false).show(context, |ui| {
        egui::Grid::new("keys").num_columns(2).striped(true).show(ui, |ui| {
            for &(modifiers, key, meaning, _) in SHORTCUTS {
                ui.monospace(context.format_shortcut(&KeyboardShortcut::new(modifiers, key)));
                ui.label(meaning);
                ui.end_row();
            }
            for (act, meaning) in MOUSE {
                ui.monospace(*act);
                ui.label(*meaning);
                ui.end_row();
            }
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_shortcut_takes_what_is_meant_for_a_later_one() {
        for (k, (pressed, key, name, _)) in SHORTCUTS.iter().enumerate() {
            let takes = |other: &&(Modifiers, Key, &str, Action)| {
                other.1 == *key && pressed.matches_logically(other.0)
            };
            let first = SHORTCUTS.iter().position(|other| takes(&other));
            assert_eq!(first, Some(k), "{name}");
        }
    }
}
