//! What pictures are drawn into: a texture of radiance and coverage, and depth.

use std::sync::Arc;
use translume::{Composite, CompositeTarget, CompositeView, Translume, wgpu};

/// Off screen, linear, full float.
pub struct Canvas {
    pub composite: Arc<Composite>,
    pub colour: wgpu::Texture,
    depth: wgpu::TextureView,
}

impl Canvas {
    pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
    pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

    /// The pipelines of every canvas of a device.
    pub fn composite(device: &wgpu::Device, translume: &Translume) -> Arc<Composite> {
        let target = CompositeTarget {
            format: Self::FORMAT,
            depth: Some((Self::DEPTH, wgpu::CompareFunction::Less)),
            samples: 1,
        };
        Arc::new(translume.composite(device, target))
    }

    pub fn new(device: &wgpu::Device, composite: &Arc<Composite>, [width, height]: [u32; 2]) -> Self {
        let [colour, depth] = attachments(device, [width, height]);
        Self {
            composite: Arc::clone(composite),
            colour,
            depth: depth.create_view(&wgpu::TextureViewDescriptor::default()),
        }
    }

    /// Forgets what was drawn if the size changes.
    pub fn resize(&mut self, device: &wgpu::Device, size: [u32; 2]) {
        if [self.colour.width(), self.colour.height()] != size {
            let [colour, depth] = attachments(device, size);
            (self.colour, self.depth) = (colour, depth.create_view(&wgpu::TextureViewDescriptor::default()));
        }
    }

    /// Draws a body over nothing.
    pub fn draw(&self, encoder: &mut wgpu::CommandEncoder, view: &CompositeView) {
        self.pass(encoder, |pass| self.composite.draw(pass, view));
    }

    /// Draws over nothing.
    pub fn pass(&self, encoder: &mut wgpu::CommandEncoder, draw: impl FnOnce(&mut wgpu::RenderPass<'_>)) {
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
        draw(&mut pass);
    }
}

/// Colour and depth.
fn attachments(device: &wgpu::Device, [width, height]: [u32; 2]) -> [wgpu::Texture; 2] {
    [Canvas::FORMAT, Canvas::DEPTH].map(|format| {
        device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        })
    })
}
