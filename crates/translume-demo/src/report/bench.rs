//! A body whose frames end with the gather, and a stopwatch.

use super::IOR;
use super::subject::Subject;
use crate::error::Error;
use crate::gpu::Gpu;
use std::time::{Duration, Instant};
use translume::{
    Body, BodyDescriptor, Casters, Deformation, Entry, Frame, Light, Lighting, Medium, Profile, Region,
    ShadowOptions, Stage, Translume, readback, wgpu,
};

/// After so long no repetition begins: what is slow needs few.
pub const PATIENCE: Duration = Duration::from_secs(2);

pub struct Bench<'a> {
    gpu: &'a Gpu,
    body: Body,
    deformation: Deformation<'a>,
    casters: Casters,
    repeats: Repeats,
}

/// How often a frame is repeated before and while it is timed.
#[derive(Clone, Copy)]
pub struct Repeats {
    pub warm_up: u32,
    pub timed: u32,
}

impl<'a> Bench<'a> {
    pub fn new(
        gpu: &'a Gpu,
        translume: &Translume,
        subject: &'a Subject,
        repeats: Repeats,
    ) -> Result<Self, Error> {
        let descriptor = BodyDescriptor {
            medium: Medium { ior: IOR, ..Medium::default() },
            mm_per_unit: subject.mm_per_unit,
            // Light alone is judged: all that enters counts alike.
            profile: Profile::HalfSpace(Entry::Diffuse),
            ..BodyDescriptor::new(&subject.model.mesh, &subject.atlas)
        };
        let body = translume.create_body(&gpu.device, &descriptor)?;
        let (low, high) = subject.bounds;
        let casters = Casters { bounds: Region { low, high }, revision: 0 };
        Ok(Self { gpu, body, deformation: (&subject.pose).into(), casters, repeats })
    }

    pub fn set_shadows(&mut self, shadows: ShadowOptions) -> Result<(), Error> {
        Ok(self.body.set_shadows(shadows)?)
    }

    /// What the lights cost, ms. They are on in the last frame.
    pub fn cost(&mut self, lights: &[Light]) -> Result<f64, Error> {
        self.median_of(lights, |bench| {
            let dark = bench.frame(bench.deformation, &[])?;
            Ok(bench.frame(bench.deformation, lights)? - dark)
        })
    }

    /// What a frame costs that has no light, ms.
    pub fn dark_cost(&mut self) -> Result<f64, Error> {
        self.median_of(&[], |bench| bench.frame(bench.deformation, &[]))
    }

    fn median_of(
        &mut self,
        warm: &[Light],
        mut time: impl FnMut(&mut Self) -> Result<f64, Error>,
    ) -> Result<f64, Error> {
        let (start, mut times) = (Instant::now(), Vec::new());
        for k in 0..self.repeats.warm_up {
            if k == 0 || start.elapsed() < PATIENCE {
                self.frame(self.deformation, warm)?;
            }
        }
        for k in 0..self.repeats.timed {
            if k == 0 || start.elapsed() < PATIENCE {
                times.push(time(self)?);
            }
        }
        Ok(median(times))
    }

    /// One frame of which nothing but the pose is known already, through the gather; from submission to its end, ms.
    pub fn frame(&mut self, deformation: Deformation<'_>, lights: &[Light]) -> Result<f64, Error> {
        // Casters that change make every depth map and all that is known of the sky stale.
        self.casters.revision += 1;
        let frame = Frame {
            deformation,
            lighting: Lighting::Lights(lights),
            casters: Some(self.casters),
            ..Default::default()
        };
        let Gpu { device, queue, .. } = self.gpu;
        self.body.prepare(device, queue, &frame)?;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.body.encode_through(&mut encoder, Stage::Gather);
        self.gpu.time(encoder.finish())
    }

    /// Irradiance of every texel in the last frame.
    pub fn irradiance(&self) -> Result<Vec<[f64; 3]>, Error> {
        let texels = self.read(self.body.outputs().irradiance)?;
        Ok(texels.into_iter().map(|[r, g, b, _]| [r, g, b].map(f64::from)).collect())
    }

    /// Live area of every texel in the last frame, mm².
    pub fn areas(&self) -> Result<Vec<f64>, Error> {
        let texels = self.read(self.body.outputs().texel_positions)?;
        Ok(texels.into_iter().map(|[.., area]| area.into()).collect())
    }

    fn read(&self, buffer: &wgpu::Buffer) -> Result<Vec<[f32; 4]>, Error> {
        Ok(readback::buffer(&self.gpu.device, &self.gpu.queue, buffer)?)
    }
}

/// Of at least one value; of an even number of values the higher one in the middle.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
