//! Where a picture is taken: one body, its lights, a camera, and a texture to draw into.

use crate::canvas::Canvas;
use crate::error::Error;
use crate::gpu::Gpu;
use crate::picture::{Develop, Picture};
use translume::{
    Body, BodyDescriptor, Camera, CompositeView, Frame, FrameTimings, Gloss, Translume, readback, wgpu,
};

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
        gpu: Gpu,
        descriptor: &BodyDescriptor<'_>,
        width: u32,
        height: u32,
        samples: u32,
    ) -> Result<Self, Error> {
        let limit = gpu.device.limits().max_texture_dimension_2d;
        if width.max(height) * samples > limit {
            let problem = format!(
                "{width} × {height} pixels with {samples} × {samples} samples exceed this adapter's {limit} texels; \
                 choose fewer pixels or samples"
            );
            return Err(Error::Option { option: "--size", problem });
        }
        let translume = Translume::new(&gpu.device)?;
        let body = translume.create_body(&gpu.device, descriptor)?;
        let canvas = Canvas::new(&gpu.device, &translume, [width * samples, height * samples]);
        let view = canvas.composite.view(&gpu.device, &body);
        Ok(Self { gpu, body, canvas, view, samples })
    }

    /// Computes one frame and takes its picture.
    pub fn take(
        &mut self,
        frame: &Frame<'_>,
        camera: &Camera,
        gloss: Gloss,
        develop: Develop,
    ) -> Result<Picture, Error> {
        let Gpu { device, queue, .. } = &self.gpu;
        self.body.prepare(device, queue, frame)?;
        self.view.prepare(device, queue, &self.body, camera, gloss);
        let mut encoder =
            device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        self.body.encode(&mut encoder);
        self.canvas.draw(&mut encoder, &self.view);
        queue.submit([encoder.finish()]);
        let samples = readback::texture::<[f32; 4]>(device, queue, &self.canvas.colour, 0)?;
        Ok(Picture::from_samples(&samples, self.canvas.colour.width(), self.samples, develop))
    }

    /// Width and height of what is drawn.
    pub fn pixels(&self) -> [u32; 2] {
        [self.canvas.colour.width(), self.canvas.colour.height()]
    }

    /// Whether further frames are timed.
    pub fn set_timings(&mut self, on: bool) {
        self.body.set_timings(on);
    }

    /// How long the last frame took that had anything to do.
    pub fn timings(&self) -> Option<FrameTimings> {
        self.body.timings()
    }

    /// The adapter's name, for messages.
    pub fn adapter(&self) -> &str {
        &self.gpu.adapter
    }
}
