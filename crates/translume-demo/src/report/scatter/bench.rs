//! A body whose frames end with the scatter, and a stopwatch.

use super::scene::Scene;
use crate::error::Error;
use crate::gpu::Gpu;
use crate::report::bench::{PATIENCE, Repeats, median};
use crate::report::method;
use std::time::Instant;
use translume::{
    Body, BodyDescriptor, Casters, Frame, Lighting, Medium, Method, Profile, Region, Stage, Translume,
    readback, wgpu,
};
use translume_reference::gather::Source;

pub struct Bench<'a> {
    gpu: &'a Gpu,
    scene: &'a Scene,
    body: Body,
    frames: u64,
}

/// What a method made of the sources.
pub struct Run {
    /// Radiant exitance of every texel, and the kernel evaluations it took where the method counts them.
    pub exitance: Vec<[f32; 4]>,
    /// The scatter stage alone: median.
    pub time_ms: f64,
    /// Groups of receivers that found no room in the lists of the dual scatter.
    pub overflow: Option<u32>,
}

impl<'a> Bench<'a> {
    pub fn new(gpu: &'a Gpu, translume: &Translume, scene: &'a Scene) -> Result<Self, Error> {
        let subject = &scene.subject;
        let descriptor = BodyDescriptor {
            mm_per_unit: subject.mm_per_unit,
            // The reference's all pairs and integral are the dipole's.
            profile: Profile::DipoleNormalised,
            ..BodyDescriptor::new(&subject.model.mesh, &subject.atlas)
        };
        let body = translume.create_body(&gpu.device, &descriptor)?;
        Ok(Self { gpu, scene, body, frames: 0 })
    }

    pub fn set_medium(&mut self, medium: Medium) -> Result<(), Error> {
        Ok(self.body.set_medium(medium)?)
    }

    pub fn profile(&self) -> Profile {
        self.body.profile().clone()
    }

    /// What the scatter reads, as the CPU takes it.
    pub fn sources(&mut self) -> Result<Vec<Source>, Error> {
        self.prepare()?;
        self.encode_through(Stage::Cluster)?;
        let outputs = self.body.outputs();
        let [places, normals, light] =
            [outputs.texel_positions, outputs.texel_normals, outputs.irradiance].map(|b| self.read(b));
        let triple = |[x, y, z, _]: [f32; 4]| [x, y, z].map(f64::from);
        let (places, normals, light) = (places?, normals?, light?);
        let all = places.into_iter().zip(normals).zip(light);
        Ok(all
            .map(|((place, normal), irradiance)| Source {
                position: triple(place),
                normal: triple(normal),
                area: place[3].into(),
                irradiance: triple(irradiance),
            })
            .collect())
    }

    pub fn run(&mut self, method: Method, repeats: Repeats) -> Result<Run, Error> {
        self.body.set_method(method)?;
        let (start, mut times) = (Instant::now(), Vec::new());
        for k in 0..repeats.warm_up + repeats.timed {
            // What is slow is timed once.
            if !times.is_empty() && start.elapsed() > PATIENCE {
                break;
            }
            self.prepare()?;
            self.encode_through(Stage::Cluster)?;
            let time = self.encode_through(Stage::Scatter)?;
            if k >= repeats.warm_up {
                times.push(time);
            }
        }
        let outputs = self.body.outputs();
        let lists = outputs.lists.filter(|_| method::has_lists(method));
        let words = lists.map(|lists| readback::buffer::<u32>(&self.gpu.device, &self.gpu.queue, lists));
        let overflow = words.transpose()?.and_then(|words| words.get(1).copied());
        Ok(Run { exitance: self.read(outputs.exitance)?, time_ms: median(times), overflow })
    }

    /// A frame of which the pose is known, and nothing after it.
    fn prepare(&mut self) -> Result<(), Error> {
        let Scene { subject, lights, .. } = self.scene;
        // Casters that change make the irradiance stale, and all that follows from it.
        self.frames += 1;
        let bounds = Region { low: subject.bounds.0, high: subject.bounds.1 };
        let frame = Frame {
            deformation: (&subject.pose).into(),
            warp: subject.warp,
            lighting: Lighting::Lights(lights),
            casters: Some(Casters { bounds, revision: self.frames }),
            ..Default::default()
        };
        Ok(self.body.prepare(&self.gpu.device, &self.gpu.queue, &frame)?)
    }

    /// From submission to its end, ms.
    fn encode_through(&mut self, last: Stage) -> Result<f64, Error> {
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.body.encode_through(&mut encoder, last);
        self.gpu.time(encoder.finish())
    }

    fn read(&self, buffer: &wgpu::Buffer) -> Result<Vec<[f32; 4]>, Error> {
        Ok(readback::buffer(&self.gpu.device, &self.gpu.queue, buffer)?)
    }
}
