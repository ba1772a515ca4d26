//! A body on the GPU and what its stages wrote, in double precision.

use crate::{Model, gpu};
use std::sync::Arc;
use translume::{
    Body, BodyDescriptor, Cluster, Error, Frame, Profile, ShadowOptions, Stage, Transport, Work, readback,
    wgpu,
};
use translume_reference::gather::Source;

/// A model, and the body made of it.
pub struct Fixture {
    /// Mesh and atlas.
    pub model: Arc<Model>,
    /// The body.
    pub body: Body,
    /// As in the body's descriptor.
    pub mm_per_unit: f64,
    /// As in the body's descriptor.
    pub flat_normals: bool,
}

impl Fixture {
    /// A body with `mm_per_unit` 1, depth maps of 256² and the classical dipole, whose twin has a closed form, unless `change` says
    /// otherwise.
    ///
    /// # Panics
    /// If the body cannot be created.
    #[must_use]
    pub fn new<'a>(model: &'a Arc<Model>, change: impl FnOnce(&mut BodyDescriptor<'a>)) -> Self {
        Self::try_new(model, change).unwrap_or_else(|error| panic!("[{}] {error}", gpu().adapter_name))
    }

    /// As [`new`](Self::new).
    ///
    /// # Errors
    /// What `create_body` says.
    pub fn try_new<'a>(
        model: &'a Arc<Model>,
        change: impl FnOnce(&mut BodyDescriptor<'a>),
    ) -> Result<Self, Error> {
        let mut descriptor = BodyDescriptor {
            mm_per_unit: 1.0,
            profile: Profile::DipoleNormalised,
            transport: Transport::Classic,
            shadows: ShadowOptions { resolution: 256, ..ShadowOptions::default() },
            ..BodyDescriptor::new(&model.mesh, &model.atlas)
        };
        change(&mut descriptor);
        let body = gpu().translume.create_body(&gpu().device, &descriptor)?;
        let (mm_per_unit, flat_normals) = (f64::from(descriptor.mm_per_unit), descriptor.flat_normals);
        Ok(Self { model: Arc::clone(model), body, mm_per_unit, flat_normals })
    }

    /// One frame: prepare, encode, submit.
    ///
    /// # Panics
    /// If the frame is refused.
    pub fn run(&mut self, frame: &Frame<'_>) {
        self.prepare(frame).unwrap_or_else(|error| panic!("[{}] {error}", gpu().adapter_name));
        self.encode();
    }

    /// One frame up to its irradiance; the later stages stay pending.
    ///
    /// # Panics
    /// If the frame is refused.
    pub fn light(&mut self, frame: &Frame<'_>) -> Work {
        self.prepare(frame).unwrap_or_else(|error| panic!("[{}] {error}", gpu().adapter_name));
        let mut encoder = gpu().device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let work = self.body.encode_through(&mut encoder, Stage::Gather);
        gpu().queue.submit([encoder.finish()]);
        work
    }

    /// Prepares a frame without encoding it.
    ///
    /// # Errors
    /// What `prepare` says.
    pub fn prepare(&mut self, frame: &Frame<'_>) -> Result<(), Error> {
        self.body.prepare(&gpu().device, &gpu().queue, frame)
    }

    /// Encodes and submits what is pending.
    pub fn encode(&mut self) -> Work {
        let mut encoder = gpu().device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let work = self.body.encode(&mut encoder);
        gpu().queue.submit([encoder.finish()]);
        work
    }

    /// Deformed vertex positions, mm.
    #[must_use]
    pub fn positions(&self) -> Vec<[f64; 3]> {
        triples(self.body.outputs().positions)
    }

    /// Deformed vertex normals.
    #[must_use]
    pub fn normals(&self) -> Vec<[f64; 3]> {
        triples(self.body.outputs().normals)
    }

    /// Irradiance of each texel.
    #[must_use]
    pub fn irradiance(&self) -> Vec<[f64; 3]> {
        triples(self.body.outputs().irradiance)
    }

    /// Radiant exitance of each texel.
    #[must_use]
    pub fn exitance(&self) -> Vec<[f64; 3]> {
        triples(self.body.outputs().exitance)
    }

    /// Clusters of all levels above the texels.
    #[must_use]
    pub fn clusters(&self) -> Vec<Cluster> {
        read(self.body.outputs().clusters)
    }

    /// What the gather wrote, as the CPU twins take it.
    #[must_use]
    pub fn sources(&self) -> Vec<Source> {
        let outputs = self.body.outputs();
        let places = read::<[f32; 4]>(outputs.texel_positions);
        let normals = triples(outputs.texel_normals);
        let light = triples(outputs.irradiance);
        places
            .iter()
            .zip(normals.into_iter().zip(light))
            .map(|(&[x, y, z, area], (normal, irradiance))| Source {
                position: [x, y, z].map(f64::from),
                normal,
                area: area.into(),
                irradiance,
            })
            .collect()
    }
}

fn triples(buffer: &wgpu::Buffer) -> Vec<[f64; 3]> {
    read::<[f32; 4]>(buffer).into_iter().map(|[x, y, z, _]| [x, y, z].map(f64::from)).collect()
}

fn read<T: bytemuck::Pod>(buffer: &wgpu::Buffer) -> Vec<T> {
    readback::buffer(&gpu().device, &gpu().queue, buffer)
        .unwrap_or_else(|error| panic!("[{}] {error}", gpu().adapter_name))
}
