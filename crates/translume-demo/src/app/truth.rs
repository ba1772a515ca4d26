//! Two ways to find out how right a picture is, beside the window: paths of light, and all pairs of texels.

use super::events::{Event, Events};
use super::loaded::Loaded;
use crate::albedo;
use crate::error::Error;
use crate::gpu::Gpu;
use crate::motion::Motion;
use crate::overlay;
use crate::picture::{Develop, Picture};
use crate::scene::{Quality, Scene};
use crate::setup::{Substance, library_lights};
use crate::trace::{Limits, Subject, samples, trace};
use eframe::egui;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;
use translume::{Body, Frame, Lighting, Translume, readback, wgpu};

/// Pixels across a picture by paths.
const WIDTH: u32 = 192;
/// Noise at which paths end.
const NOISE: f64 = 0.02;

/// A picture by paths as far as it has come.
pub struct Traced {
    pub image: egui::ColorImage,
    /// Standard error over the mean.
    pub noise: f64,
    pub seconds: f64,
    pub done: bool,
}

/// Errors against all pairs.
pub struct Judged {
    /// Of which model's texels.
    pub loaded: u64,
    /// Of each texel.
    pub errors: Arc<Vec<f32>>,
    /// Root mean square, and what 99 % stay below.
    pub rms: f32,
    pub most: f32,
    pub seconds: f64,
}

/// Work that ends when it is dropped.
pub struct Task {
    number: u64,
    cancelled: Arc<AtomicBool>,
}

impl Task {
    fn start(work: impl FnOnce(u64, &AtomicBool) + Send + 'static) -> Self {
        static NUMBER: AtomicU64 = AtomicU64::new(1);
        let task = Self {
            number: NUMBER.fetch_add(1, Ordering::Relaxed),
            cancelled: Arc::new(AtomicBool::new(false)),
        };
        let (number, cancelled) = (task.number, Arc::clone(&task.cancelled));
        std::thread::spawn(move || work(number, &cancelled));
        task
    }

    pub fn is(&self, number: u64) -> bool {
        self.number == number
    }

    /// Follows paths through a scene until little noise is left.
    pub fn trace(scene: Scene, loaded: Arc<Loaded>, events: &Events) -> Self {
        let events = events.clone();
        Self::start(move |number, cancelled| {
            let send = |result| events.send(Event::Traced(number, result));
            let start = Instant::now();
            let exposure = scene.look.exposure;
            let traced = |samples: Vec<[f32; 4]>, width: usize, noise, done| {
                let picture = Picture::from_samples(&samples, width as u32, 1, Develop::Display { exposure });
                let size = [picture.width as usize, picture.height as usize];
                let image = egui::ColorImage::from_rgb(size, &picture.to_srgb());
                Traced { image, noise, seconds: start.elapsed().as_secs_f64(), done }
            };
            let limits = Limits { noise: Some(NOISE), seconds: None, samples: None, seed: 1 };
            let result = Subject::new(&scene, &loaded.opened, Some(WIDTH)).and_then(|subject| {
                trace(&subject, &limits, |status| {
                    let estimate = status.estimate;
                    send(Ok(traced(samples(estimate), estimate.width, status.noise, false)));
                    !cancelled.load(Ordering::Relaxed)
                })
            });
            if !cancelled.load(Ordering::Relaxed) {
                send(
                    result.map(|estimate| traced(samples(&estimate), estimate.width, estimate.noise(), true)),
                );
            }
        })
    }

    /// Holds the scatter of a scene against all pairs, on a device of its own, as that may take minutes.
    pub fn judge(scene: Scene, loaded: Arc<Loaded>, events: &Events) -> Self {
        let events = events.clone();
        Self::start(move |number, cancelled| {
            let result = judge(&scene, &loaded);
            if !cancelled.load(Ordering::Relaxed) {
                events.send(Event::Judged(number, result));
            }
        })
    }
}

impl Drop for Task {
    fn drop(&mut self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }
}

fn judge(scene: &Scene, loaded: &Loaded) -> Result<Judged, Error> {
    let start = Instant::now();
    let gpu = Gpu::new()?;
    let translume = Translume::new(&gpu.device)?;
    let opened = &loaded.opened;
    let motion = Motion::new(&opened.model, &scene.wish(), 1)?;
    let moment = motion.moment(0);
    let lights = library_lights(scene.lights.as_deref().unwrap_or_default(), opened.just_below_y0())?;
    let frame = Frame {
        model: moment.model.to_cols_array_2d(),
        deformation: (&moment.pose).into(),
        warp: motion.warp,
        lighting: Lighting::Lights(&lights),
        ..Default::default()
    };
    let substance = Substance::new(scene, Path::new(""))?;
    let plain = Quality {
        method: "all-pairs".to_owned(),
        evaluate: "texel".to_owned(),
        tolerance: None,
        theta: None,
        ..scene.quality.clone()
    };
    let exact = Substance { method: plain.method()?, evaluate: plain.evaluate()?, ..substance.clone() };
    let exitance = |substance: &Substance| {
        let descriptor = substance.descriptor(&opened.model.mesh, &loaded.atlas, opened.flat_normals);
        let mut body = translume.create_body(&gpu.device, &descriptor)?;
        let laid = (&opened.model.mesh, &loaded.atlas);
        albedo::apply(&mut body, &gpu.queue, scene.albedo.as_deref(), laid)?;
        exitance(&gpu, &mut body, &frame)
    };
    let errors = overlay::errors(&exitance(&substance)?, &exitance(&exact)?);
    let rms = (errors.iter().map(|error| error * error).sum::<f32>() / errors.len().max(1) as f32).sqrt();
    let mut sorted = errors.clone();
    sorted.sort_by(f32::total_cmp);
    let most = sorted.get(sorted.len() * 99 / 100).copied().unwrap_or(0.0);
    let seconds = start.elapsed().as_secs_f64();
    Ok(Judged { loaded: loaded.id, errors: Arc::new(errors), rms, most, seconds })
}

fn exitance(gpu: &Gpu, body: &mut Body, frame: &Frame<'_>) -> Result<Vec<[f32; 4]>, Error> {
    let Gpu { device, queue, .. } = gpu;
    body.prepare(device, queue, frame)?;
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("judge") });
    body.encode(&mut encoder);
    queue.submit([encoder.finish()]);
    Ok(readback::buffer(device, queue, body.outputs().exitance)?)
}
