//! Where a picture is taken: one body, its lights, a camera, and a texture to draw into.

use crate::error::Error;
use crate::gpu::Gpu;
use crate::picture::{Develop, Picture};
use translume::{
    Body, BodyDescriptor, Camera, Composite, CompositeTarget, CompositeView, Frame, FrameTimings, Gloss,
    Translume, readback, wgpu,
};

/// A body in front of a camera, off screen.
pub struct Studio {
    gpu: Gpu,
    body: Body,
    composite: Composite,
    view: CompositeView,
    colour: wgpu::Texture,
    depth: wgpu::TextureView,
    samples: u32,
}

impl Studio {
    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
    const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

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
        let target = CompositeTarget {
            format: Self::FORMAT,
            depth: Some((Self::DEPTH, wgpu::CompareFunction::Less)),
            samples: 1,
        };
        let composite = translume.composite(&gpu.device, target);
        let view = composite.view(&gpu.device, &body);
        let colour = attachment(&gpu.device, Self::FORMAT, width * samples, height * samples);
        let depth = attachment(&gpu.device, Self::DEPTH, width * samples, height * samples);
        let depth = depth.create_view(&wgpu::TextureViewDescriptor::default());
        Ok(Self { gpu, body, composite, view, colour, depth, samples })
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
        {
            let colour = self.colour.create_view(&wgpu::TextureViewDescriptor::default());
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("composite"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &colour,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &self.depth,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(1.0),
                        store: wgpu::StoreOp::Discard,
                    }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            self.composite.draw(&mut pass, &self.view);
        }
        queue.submit([encoder.finish()]);
        let samples = readback::texture::<[f32; 4]>(device, queue, &self.colour, 0)?;
        Ok(Picture::from_samples(&samples, self.colour.width(), self.samples, develop))
    }

    /// Width and height of what is drawn.
    pub fn pixels(&self) -> [u32; 2] {
        [self.colour.width(), self.colour.height()]
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

fn attachment(device: &wgpu::Device, format: wgpu::TextureFormat, width: u32, height: u32) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}
