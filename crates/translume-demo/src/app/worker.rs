//! The GPU's thread: takes orders for pictures, the newest first, and never keeps the window waiting. In a browser, which has one thread,
//! it gives way to the window whenever it waits for the GPU.

use super::easel::Easel;
use super::events::{Event, Events};
use super::export::Export;
use super::loaded::Loaded;
use crate::gpu::Gpu;
use crate::overlay::Overlay;
use crate::picture::Output;
use crate::scene::{Quality, Scene};
use async_channel::{Receiver, Sender, unbounded};
use eframe::egui;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use translume::{FrameTimings, Transport};

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
    /// What ran.
    pub transport: Transport,
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
    orders: Sender<Order>,
    #[cfg(not(target_arch = "wasm32"))]
    thread: std::thread::JoinHandle<()>,
}

impl Worker {
    pub fn start(events: &Events) -> Self {
        let (orders, inbox) = unbounded();
        let events = events.clone();
        #[cfg(not(target_arch = "wasm32"))]
        let thread = std::thread::spawn(move || {
            let _last_words = LastWords(events.clone());
            pollster::block_on(work(&inbox, &events));
        });
        #[cfg(target_arch = "wasm32")]
        wasm_bindgen_futures::spawn_local(async move { work(&inbox, &events).await });
        Self {
            orders,
            #[cfg(not(target_arch = "wasm32"))]
            thread,
        }
    }

    pub fn order(&self, order: Order) {
        // A worker that has ended has told why.
        let _ = self.orders.try_send(order);
    }
}

/// Until the window is closed.
async fn work(inbox: &Receiver<Order>, events: &Events) {
    let easel = Gpu::open().await.and_then(|gpu| {
        let Gpu { adapter, is_software, .. } = &gpu;
        let adapter = Adapter { name: adapter.clone(), is_software: *is_software };
        events.send(Event::Ready(Ok(adapter)));
        Easel::new(gpu)
    });
    match easel {
        Ok(easel) => easel.serve(inbox, events).await,
        Err(error) => events.send(Event::Ready(Err(error))),
    }
}

/// Waits for the picture at hand: a driver that is unloaded while it draws takes the program down. All pairs are not waited for.
#[cfg(not(target_arch = "wasm32"))]
impl Drop for Worker {
    fn drop(&mut self) {
        /// What a window that closes waits for at most.
        const PATIENCE: Duration = Duration::from_secs(5);
        self.orders.close();
        let start = std::time::Instant::now();
        while !self.thread.is_finished() && start.elapsed() < PATIENCE {
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

/// Tells of a thread that ends before its time: wgpu panics where a driver is reset, say.
#[cfg(not(target_arch = "wasm32"))]
struct LastWords(Events);

#[cfg(not(target_arch = "wasm32"))]
impl Drop for LastWords {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.send(Event::Ready(Err(crate::error::Error::Worker)));
        }
    }
}
