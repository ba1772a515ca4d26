//! Small pictures of bodies.

use crate::{Fixture, gpu};
use translume::{Camera, CompositeTarget, LookAt, readback, wgpu};

/// Where a square picture is taken from, world units.
#[derive(Clone, Copy, Debug)]
pub struct Shot {
    /// The eye.
    pub eye: [f32; 3],
    /// What is in the middle.
    pub target: [f32; 3],
    /// Full angle of view, radians.
    pub fov: f32,
    /// Width and height in pixels.
    pub size: u32,
}

impl Shot {
    const UP: [f32; 3] = [0.0, 1.0, 0.0];

    /// The camera.
    #[must_use]
    pub fn camera(&self) -> Camera {
        let distance = (0..3).map(|k| (self.eye[k] - self.target[k]).powi(2)).sum::<f32>().sqrt();
        Camera::from(LookAt {
            eye: self.eye,
            target: self.target,
            up: Self::UP,
            horizontal_fov: self.fov,
            aspect: 1.0,
            near: 0.1 * distance,
            far: 10.0 * distance,
        })
    }

    /// The twin's camera, mm.
    #[must_use]
    pub fn twin(&self, mm_per_unit: f64) -> translume_reference::composite::Camera {
        let mm = |p: [f32; 3]| p.map(|x| f64::from(x) * mm_per_unit);
        translume_reference::composite::Camera {
            eye: mm(self.eye),
            target: mm(self.target),
            up: Self::UP.map(f64::from),
            fov: self.fov.into(),
            width: self.size as usize,
            height: self.size as usize,
        }
    }

    /// Radiance of every pixel, row by row from the top, alpha 1 where the body is.
    ///
    /// # Panics
    /// If the picture cannot be read back.
    #[must_use]
    pub fn take(&self, fixture: &Fixture) -> Vec<[f32; 4]> {
        let device = &gpu().device;
        let colour_format = wgpu::TextureFormat::Rgba32Float;
        let depth_format = wgpu::TextureFormat::Depth32Float;
        let target = CompositeTarget {
            format: colour_format,
            depth: Some((depth_format, wgpu::CompareFunction::Less)),
            samples: 1,
        };
        let composite = gpu().translume.composite(device, target);
        let mut view = composite.view(device, &fixture.body);
        view.prepare(device, &gpu().queue, &fixture.body, &self.camera(), translume::Gloss::default());
        let colour = self.attachment(colour_format);
        let depth = self.attachment(depth_format);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let colour = colour.create_view(&wgpu::TextureViewDescriptor::default());
            let depth = depth.create_view(&wgpu::TextureViewDescriptor::default());
            let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("picture"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &colour,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load: clear, store: wgpu::StoreOp::Store },
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &depth,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(1.0),
                        store: wgpu::StoreOp::Discard,
                    }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            composite.draw(&mut pass, &view);
        }
        gpu().queue.submit([encoder.finish()]);
        readback::texture(device, &gpu().queue, &colour, 0)
            .unwrap_or_else(|error| panic!("[{}] {error}", gpu().adapter_name))
    }

    fn attachment(&self, format: wgpu::TextureFormat) -> wgpu::Texture {
        gpu().device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: wgpu::Extent3d { width: self.size, height: self.size, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    }
}

/// How far two square 8-bit RGB pictures are apart, in steps of 1/255: the mean absolute difference, and the largest difference
/// between means of blocks of 8 × 8 pixels.
#[must_use]
pub fn difference(a: &[u8], b: &[u8], size: usize) -> (f64, f64) {
    let total: f64 = a.iter().zip(b).map(|(x, y)| f64::from(x.abs_diff(*y))).sum();
    let block_mean = |picture: &[u8], column: usize, row: usize, channel: usize| {
        let pixels = (0..64).map(|k| (row * 8 + k / 8) * size + column * 8 + k % 8);
        pixels.map(|pixel| f64::from(picture[pixel * 3 + channel])).sum::<f64>() / 64.0
    };
    let blocks = size / 8;
    let apart = |k: usize| {
        let (channel, column, row) = (k % 3, k / 3 % blocks, k / 3 / blocks);
        (block_mean(a, column, row, channel) - block_mean(b, column, row, channel)).abs()
    };
    (total / a.len() as f64, (0..blocks * blocks * 3).map(apart).fold(0.0, f64::max))
}
