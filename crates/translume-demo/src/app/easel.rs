//! What draws the window's pictures: bodies on the GPU, kept from order to order.

use super::events::{Event, Events};
use super::export::Export;
use super::loaded::Loaded;
use super::worker::{Counters, Order, Shown, Wish};
use crate::albedo;
use crate::canvas::Canvas;
use crate::develop::Developer;
use crate::error::Error;
use crate::framing::Subject;
use crate::gpu::Gpu;
use crate::motion::Motion;
use crate::overlay::{self, Overlay};
use crate::paint::{Outlines, Painter};
use crate::picture::Output;
use crate::scene::{Scene, SceneLight};
use crate::setup::{Substance, VIEW, camera, library_lights};
use crate::studio::Studio;
use async_channel::{Receiver, RecvError, TryRecvError};
use eframe::egui;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use translume::{Camera, Composite, Config, Frame, Light, Lighting, Translume, Transport, View};
use web_time::Instant;

/// The seat of what is exported.
const EXPORT: usize = 2;

/// What the worker owns.
pub struct Easel {
    gpu: Gpu,
    translume: Translume,
    composite: Arc<Composite>,
    developer: Developer,
    painter: Painter,
    /// Of the picture, of the one beside it, and of what is exported.
    seats: [Option<Seat>; 3],
}

/// A body on the GPU, and what it was made of.
struct Seat {
    loaded: Arc<Loaded>,
    substance: Substance,
    /// The texture that the body has.
    albedo: Option<PathBuf>,
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
    pub fn new(gpu: Gpu) -> Result<Self, Error> {
        let translume = Translume::new(&gpu.device, &Config::default())?;
        let (developer, painter) = (Developer::new(&gpu.device), Painter::new(&gpu.device));
        let composite = Canvas::composite(&gpu.device, &translume);
        Ok(Self { gpu, translume, composite, developer, painter, seats: [None, None, None] })
    }

    /// Works until the window is closed.
    pub async fn serve(mut self, inbox: &Receiver<Order>, events: &Events) {
        let mut exports = VecDeque::new();
        while let Ok(orders) = orders(inbox, exports.is_empty()).await {
            let mut newest = None;
            for order in orders {
                match order {
                    Order::Show(wish) => newest = Some(wish),
                    Order::Write(wish, output, path) => {
                        events.send(Event::Written(self.write(&wish, &output).await.map(|()| path)));
                    }
                    Order::Export(export) => exports.push_back(export),
                }
            }
            if let Some(wish) = newest {
                events.send(Event::Shown(self.show(&wish).await.map(Box::new)));
            }
            if let Some(export) = exports.pop_front() {
                match self.export(export, events).await {
                    Ok(Some(export)) => exports.push_front(export),
                    Ok(None) => {}
                    Err(error) => events.send(Event::Exported(Err(error))),
                }
            }
            if exports.is_empty() {
                self.seats[EXPORT] = None;
            }
        }
    }

    /// Adds a frame; gives back what is not yet done.
    async fn export(
        &mut self,
        mut export: Box<Export>,
        events: &Events,
    ) -> Result<Option<Box<Export>>, Error> {
        if export.is_cancelled() {
            drop(export);
            events.send(Event::Exported(Ok(None)));
            return Ok(None);
        }
        let Some(wish) = export.next() else {
            events.send(Event::Exported(Ok(Some(export.finish()?))));
            return Ok(None);
        };
        self.draw(EXPORT, &wish, &wish.scene)?;
        if let Some(seat) = &self.seats[EXPORT] {
            let done = export.add(&seat.studio.picture(export.develop()).await?)?;
            events.send(Event::Exporting { done });
        }
        Ok(Some(export))
    }

    async fn show(&mut self, wish: &Wish) -> Result<Shown, Error> {
        let start = Instant::now();
        let camera = self.draw(0, wish, &wish.scene)?;
        let atlas = match wish.overlay {
            Overlay::None => None,
            _ => Some(self.paint(wish, &camera).await?),
        };
        let image = self.develop(0, wish).await?;
        let took = start.elapsed();
        let (timings, counters) = match &self.seats[0] {
            Some(seat) if wish.samples > 1 => {
                (seat.studio.body().timings(), Some(counters(&self.gpu, seat).await?))
            }
            Some(seat) => (seat.studio.body().timings(), None),
            None => (None, None),
        };
        let other = match &wish.other {
            Some(quality) => {
                let scene = Scene { quality: quality.clone(), ..wish.scene.clone() };
                self.draw(1, wish, &scene)?;
                Some(self.develop(1, wish).await?)
            }
            None => {
                self.seats[1] = None;
                None
            }
        };
        Ok(Shown { image, other, atlas, counters, timings, took })
    }

    async fn develop(&mut self, seat: usize, wish: &Wish) -> Result<egui::ColorImage, Error> {
        let size = wish.pixels.map(|pixels| pixels as usize);
        let Some(seat) = &self.seats[seat] else {
            return Ok(egui::ColorImage::filled(size, egui::Color32::BLACK));
        };
        let (drawn, samples) = seat.studio.drawn();
        // Colours that stand for numbers are not exposed.
        let exposure = if wish.overlay == Overlay::None { wish.scene.look.exposure } else { 0.0 };
        let bytes = self.developer.develop(&self.gpu, drawn, samples, exposure).await?;
        Ok(egui::ColorImage::from_rgba_premultiplied(size, &bytes))
    }

    async fn write(&mut self, wish: &Wish, output: &Output) -> Result<(), Error> {
        self.draw(0, wish, &wish.scene)?;
        match &self.seats[0] {
            Some(seat) => {
                let develop = output.format.develop(wish.scene.look.exposure);
                output.write(&[seat.studio.picture(develop).await?])
            }
            None => Ok(()),
        }
    }

    /// In the colours of the overlay, over what was drawn.
    async fn paint(&self, wish: &Wish, camera: &Camera) -> Result<egui::ColorImage, Error> {
        let Some(seat) = &self.seats[0] else { return Ok(egui::ColorImage::default()) };
        let (body, atlas) = (seat.studio.body(), &wish.loaded.atlas);
        let colours = overlay::colours(&self.gpu, body, atlas, wish.overlay, &wish.errors).await?;
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
        let seat = self.seat(seat, loaded, (substance, &scene.albedo), *pixels, *samples)?;
        seat.lights.update(scene.lights.as_deref().unwrap_or_default(), loaded.opened.just_below_y0())?;
        let camera = subject.look(&camera(scene, &subject, VIEW));
        let view = View { camera, pixels: seat.studio.pixels() };
        loop {
            // Layers are of one picture, too, and which transport it is the first frame tells.
            let has_layers = seat.studio.body().transport_in_use() == Transport::BoundaryLayers;
            let is_one_picture = *overlay == Overlay::None && (*moving || has_layers);
            let frame = Frame {
                model: moment.model.to_cols_array_2d(),
                deformation: (&moment.pose).into(),
                warp: motion.warp,
                lighting: Lighting::Lights(&seat.lights.lights),
                casters: None,
                view: is_one_picture.then_some(view),
            };
            seat.studio.draw(&frame, &camera, gloss)?;
            let body = seat.studio.body();
            let is_other = has_layers != (body.transport_in_use() == Transport::BoundaryLayers);
            // A picture that moves on is not waited for.
            if !is_other && (*samples == 1 || body.is_settled()) {
                return Ok(camera);
            }
        }
    }

    /// The body, made anew where its mesh or its way of scattering is another.
    fn seat(
        &mut self,
        index: usize,
        loaded: &Arc<Loaded>,
        (substance, albedo): (Substance, &Option<PathBuf>),
        pixels: [u32; 2],
        samples: u32,
    ) -> Result<&mut Seat, Error> {
        let slot = &mut self.seats[index];
        let fits = |seat: &mut Seat| seat.loaded.id == loaded.id && seat.substance.is_like(&substance);
        let mut seat = match slot.take_if(fits) {
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
                let mut studio =
                    Studio::new(&self.gpu, (&self.translume, &self.composite), &descriptor, pixels, samples)?;
                studio.body_mut().set_timings(true);
                let outlines = Outlines::new(&self.gpu.device, atlas);
                let lights = slot.take().map(|seat| seat.lights).unwrap_or_default();
                Seat { loaded: Arc::clone(loaded), substance, albedo: None, lights, studio, outlines }
            }
        };
        if seat.albedo != *albedo {
            let laid = (&loaded.opened.model.mesh, &loaded.atlas);
            albedo::apply(seat.studio.body_mut(), &self.gpu.queue, albedo.as_deref(), laid)?;
            seat.albedo.clone_from(albedo);
        }
        Ok(slot.insert(seat))
    }
}

/// Looks at every texel.
async fn counters(gpu: &Gpu, seat: &Seat) -> Result<Counters, Error> {
    let texels = seat.loaded.atlas.texels.len();
    let outputs = seat.studio.body().outputs();
    let exitance = gpu.buffer::<[f32; 4]>(outputs.exitance).await?;
    let evaluations = exitance.iter().map(|value| value[3]).sum::<f32>() / texels.max(1) as f32;
    let lists = match outputs.lists {
        Some(lists) => {
            let words = gpu.buffer::<u32>(lists).await?;
            words.first_chunk::<2>().copied()
        }
        None => None,
    };
    Ok(Counters { transport: seat.studio.body().transport_in_use(), texels, evaluations, lists })
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

/// What has come, once something has if there is nothing else to do; fails where nothing can come any more.
async fn orders(inbox: &Receiver<Order>, is_idle: bool) -> Result<Vec<Order>, RecvError> {
    let first = match inbox.try_recv() {
        Ok(order) => Some(order),
        Err(TryRecvError::Closed) => return Err(RecvError),
        Err(TryRecvError::Empty) if is_idle => Some(inbox.recv().await?),
        Err(TryRecvError::Empty) => None,
    };
    let others = std::iter::from_fn(|| inbox.try_recv().ok());
    Ok(first.into_iter().chain(others).collect())
}
