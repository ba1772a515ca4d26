//! What the window does when those who work beside it tell something.

use super::events::Event;
use super::loaded::{Loaded, Wanted};
use super::{App, First, panels};
use crate::scene::Scene;
use eframe::egui;
use egui::util::undoer::Undoer;
use std::sync::Arc;

impl App {
    pub(super) fn hear(&mut self, context: &egui::Context) {
        while let Ok(event) = self.inbox.try_recv() {
            match event {
                Event::Ready(Ok(adapter)) => {
                    self.adapter = Some(adapter);
                    match self.first.take() {
                        Some(First::Name(name)) => self.open(&name),
                        Some(First::Scene(scene)) => {
                            self.start(Wanted { scene: *scene, assumes_size: false }, true);
                        }
                        None => {}
                    }
                }
                Event::Ready(Err(error)) => self.trouble(&error),
                Event::Progress { job, stage, share } => {
                    if let Some(current) = self.job.as_mut().filter(|current| current.is(job)) {
                        (current.stage, current.share) = (stage, share);
                    }
                }
                Event::Opened { job, result } if self.job.as_ref().is_some_and(|current| current.is(job)) => {
                    self.job = None;
                    match result {
                        Ok(opened) => self.take(*opened),
                        Err(error) => self.trouble(&error),
                    }
                }
                Event::Opened { .. } => {}
                Event::Shown(result) => {
                    self.is_waiting = false;
                    match result {
                        Ok(shown) => {
                            self.frames.add(&shown);
                            self.good = self.asked.take();
                            self.counters = shown.counters.or(self.counters);
                            set(context, &mut self.picture, Some(shown.image));
                            set(context, &mut self.other, shown.other);
                            set(context, &mut self.atlas, shown.atlas);
                        }
                        Err(error) => {
                            self.trouble(&error);
                            self.go_back();
                        }
                    }
                }
                Event::Traced(task, result) if self.tracing.as_ref().is_some_and(|t| t.is(task)) => {
                    match result {
                        Ok(traced) => {
                            set(context, &mut self.paths, Some(traced.image.clone()));
                            if traced.done {
                                self.tracing = None;
                            }
                            self.traced = Some(traced);
                        }
                        Err(error) => {
                            self.tracing = None;
                            self.trouble(&error);
                        }
                    }
                }
                Event::Judged(task, result) if self.judging.as_ref().is_some_and(|t| t.is(task)) => {
                    self.judging = None;
                    match result {
                        Ok(judged) => self.judged = Some(judged),
                        Err(error) => self.trouble(&error),
                    }
                }
                Event::Traced(..) | Event::Judged(..) => {}
                Event::Chosen(choice, path) => panels::chosen(self, choice, &path),
                Event::Exporting { done } => {
                    if let Some(exporting) = &mut self.exporting {
                        exporting.done = done;
                    }
                }
                Event::Exported(result) => {
                    self.exporting = None;
                    match result {
                        Ok(Some(path)) => self.notices.push(format!("{} is written", path.display())),
                        Ok(None) => self.notices.push("nothing is written".to_owned()),
                        Err(error) => self.trouble(&error),
                    }
                }
                Event::Written(Ok(path)) => self.notices.push(format!("{} is written", path.display())),
                Event::Written(Err(error)) => self.trouble(&error),
            }
        }
    }

    /// To the last scene that could be shown.
    fn go_back(&mut self) {
        if let Some(good) = self.good.take() {
            self.scene = Scene { camera: self.scene.camera, ..good };
        }
    }

    fn take(&mut self, (scene, loaded): (Scene, Arc<Loaded>)) {
        if self.replaces {
            self.playback.phase = 0.0;
            self.undoer = Undoer::default();
            self.scene = scene;
        } else {
            let Scene { shape, up, into, quality, .. } = scene;
            (self.scene.shape, self.scene.up, self.scene.into) = (shape, up, into);
            self.scene.quality = quality;
            self.scene.morph.truncate(loaded.opened.model.mesh.targets.len());
        }
        self.loaded = Some(loaded);
    }
}

/// Puts an image into a texture that may have to be made.
fn set(context: &egui::Context, texture: &mut Option<egui::TextureHandle>, image: Option<egui::ColorImage>) {
    let options = egui::TextureOptions::LINEAR;
    match (image, texture.as_mut()) {
        (Some(image), Some(texture)) => texture.set(image, options),
        (Some(image), None) => *texture = Some(context.load_texture("picture", image, options)),
        (None, _) => *texture = None,
    }
}
