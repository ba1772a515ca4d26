//! One body, a point light with a shadow, a little light from all around, and a camera.

use crate::picture::Picture;
use crate::{Gpu, Mode, Model};
use std::time::{Duration, Instant};
use translume::{
    AmbientLight, Body, BodyDescriptor, Camera, Deformation, Frame, FrameTimings, Light, Lighting, LookAt,
    Medium, Method, PointLight, Profile, Stage,
};

/// What differs from one frame to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Nothing to be seen, but everything is computed anew: the body steps back and forth by a millionth of its size.
    Nothing,
    /// The first morph target grows from nothing to a half, and again.
    Morph,
    /// The camera: no stage runs.
    Camera,
}

/// A body in its light, with a stopwatch.
pub struct Scene<'a> {
    gpu: &'a Gpu,
    body: Body,
    picture: Picture,
    lights: [Light; 2],
    middle: [f32; 3],
    diagonal: f32,
    weights: Vec<f32>,
    frames: u32,
}

impl<'a> Scene<'a> {
    /// Jade, 100 mm from corner to corner.
    ///
    /// # Panics
    /// If the body does not fit the device.
    #[must_use]
    pub fn new(gpu: &'a Gpu, model: &Model, mode: &Mode) -> Self {
        let (middle, diagonal) = extent(&model.mesh.positions);
        let mut descriptor = BodyDescriptor {
            medium: Medium::JADE,
            mm_per_unit: 100.0 / diagonal,
            // What the figures of docs/performance.md were measured with.
            profile: Profile::DipoleNormalised,
            ..BodyDescriptor::new(&model.mesh, &model.atlas)
        };
        (mode.describe)(&mut descriptor);
        let mut body = gpu
            .translume
            .create_body(&gpu.device, &descriptor)
            .unwrap_or_else(|error| panic!("{}: {error}", model.name));
        body.set_timings(gpu.has_timestamps);
        let lamp = [-0.6, 0.8, -1.1].map(|x| x * diagonal);
        let lamp = PointLight {
            position: std::array::from_fn(|k| middle[k] + lamp[k]),
            intensity: [8.0 * diagonal * diagonal; 3],
            ..Default::default()
        };
        let ambient = AmbientLight { radiance: [0.1; 3], ..Default::default() };
        Self {
            gpu,
            picture: Picture::new(gpu, &body),
            body,
            lights: [Light::Point(lamp), Light::Ambient(ambient)],
            middle,
            diagonal,
            weights: vec![0.0; model.mesh.targets.len()],
            frames: 0,
        }
    }

    /// Another method of the scatter stage.
    ///
    /// # Panics
    /// If the device cannot hold what it needs.
    pub fn set_method(&mut self, method: Method) {
        self.body.set_method(method).unwrap_or_else(|error| panic!("{error}"));
    }

    /// Whether the body shadows the light from all around, which is the work of [`Stage::Visibility`].
    pub fn shadow_sky(&mut self, shadow: bool) {
        let ambient = AmbientLight { radiance: [0.1; 3], shadow, ..Default::default() };
        self.lights[1] = Light::Ambient(ambient);
    }

    /// How long a whole frame takes: all stages that the change makes stale, and the picture. What `prepare` does on the CPU is not in it.
    ///
    /// # Panics
    /// If the frame is refused, the device is lost, or it returns no timestamps.
    pub fn frame(&mut self, change: Change) -> Duration {
        self.try_frame(change).expect("timestamps of the frame")
    }

    /// As [`frame`](Self::frame); `None` where the device returns no timestamps.
    pub(crate) fn try_frame(&mut self, change: Change) -> Option<Duration> {
        self.prepare(change);
        let eye = if change == Change::Camera { self.frames } else { 0 };
        self.picture.prepare(self.gpu, &self.body, &self.camera(eye));
        let start = Instant::now();
        let mut encoder = self.gpu.encoder();
        let is_static = self.body.pending().is_empty();
        self.body.encode(&mut encoder);
        self.picture.draw(&mut encoder);
        self.gpu.run(encoder);
        let wall = start.elapsed();
        if !self.gpu.has_timestamps {
            return Some(wall);
        }
        let picture = self.picture.time()?;
        if is_static { Some(picture) } else { Some(picture + self.timings()?.total) }
    }

    /// Those of this very frame.
    fn timings(&self) -> Option<FrameTimings> {
        self.body.timings().filter(|timings| timings.frame == u64::from(self.frames))
    }

    /// How long one stage takes in a frame in which all run.
    ///
    /// # Panics
    /// If the frame is refused, the device is lost, or it returns no timestamps.
    pub fn stage(&mut self, stage: Stage) -> Duration {
        self.prepare(Change::Morph);
        if let Some(before) = Stage::ALL.into_iter().take_while(|earlier| *earlier != stage).last() {
            self.encode_through(before);
        }
        let start = Instant::now();
        self.encode_through(stage);
        let wall = start.elapsed();
        if self.gpu.has_timestamps {
            self.timings().and_then(|timings| timings.stage(stage)).expect("timestamps of the stage")
        } else {
            wall
        }
    }

    fn encode_through(&mut self, stage: Stage) {
        let mut encoder = self.gpu.encoder();
        self.body.encode_through(&mut encoder, stage);
        self.gpu.run(encoder);
    }

    fn prepare(&mut self, change: Change) {
        self.frames += 1;
        let mut model = Frame::default().model;
        match change {
            Change::Nothing => model[3][0] = 1e-6 * self.diagonal * (self.frames % 2) as f32,
            Change::Morph => {
                let weight = self.weights.first_mut().expect("a morph target");
                *weight = 0.5 * (self.frames % 64) as f32 / 64.0;
            }
            Change::Camera => (),
        }
        let deformation =
            if self.weights.is_empty() { Deformation::Rest } else { Deformation::Morph(&self.weights) };
        let lighting = Lighting::Lights(&self.lights);
        let frame = Frame { model, deformation, lighting, ..Default::default() };
        self.body
            .prepare(&self.gpu.device, &self.gpu.queue, &frame)
            .unwrap_or_else(|error| panic!("{error}"));
    }

    /// From the front, a degree further to the right with each step.
    fn camera(&self, step: u32) -> Camera {
        let (sine, cosine) = ((step % 360) as f32).to_radians().sin_cos();
        let away = [sine, 0.2, cosine].map(|x| 2.4 * self.diagonal * x);
        Camera::from(LookAt {
            eye: std::array::from_fn(|k| self.middle[k] + away[k]),
            target: self.middle,
            up: [0.0, 1.0, 0.0],
            horizontal_fov: 0.45,
            aspect: 1.0,
            near: self.diagonal,
            far: 4.0 * self.diagonal,
        })
    }
}

/// The middle of a box around the points, and its diagonal.
fn extent(points: &[[f32; 3]]) -> ([f32; 3], f32) {
    let bound = |k: usize, pick: fn(f32, f32) -> f32, start| points.iter().map(|p| p[k]).fold(start, pick);
    let low: [f32; 3] = std::array::from_fn(|k| bound(k, f32::min, f32::INFINITY));
    let high: [f32; 3] = std::array::from_fn(|k| bound(k, f32::max, f32::NEG_INFINITY));
    let middle = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
    (middle, (0..3).map(|k| (high[k] - low[k]).powi(2)).sum::<f32>().sqrt())
}
