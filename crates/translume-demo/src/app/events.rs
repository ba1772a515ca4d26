//! What those who work beside the window tell it.

use super::loaded::Loaded;
use super::truth::{Judged, Traced};
use super::worker::{Adapter, Shown};
use crate::error::Error;
use crate::scene::Scene;
use eframe::egui;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

pub enum Event {
    /// The GPU can be used, or why not.
    Ready(Result<Adapter, Error>),
    Progress {
        job: u64,
        stage: &'static str,
        share: Option<f32>,
    },
    Opened {
        job: u64,
        result: Result<Box<(Scene, Arc<Loaded>)>, Error>,
    },
    Shown(Result<Box<Shown>, Error>),
    /// Of the task with this number.
    Traced(u64, Result<Traced, Error>),
    Judged(u64, Result<Judged, Error>),
    /// A file was chosen in a dialogue.
    Chosen(Choice, PathBuf),
    /// A file is there.
    Written(Result<PathBuf, Error>),
}

/// What a file was chosen for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    Open,
    Environment,
    SaveScene,
    SavePicture,
}

/// Where they tell it, and wake the window.
#[derive(Clone)]
pub struct Events {
    sender: Sender<Event>,
    context: egui::Context,
}

impl Events {
    pub fn new(context: egui::Context) -> (Self, Receiver<Event>) {
        let (sender, receiver) = channel();
        (Self { sender, context }, receiver)
    }

    /// A window that has closed hears nothing.
    pub fn send(&self, event: Event) {
        if self.sender.send(event).is_ok() {
            self.context.request_repaint();
        }
    }
}
