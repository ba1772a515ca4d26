//! The GPU's thread: takes orders for pictures, the newest first, and never keeps the window waiting.

use super::events::{Event, Events};
use super::loaded::Loaded;
use crate::develop::Developer;
use crate::error::Error;
use crate::framing::Subject;
use crate::gpu::Gpu;
use crate::motion::Motion;
use crate::overlay::{self, Overlay};
use crate::paint::{Outlines, Painter};
use crate::picture::Output;
use crate::scene::{Quality, Scene, SceneLight};
use crate::setup::{Substance, VIEW, camera, library_lights};
use crate::studio::Studio;
use eframe::egui;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use translume::{Camera, Frame, FrameTimings, Light, Lighting, Translume, View, readback};

/// What a window that closes waits for at most.
const PATIENCE: Duration = Duration::from_secs(5);

/// What the window wants.
pub enum Order {
    /// A picture on the screen; only the newest such order counts.
    Show(Wish),
    /// A picture in a file.
    Write(Wish, Output, PathBuf),
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

/// What the thread owns.
struct Easel {
    gpu: Gpu,
    translume: Translume,
    developer: Developer,
    painter: Painter,
    /// Of the picture, and of the one beside it.
    seats: [Option<Seat>; 2],
}

/// A body on the GPU, and what it was made of.
struct Seat {
    loaded: Arc<Loaded>,
    substance: Substance,
    lights: Lit,
    studio: Studio,
    outlines: Outlines,
}

/// Lights as the scene and as the library has them: maps are read once.
#[derive(Default)]
struct Lit {
    scene: Option<Vec<SceneLight>>,
    lights: Vec<Light>,
}

impl Easel {
    fn new(gpu: Gpu) -> Result<Self, Error> {
        let translume = Translume::new(&gpu.device)?;
        let (developer, painter) = (Developer::new(&gpu.device), Painter::new(&gpu.device));
        Ok(Self { gpu, translume, developer, painter, seats: [None, None] })
    }

    fn serve(mut self, inbox: &Receiver<Order>, events: &Events) {
        while let Ok(first) = inbox.recv() {
            let mut newest = None;
            for order in std::iter::once(first).chain(inbox.try_iter()) {
                match order {
                    Order::Show(wish) => newest = Some(wish),
                    Order::Write(wish, output, path) => {
                        events.send(Event::Written(self.write(&wish, &output).map(|()| path)));
                    }
                }
            }
            if let Some(wish) = newest {
                events.send(Event::Shown(self.show(&wish).map(Box::new)));
            }
        }
    }

    fn show(&mut self, wish: &Wish) -> Result<Shown, Error> {
        let start = Instant::now();
        let camera = self.draw(0, wish, &wish.scene)?;
        let atlas = match wish.overlay {
            Overlay::None => None,
            _ => Some(self.paint(wish, &camera)?),
        };
        let image = self.develop(0, wish)?;
        let took = start.elapsed();
        let (timings, counters) = match &self.seats[0] {
            Some(seat) if wish.samples > 1 => {
                (seat.studio.body().timings(), Some(counters(&self.gpu, seat)?))
            }
            Some(seat) => (seat.studio.body().timings(), None),
            None => (None, None),
        };
        let other = match &wish.other {
            Some(quality) => {
                let scene = Scene { quality: quality.clone(), ..wish.scene.clone() };
                self.draw(1, wish, &scene)?;
                Some(self.develop(1, wish)?)
            }
            None => {
                self.seats[1] = None;
                None
            }
        };
        Ok(Shown { image, other, atlas, counters, timings, took })
    }

    fn develop(&mut self, seat: usize, wish: &Wish) -> Result<egui::ColorImage, Error> {
        let size = wish.pixels.map(|pixels| pixels as usize);
        let Some(seat) = &self.seats[seat] else {
            return Ok(egui::ColorImage::filled(size, egui::Color32::BLACK));
        };
        let (drawn, samples) = seat.studio.drawn();
        // Colours that stand for numbers are not exposed.
        let exposure = if wish.overlay == Overlay::None { wish.scene.look.exposure } else { 0.0 };
        let bytes = self.developer.develop(&self.gpu, drawn, samples, exposure)?;
        Ok(egui::ColorImage::from_rgba_premultiplied(size, &bytes))
    }

    fn write(&mut self, wish: &Wish, output: &Output) -> Result<(), Error> {
        self.draw(0, wish, &wish.scene)?;
        match &self.seats[0] {
            Some(seat) => output.write(&[seat.studio.picture(output.develop(wish.scene.look.exposure))?]),
            None => Ok(()),
        }
    }

    /// In the colours of the overlay, over what was drawn.
    fn paint(&self, wish: &Wish, camera: &Camera) -> Result<egui::ColorImage, Error> {
        let Some(seat) = &self.seats[0] else { return Ok(egui::ColorImage::default()) };
        let (body, atlas) = (seat.studio.body(), &wish.loaded.atlas);
        let colours = overlay::colours(&self.gpu, body, atlas, wish.overlay, &wish.errors)?;
        let view = (camera, seat.substance.mm_per_unit);
        let (canvas, outlines) = (seat.studio.canvas(), &seat.outlines);
        self.painter.paint(&self.gpu, canvas, (body, outlines), view, (atlas.size, &colours));
        let size = [atlas.size as usize; 2];
        Ok(egui::ColorImage::from_rgba_unmultiplied(size, colours.as_flattened()))
    }

    fn draw(&mut self, seat: usize, wish: &Wish, scene: &Scene) -> Result<Camera, Error> {
        let Wish { loaded, pixels, samples, moving, overlay, .. } = wish;
        let substance = Substance::new(scene, Path::new(""))?;
        let gloss = scene.look.gloss()?;
        let motion = Motion::new(&loaded.opened.model, &scene.wish(), 1)?;
        let subject = Subject::new(motion.points()?);
        let moment = motion.moment(0);
        let seat = self.seat(seat, loaded, substance, *pixels, *samples)?;
        seat.lights.update(scene.lights.as_deref().unwrap_or_default(), loaded.opened.just_below_y0())?;
        let camera = subject.look(&camera(scene, &subject, VIEW));
        let is_one_picture = *moving && *overlay == Overlay::None;
        let frame = Frame {
            model: moment.model.to_cols_array_2d(),
            deformation: (&moment.pose).into(),
            warp: motion.warp,
            lighting: Lighting::Lights(&seat.lights.lights),
            casters: None,
            view: is_one_picture.then(|| View { camera, pixels: seat.studio.pixels() }),
        };
        seat.studio.draw(&frame, &camera, gloss)?;
        Ok(camera)
    }

    /// The body, made anew where its mesh or its way of scattering is another.
    fn seat(
        &mut self,
        index: usize,
        loaded: &Arc<Loaded>,
        substance: Substance,
        pixels: [u32; 2],
        samples: u32,
    ) -> Result<&mut Seat, Error> {
        let slot = &mut self.seats[index];
        let fits = |seat: &mut Seat| seat.loaded.id == loaded.id && seat.substance.is_like(&substance);
        let seat = match slot.take_if(fits) {
            Some(mut seat) => {
                seat.studio.resize(pixels, samples)?;
                let body = seat.studio.body_mut();
                body.set_medium(substance.medium)?;
                body.set_shadows(substance.shadows)?;
                Seat { substance, ..seat }
            }
            None => {
                let Loaded { opened, atlas, .. } = &**loaded;
                let descriptor = substance.descriptor(&opened.model.mesh, atlas, opened.flat_normals);
                let mut studio = Studio::new(&self.gpu, &self.translume, &descriptor, pixels, samples)?;
                studio.body_mut().set_timings(true);
                let outlines = Outlines::new(&self.gpu.device, atlas);
                let lights = slot.take().map(|seat| seat.lights).unwrap_or_default();
                Seat { loaded: Arc::clone(loaded), substance, lights, studio, outlines }
            }
        };
        Ok(slot.insert(seat))
    }
}

/// Looks at every texel.
fn counters(gpu: &Gpu, seat: &Seat) -> Result<Counters, Error> {
    let texels = seat.loaded.atlas.texels.len();
    let outputs = seat.studio.body().outputs();
    let exitance = readback::buffer::<[f32; 4]>(&gpu.device, &gpu.queue, outputs.exitance)?;
    let evaluations = exitance.iter().map(|value| value[3]).sum::<f32>() / texels.max(1) as f32;
    let lists = match outputs.lists {
        Some(lists) => {
            let words = readback::buffer::<u32>(&gpu.device, &gpu.queue, lists)?;
            words.first_chunk::<2>().copied()
        }
        None => None,
    };
    Ok(Counters { texels, evaluations, lists })
}

impl Lit {
    fn update(&mut self, lights: &[SceneLight], just_below_y0: f32) -> Result<(), Error> {
        if self.scene.as_deref() != Some(lights) {
            self.lights = library_lights(lights, just_below_y0)?;
            self.scene = Some(lights.to_vec());
        }
        Ok(())
    }
}
