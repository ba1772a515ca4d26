//! Where a picture is taken: one body, its lights, a camera, and a texture to draw into.

use crate::canvas::Canvas;
use crate::error::Error;
use crate::gpu::Gpu;
use crate::picture::{Develop, Picture};
use std::sync::Arc;
use translume::{Body, BodyDescriptor, Camera, Composite, CompositeView, Frame, Gloss, Translume, wgpu};

/// A body in front of a camera, off screen.
pub struct Studio {
    gpu: Gpu,
    body: Body,
    canvas: Canvas,
    view: CompositeView,
    samples: u32,
}

impl Studio {
    /// Uploads the body; pictures will be `width` × `height` pixels of `samples`² samples each.
    pub fn new(
        gpu: &Gpu,
        (translume, composite): (&Translume, &Arc<Composite>),
        descriptor: &BodyDescriptor<'_>,
        [width, height]: [u32; 2],
        samples: u32,
    ) -> Result<Self, Error> {
        check_size(gpu, [width, height], samples)?;
        let body = translume.create_body(&gpu.device, descriptor)?;
        let canvas = Canvas::new(&gpu.device, composite, [width * samples, height * samples]);
        let view = canvas.composite.view(&gpu.device, &body);
        Ok(Self { gpu: gpu.clone(), body, canvas, view, samples })
    }

    /// Later pictures have so many pixels and samples.
    pub fn resize(&mut self, [width, height]: [u32; 2], samples: u32) -> Result<(), Error> {
        check_size(&self.gpu, [width, height], samples)?;
        self.samples = samples;
        self.canvas.resize(&self.gpu.device, [width * samples, height * samples]);
        Ok(())
    }

    /// Computes one frame and draws it.
    pub fn draw(&mut self, frame: &Frame<'_>, camera: &Camera, gloss: Gloss) -> Result<(), Error> {
        let Gpu { device, queue, .. } = &self.gpu;
        self.body.prepare(device, queue, frame)?;
        self.view.prepare(device, queue, &self.body, camera, gloss);
        let mut encoder =
            device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        self.body.encode(&mut encoder);
        self.canvas.draw(&mut encoder, &self.view);
        queue.submit([encoder.finish()]);
        Ok(())
    }

    /// What was drawn, as a picture.
    pub async fn picture(&self, develop: Develop) -> Result<Picture, Error> {
        let samples = self.gpu.texture::<[f32; 4]>(&self.canvas.colour).await?;
        Ok(Picture::from_samples(&samples, self.canvas.colour.width(), self.samples, develop))
    }

    /// What was drawn: radiance and coverage, `samples`² of them a pixel.
    pub fn drawn(&self) -> (&wgpu::Texture, u32) {
        (&self.canvas.colour, self.samples)
    }

    /// Width and height of what is drawn, in samples.
    pub fn pixels(&self) -> [u32; 2] {
        [self.canvas.colour.width(), self.canvas.colour.height()]
    }

    pub fn canvas(&self) -> &Canvas {
        &self.canvas
    }

    pub fn body(&self) -> &Body {
        &self.body
    }

    pub fn body_mut(&mut self) -> &mut Body {
        &mut self.body
    }
}

fn check_size(gpu: &Gpu, [width, height]: [u32; 2], samples: u32) -> Result<(), Error> {
    let limit = gpu.device.limits().max_texture_dimension_2d;
    if width.max(height) * samples <= limit {
        return Ok(());
    }
    let problem = format!(
        "{width} × {height} pixels with {samples} × {samples} samples exceed this adapter's {limit} texels; \
         choose fewer pixels or samples"
    );
    Err(Error::Option { option: "--size", problem })
}
