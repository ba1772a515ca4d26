//! Which picture the window asks for next.

use super::loaded::Loaded;
use super::playback::Play;
use super::worker::{Order, Wish};
use super::{App, panels};
use crate::scene::Scene;
use eframe::egui;
use std::sync::Arc;

/// How long nothing may change before the picture gets finer, seconds.
const STILL: f64 = 0.25;
/// Samples along each side of a pixel of a picture that stands still.
pub const FINE: u32 = 2;
/// Pictures that take longer have half as many pixels each way while something moves.
const SLOW_MS: f32 = 60.0;

impl App {
    /// The scene as it stands at this moment, seen through a view of so many pixels.
    pub(super) fn moment(&self, loaded: &Loaded, pixels: [u32; 2]) -> Scene {
        self.playback.moment(&self.scene, &loaded.opened.model, pixels)
    }

    pub(super) fn play(&self) -> Option<Play> {
        self.loaded.as_ref().map(|loaded| Play::of(&self.scene, &loaded.opened.model))
    }

    /// Asks for the next picture if anything is different in it.
    pub(super) fn order(&mut self, context: &egui::Context, now: f64) {
        let (Some(loaded), Some(pixels)) = (self.loaded.clone(), self.view.pixels()) else { return };
        if self.is_waiting {
            return;
        }
        let scene = self.moment(&loaded, pixels);
        let moving = self.playback.playing && self.play() != Some(Play::Turn);
        let last = self.ordered.as_ref();
        let errors = self.errors(&loaded);
        let other = match &self.beside {
            panels::Beside::Other(quality) => Some(quality.clone()),
            _ => None,
        };
        // The camera knows the view's size.
        let is_new = last.is_none_or(|last| {
            (last.scene != scene || last.loaded.id != loaded.id)
                || (last.overlay != self.overlay
                    || last.other != other
                    || !Arc::ptr_eq(&last.errors, &errors))
        });
        if is_new {
            self.changed = now;
        }
        let is_still = !self.playback.playing && now - self.changed > STILL;
        let samples = if is_still { FINE } else { 1 };
        if !is_new && last.is_some_and(|last| last.samples >= samples) {
            return;
        }
        if !is_new && !is_still {
            return context.request_repaint_after_secs(STILL as f32);
        }
        let is_slow = self.frames.median().is_some_and(|ms| ms > SLOW_MS);
        let pixels = if is_slow && !is_still { pixels.map(|pixels| pixels.div_ceil(2)) } else { pixels };
        let wish = Wish { scene, loaded, pixels, samples, moving, overlay: self.overlay, errors, other };
        self.worker.order(Order::Show(wish.clone()));
        self.asked = Some(self.scene.clone());
        (self.ordered, self.is_waiting) = (Some(wish), true);
        if !is_still {
            context.request_repaint_after_secs(STILL as f32);
        }
    }

    /// Of this model's texels, where they were computed.
    fn errors(&self, loaded: &Loaded) -> Arc<Vec<f32>> {
        let judged = self.judged.as_ref().filter(|judged| judged.loaded == loaded.id);
        judged.map_or_else(|| Arc::clone(&self.no_errors), |judged| Arc::clone(&judged.errors))
    }
}
