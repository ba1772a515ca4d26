//! Takes a scene's picture in every way, with a stopwatch.

use super::entrant::{Entrant, Way};
use super::stage::Stage;
use crate::canvas::Canvas;
use crate::error::Error;
use crate::gpu::Gpu;
use crate::report::bench::{PATIENCE, Repeats, median};
use crate::report::method;
use std::collections::BTreeMap;
use std::time::Instant;
use translume::{
    Body, BodyDescriptor, CompositeView, Evaluate, Frame, Gloss, Light, Lighting, Method, Profile,
    ShadowOptions, Stage as Until, Translume, Transport, View, readback, wgpu,
};
use translume_rivals::{Geometry, Renderer};

/// What came of one way.
pub struct Taken {
    /// Radiance and coverage, row by row from the top.
    pub picture: Vec<[f32; 4]>,
    /// A frame of a body that moved, from its pose to the picture: median, ms.
    pub frame_ms: f64,
    /// The scatter stage alone, where texels or vertices are its receivers.
    pub scatter_ms: Option<f64>,
    /// Kernel evaluations per texel, where they are counted.
    pub evaluations: Option<f64>,
}

/// A scene in front of a camera.
pub struct Shot<'a> {
    gpu: &'a Gpu,
    translume: &'a Translume,
    stage: &'a Stage,
    repeats: Repeats,
    canvas: Canvas,
    /// By the width of their atlas.
    bodies: BTreeMap<u32, (Body, CompositeView)>,
    frames: u32,
}

/// A step by which the body moves between frames, over its size: everything is computed anew, and nothing looks different.
const NUDGE: f32 = 1e-6;
/// Texels of a lamp's depth map along an edge for each texel of the atlas along one: both cost alike, and are as fine as each other.
const SHADOW_PER_ATLAS: u32 = 4;
/// Rivals want the body's vertices alone.
const LEAST_ATLAS: u32 = 64;

impl<'a> Shot<'a> {
    pub fn new(gpu: &'a Gpu, translume: &'a Translume, stage: &'a Stage) -> Self {
        Self {
            gpu,
            translume,
            stage,
            repeats: Repeats { warm_up: 0, timed: 1 },
            canvas: Canvas::new(&gpu.device, &Canvas::composite(&gpu.device, translume), stage.pixels()),
            bodies: BTreeMap::new(),
            frames: 0,
        }
    }

    /// `None` where the scene has a light that this way does not know.
    pub fn take(&mut self, entrant: &Entrant, repeats: Repeats) -> Result<Option<Taken>, Error> {
        self.repeats = repeats;
        match &entrant.way {
            Way::Ours { atlas, method, evaluate, profile } => {
                self.ours(*atlas, *method, *evaluate, profile).map(Some)
            }
            Way::Rival(rival) => {
                let known = |light: &Light| matches!(light, Light::Directional(_) | Light::Point(_));
                if !self.stage.lights.iter().all(known)
                    || self.stage.lights.len() > translume_rivals::MAX_LIGHTS
                {
                    return Ok(None);
                }
                match self.rival(*rival) {
                    // Such as a lamp so near that one map does not see all of the body.
                    Err(Error::Rival(translume_rivals::Error::Frame { problem, .. })) => {
                        log::info!("{}: {}: {problem}", self.stage.name, entrant.family.name());
                        Ok(None)
                    }
                    taken => taken.map(Some),
                }
            }
        }
    }

    fn ours(
        &mut self,
        atlas: u32,
        method: Method,
        evaluate: Evaluate,
        profile: &str,
    ) -> Result<Taken, Error> {
        let profile = Profile::named(profile)?;
        self.with_body(atlas, |shot, body, view| {
            // Points need the dual scatter, and other methods texels.
            body.set_evaluate(Evaluate::PerTexel)?;
            body.set_method(method)?;
            body.set_evaluate(evaluate)?;
            body.set_profile(profile)?;
            let frame_ms = shot.median(|shot| {
                shot.prepare(body, true)?;
                shot.frame(body, view)
            })?;
            // Frames have warmed up what there is to warm up, and all before the scatter has to run again each time: once is enough.
            let scatter_ms = match evaluate {
                Evaluate::PerTexel | Evaluate::PerVertex => {
                    shot.prepare(body, true)?;
                    shot.through(body, Until::Cluster)?;
                    Some(shot.through(body, Until::Scatter)?)
                }
                _ => None,
            };
            shot.prepare(body, false)?;
            shot.frame(body, view)?;
            let evaluations = (evaluate == Evaluate::PerTexel && method::counts(method))
                .then(|| shot.evaluations(body))
                .transpose()?;
            let picture = readback::texture(&shot.gpu.device, &shot.gpu.queue, &shot.canvas.colour, 0)?;
            Ok(Taken { picture, frame_ms, scatter_ms, evaluations })
        })
    }

    /// By another transport; the frame is that of a body that moved.
    pub fn transport(&mut self, transport: Transport, atlas: u32, repeats: Repeats) -> Result<Taken, Error> {
        self.repeats = repeats;
        self.with_body(atlas, |shot, body, view| {
            body.set_transport(transport)?;
            // The first frame of all is another matter.
            shot.prepare(body, false)?;
            shot.frame(body, view)?;
            let frame_ms = shot.median(|shot| {
                shot.prepare(body, true)?;
                shot.frame(body, view)
            })?;
            let picture = readback::texture(&shot.gpu.device, &shot.gpu.queue, &shot.canvas.colour, 0)?;
            Ok(Taken { picture, frame_ms, scatter_ms: None, evaluations: None })
        })
    }

    fn rival(&mut self, rival: translume_rivals::Rival) -> Result<Taken, Error> {
        self.with_body(LEAST_ATLAS, |shot, body, _| {
            let Gpu { device, queue, .. } = shot.gpu;
            let mesh = &shot.stage.model.mesh;
            let geometry = Geometry::new(device, queue, mesh.positions.len(), &mesh.triangles)?;
            let mut renderer = Renderer::new(device, rival, shot.stage.pixels())?;
            let (low, high) = shot.stage.bounds;
            let mm = |p: [f32; 3]| p.map(|x| x * shot.stage.mm_per_unit);
            let frame = translume_rivals::Frame {
                medium: shot.stage.medium,
                lights: &shot.stage.lights,
                camera: shot.stage.look,
                mm_per_unit: shot.stage.mm_per_unit,
                bounds: [mm(low), mm(high)],
            };
            let mut once = |shot: &mut Self, moved: bool| -> Result<f64, Error> {
                shot.prepare(body, moved)?;
                renderer.prepare(queue, &frame)?;
                let mut encoder = shot.encoder();
                body.encode_through(&mut encoder, Until::Deform);
                geometry.follow(&mut encoder, body)?;
                renderer.encode(&mut encoder, &geometry);
                shot.gpu.time(encoder.finish())
            };
            let frame_ms = shot.median(|shot| once(shot, true))?;
            once(shot, false)?;
            let picture = readback::texture(device, queue, renderer.picture(), 0)?;
            Ok(Taken { picture, frame_ms, scatter_ms: None, evaluations: None })
        })
    }

    fn make(&self, atlas: u32) -> Result<(Body, CompositeView), Error> {
        let layout = self.stage.atlas(atlas)?;
        let descriptor = BodyDescriptor {
            medium: self.stage.medium,
            mm_per_unit: self.stage.mm_per_unit,
            flat_normals: self.stage.flat_normals,
            transport: Transport::Classic,
            ..BodyDescriptor::new(&self.stage.model.mesh, &layout)
        };
        let shadows = ShadowOptions { resolution: SHADOW_PER_ATLAS * atlas, ..descriptor.shadows };
        let descriptor = BodyDescriptor { shadows, ..descriptor };
        let body = self.translume.create_body(&self.gpu.device, &descriptor)?;
        let view = self.canvas.composite.view(&self.gpu.device, &body);
        Ok((body, view))
    }

    /// A body is made or leaves its shelf, and comes back.
    fn with_body<T>(
        &mut self,
        atlas: u32,
        work: impl FnOnce(&mut Self, &mut Body, &mut CompositeView) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let (mut body, mut view) = match self.bodies.remove(&atlas) {
            Some(kept) => kept,
            None => self.make(atlas)?,
        };
        let done = work(self, &mut body, &mut view);
        self.bodies.insert(atlas, (body, view));
        done
    }

    fn median(&mut self, mut time: impl FnMut(&mut Self) -> Result<f64, Error>) -> Result<f64, Error> {
        let (start, mut times) = (Instant::now(), Vec::new());
        for k in 0..self.repeats.warm_up + self.repeats.timed {
            if !times.is_empty() && start.elapsed() > PATIENCE {
                break;
            }
            let time = time(self)?;
            // What is slow is timed once, cold.
            if k >= self.repeats.warm_up || start.elapsed() > PATIENCE {
                times.push(time);
            }
        }
        Ok(median(times))
    }

    fn prepare(&mut self, body: &mut Body, moved: bool) -> Result<(), Error> {
        self.frames += 1;
        let sign = if self.frames.is_multiple_of(2) { NUDGE } else { -NUDGE };
        let step = if moved { sign * self.stage.model.mesh.diagonal() } else { 0.0 };
        let mut model = Frame::default().model;
        model[3][0] = step;
        let frame = Frame {
            model,
            deformation: (&self.stage.pose).into(),
            warp: self.stage.warp,
            lighting: Lighting::Lights(&self.stage.lights),
            casters: None,
            view: Some(View { camera: self.stage.look, pixels: self.stage.pixels() }),
        };
        Ok(body.prepare(&self.gpu.device, &self.gpu.queue, &frame)?)
    }

    /// Everything that is not known yet, and the picture.
    fn frame(&self, body: &mut Body, view: &mut CompositeView) -> Result<f64, Error> {
        let Gpu { device, queue, .. } = self.gpu;
        view.prepare(device, queue, body, &self.stage.look, Gloss::None);
        let mut encoder = self.encoder();
        body.encode(&mut encoder);
        self.canvas.draw(&mut encoder, view);
        self.gpu.time(encoder.finish())
    }

    fn through(&self, body: &mut Body, last: Until) -> Result<f64, Error> {
        let mut encoder = self.encoder();
        body.encode_through(&mut encoder, last);
        self.gpu.time(encoder.finish())
    }

    fn evaluations(&self, body: &Body) -> Result<f64, Error> {
        let exitance: Vec<[f32; 4]> =
            readback::buffer(&self.gpu.device, &self.gpu.queue, body.outputs().exitance)?;
        Ok(exitance.iter().map(|b| f64::from(b[3])).sum::<f64>() / exitance.len().max(1) as f64)
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }
}
