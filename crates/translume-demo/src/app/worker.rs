//! The GPU's thread: takes orders for pictures, the newest first, and never keeps the window waiting.

use super::easel::Easel;
use super::events::{Event, Events};
use super::export::Export;
use super::loaded::Loaded;
use crate::error::Error;
use crate::gpu::Gpu;
use crate::overlay::Overlay;
use crate::picture::Output;
use crate::scene::{Quality, Scene};
use eframe::egui;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use translume::FrameTimings;

/// What a window that closes waits for at most.
const PATIENCE: Duration = Duration::from_secs(5);

/// What the window wants.
pub enum Order {
    /// A picture on the screen; only the newest such order counts.
    Show(Wish),
    /// A picture in a file.
    Write(Wish, Output, PathBuf),
    /// Many pictures in files, one after another between those on the screen.
    Export(Box<Export>),
}

/// A scene at a moment.
#[derive(Clone)]
pub struct Wish {
    pub scene: Scene,
    pub loaded: Arc<Loaded>,
    /// Width and height in pixels; the scene's camera may say others.
    pub pixels: [u32; 2],
    /// Samples along each side of a pixel.
    pub samples: u32,
    /// Whether the body moves from picture to picture, so that only what this one shows is worth computing.
    pub moving: bool,
    pub overlay: Overlay,
    /// Of every texel, where they are shown.
    pub errors: Arc<Vec<f32>>,
    /// Another way to compute the same, for a picture beside this one.
    pub other: Option<Quality>,
}

/// A picture for the screen.
pub struct Shown {
    pub image: egui::ColorImage,
    /// The other way.
    pub other: Option<egui::ColorImage>,
    /// The overlay as it lies in the atlas.
    pub atlas: Option<egui::ColorImage>,
    /// Of pictures that stand still.
    pub counters: Option<Counters>,
    /// Of the newest frame that had anything to do.
    pub timings: Option<FrameTimings>,
    /// From the order to the picture.
    pub took: Duration,
}

/// What the scatter did, as far as its method tells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counters {
    pub texels: usize,
    /// Kernel evaluations of an average texel.
    pub evaluations: f32,
    /// Words of lists that would have been filled, and groups that found no room.
    pub lists: Option<[u32; 2]>,
}

/// Who does the work.
#[derive(Clone, Debug)]
pub struct Adapter {
    pub name: String,
    pub is_software: bool,
}

/// The window's end of the thread.
pub struct Worker {
    orders: Option<Sender<Order>>,
    thread: JoinHandle<()>,
}

impl Worker {
    pub fn start(events: &Events) -> Self {
        let (orders, inbox) = channel();
        let events = events.clone();
        let thread = std::thread::spawn(move || {
            let _last_words = LastWords(events.clone());
            let easel = Gpu::new().and_then(|gpu| {
                let Gpu { adapter, is_software, .. } = &gpu;
                let adapter = Adapter { name: adapter.clone(), is_software: *is_software };
                events.send(Event::Ready(Ok(adapter)));
                Easel::new(gpu)
            });
            match easel {
                Ok(easel) => easel.serve(&inbox, &events),
                Err(error) => events.send(Event::Ready(Err(error))),
            }
        });
        Self { orders: Some(orders), thread }
    }

    pub fn order(&self, order: Order) {
        // A worker that has ended has told why.
        if let Some(orders) = &self.orders {
            let _ = orders.send(order);
        }
    }
}

/// Waits for the picture at hand: a driver that is unloaded while it draws takes the program down. All pairs are not waited for.
impl Drop for Worker {
    fn drop(&mut self) {
        self.orders = None;
        let start = Instant::now();
        while !self.thread.is_finished() && start.elapsed() < PATIENCE {
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

/// Tells of a thread that ends before its time: wgpu panics where a driver is reset, say.
struct LastWords(Events);

impl Drop for LastWords {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.send(Event::Ready(Err(Error::Worker)));
        }
    }
}
