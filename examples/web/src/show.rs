//! What is to be seen, wherever it is drawn.

use std::error::Error;
use std::f32::consts::TAU;
use translume::{
    Body, BodyDescriptor, Camera, Composite, CompositeTarget, CompositeView, Config, Frame, Gloss, Light,
    Lighting, LookAt, Medium, PointLight, Translume, wgpu,
};
use translume_mesh::{Atlas, AtlasOptions, builtin};

/// Pixels along each side of the picture.
pub const SIZE: u32 = 384;
const TRIANGLES: usize = 20_000;
const ATLAS: u32 = 128;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// A device, and a body on it.
pub struct Show {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    translume: Translume,
    body: Body,
    camera: Camera,
}

/// What the body is drawn into.
pub struct Target {
    composite: Composite,
    view: CompositeView,
    depth: wgpu::TextureView,
    gloss: Gloss,
}

/// The lamp behind the body.
#[derive(Clone, Copy, Debug)]
pub struct Lamp {
    /// Of a turn around the body, from behind it.
    pub turn: f32,
    /// Radiant intensity over that of the picture.
    pub gain: f32,
}

impl Default for Lamp {
    fn default() -> Self {
        Self { turn: 0.0, gain: 1.0 }
    }
}

impl Lamp {
    fn light(self) -> Light {
        let (sin, cos) = (TAU * self.turn).sin_cos();
        Light::Point(PointLight {
            position: [-90.0 * sin - 40.0 * cos, 120.0, 40.0 * sin - 90.0 * cos],
            intensity: [6e4 * self.gain; 3],
            ..Default::default()
        })
    }
}

impl Show {
    /// Unwraps the mesh, compiles the pipelines, uploads the body.
    pub async fn new(adapter: &wgpu::Adapter) -> Result<Self, Box<dyn Error>> {
        let (device, queue) = adapter.request_device(&wgpu::DeviceDescriptor::default()).await?;
        let mesh = builtin::creature_with(TRIANGLES);
        let atlas = Atlas::build(&mesh, &AtlasOptions { size: ATLAS, ..Default::default() }, |_| true)?;
        let translume = Translume::new(&device, &Config::default())?;
        let descriptor =
            BodyDescriptor { medium: Medium::JADE, mm_per_unit: 1.0, ..BodyDescriptor::new(&mesh, &atlas) };
        let body = translume.create_body(&device, &descriptor)?;
        let (low, high) = mesh.bounds().ok_or("the built-in mesh is empty")?;
        let middle = std::array::from_fn::<f32, 3, _>(|k| 0.5 * (low[k] + high[k]));
        let distance = 2.2 * mesh.diagonal();
        let camera = Camera::from(LookAt {
            eye: [middle[0] + 0.25 * distance, middle[1] + 0.15 * distance, middle[2] + distance],
            target: middle,
            up: [0.0, 1.0, 0.0],
            horizontal_fov: 0.45,
            aspect: 1.0,
            near: 0.1 * distance,
            far: 10.0 * distance,
        });
        Ok(Self { device, queue, translume, body, camera })
    }

    /// Pipelines that draw the body into attachments of this format.
    pub fn target(&self, format: wgpu::TextureFormat, gloss: Gloss) -> Target {
        let nearer = wgpu::CompareFunction::Less;
        let target = CompositeTarget { format, depth: Some((DEPTH, nearer)), samples: 1 };
        let composite = self.translume.composite(&self.device, target);
        let view = composite.view(&self.device, &self.body);
        Target { composite, view, depth: self.attachment(DEPTH).create_view(&Default::default()), gloss }
    }

    /// One frame.
    pub fn draw(
        &mut self,
        lamp: &Lamp,
        target: &mut Target,
        colour: &wgpu::TextureView,
    ) -> Result<(), Box<dyn Error>> {
        let Self { device, queue, body, camera, .. } = self;
        body.prepare(
            device,
            queue,
            &Frame { lighting: Lighting::Lights(&[lamp.light()]), ..Default::default() },
        )?;
        target.view.prepare(device, queue, body, camera, target.gloss);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        body.encode(&mut encoder);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("composite"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: colour,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &target.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        target.composite.draw(&mut pass, &target.view);
        drop(pass);
        queue.submit([encoder.finish()]);
        Ok(())
    }

    /// The picture in linear radiance and coverage, `Rgba32Float`. It is compared, so the surface reflects nothing: a highlight at the
    /// outline outshines all the rest, and rasterisers do not agree on the outline.
    pub fn picture(&mut self, lamp: &Lamp) -> Result<wgpu::Texture, Box<dyn Error>> {
        let format = wgpu::TextureFormat::Rgba32Float;
        let (mut target, colour) = (self.target(format, Gloss::None), self.attachment(format));
        self.draw(lamp, &mut target, &colour.create_view(&Default::default()))?;
        Ok(colour)
    }

    fn attachment(&self, format: wgpu::TextureFormat) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: wgpu::Extent3d { width: SIZE, height: SIZE, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    }
}
