//! What an engine has already, so that the examples can speak of the rest: a device, something to draw into, a file to keep it in.

use std::error::Error;
use std::path::PathBuf;
use translume::{Camera, CompositeTarget, LookAt, readback, wgpu};

/// The engine's device: WebGPU's default limits, no features.
pub struct Host {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
}

impl Host {
    /// On the adapter that `WGPU_ADAPTER_NAME` and `WGPU_BACKEND` choose, or the first there is.
    ///
    /// # Errors
    /// Where there is no adapter, or it gives no device.
    pub fn new() -> Result<Self, Box<dyn Error>> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle().with_env());
        let adapter =
            pollster::block_on(wgpu::util::initialize_adapter_from_env(&instance, None)).or_else(|_| {
                pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
            })?;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))?;
        Ok(Self { device, queue })
    }

    /// An encoder for a frame.
    #[must_use]
    pub fn encoder(&self) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") })
    }

    /// A buffer with this content.
    #[must_use]
    pub fn buffer<T: bytemuck::NoUninit>(&self, content: &[T], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        use wgpu::util::DeviceExt as _;
        let contents = bytemuck::cast_slice(content);
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    }
}

/// The engine's linear picture with depth, of several samples a pixel.
pub struct Picture {
    samples: wgpu::Texture,
    resolved: wgpu::Texture,
    depth: wgpu::Texture,
}

impl Picture {
    /// Linear radiance.
    pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
    /// Nearer is less.
    pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
    /// A pixel.
    pub const SAMPLES: u32 = 4;

    /// What Translume's composite has to know of it.
    pub const TARGET: CompositeTarget = CompositeTarget {
        format: Self::FORMAT,
        depth: Some((Self::DEPTH, wgpu::CompareFunction::Less)),
        samples: Self::SAMPLES,
    };

    /// So many pixels.
    #[must_use]
    pub fn new(host: &Host, [width, height]: [u32; 2]) -> Self {
        let texture = |format, sample_count, usage| {
            host.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("picture"),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            })
        };
        Self {
            samples: texture(Self::FORMAT, Self::SAMPLES, wgpu::TextureUsages::empty()),
            resolved: texture(Self::FORMAT, 1, wgpu::TextureUsages::COPY_SRC),
            depth: texture(Self::DEPTH, Self::SAMPLES, wgpu::TextureUsages::empty()),
        }
    }

    /// A pass over a dark grey.
    #[must_use]
    pub fn pass<'a>(&self, encoder: &'a mut wgpu::CommandEncoder) -> wgpu::RenderPass<'a> {
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view(&self.samples),
                depth_slice: None,
                resolve_target: Some(&view(&self.resolved)),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r: 0.02, g: 0.02, b: 0.025, a: 1.0 }),
                    store: wgpu::StoreOp::Discard,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view(&self.depth),
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        })
    }

    /// Radiance of every pixel, row by row from the top.
    ///
    /// # Errors
    /// Where the device is lost.
    pub fn radiance(&self, host: &Host) -> Result<Vec<[f32; 3]>, Box<dyn Error>> {
        let texels = readback::texture::<[u16; 4]>(&host.device, &host.queue, &self.resolved, 0)?;
        Ok(texels
            .iter()
            .map(|&[r, g, b, _]| [r, g, b].map(|bits| half::f16::from_bits(bits).to_f32()))
            .collect())
    }

    /// Writes `out/NAME.png` under a plain tone curve, √L, and says so.
    ///
    /// # Errors
    /// Where the device is lost or the file cannot be written.
    pub fn save(&self, host: &Host, name: &str) -> Result<PathBuf, Box<dyn Error>> {
        let radiance = self.radiance(host)?;
        let bytes: Vec<u8> = radiance
            .as_flattened()
            .iter()
            .map(|x| (255.0 * x.clamp(0.0, 1.0).sqrt()).round() as u8)
            .collect();
        let path = PathBuf::from("out").join(name).with_extension("png");
        std::fs::create_dir_all("out")?;
        let [width, height] = [self.resolved.width(), self.resolved.height()];
        image::save_buffer(&path, &bytes, width, height, image::ColorType::Rgb8)?;
        Ok(path)
    }

    /// Width over height.
    #[must_use]
    pub fn aspect(&self) -> f32 {
        self.resolved.width() as f32 / self.resolved.height() as f32
    }
}

/// A compute shader of the engine and what it reads and writes.
pub struct Compute {
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
}

impl Compute {
    /// Of the entry point of this name; `buffers` are bindings 0, 1, 2 … of group 0.
    #[must_use]
    pub fn new(host: &Host, source: &str, entry_point: &str, buffers: &[&wgpu::Buffer]) -> Self {
        let Host { device, .. } = host;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(entry_point),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry_point),
            layout: None,
            module: &module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(entry_point),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        Self { pipeline, group }
    }

    /// In workgroups of 64.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, items: u32) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.dispatch_workgroups(items.div_ceil(64), 1, 1);
    }
}

/// A camera at `eye` that looks at `target`, 40 degrees wide.
#[must_use]
pub fn camera(eye: [f32; 3], target: [f32; 3], aspect: f32) -> Camera {
    let distance = (0..3).map(|k| (eye[k] - target[k]).powi(2)).sum::<f32>().sqrt();
    let (near, far) = (0.02 * distance, 20.0 * distance);
    Camera::from(LookAt { eye, target, up: [0.0, 1.0, 0.0], horizontal_fov: 0.7, aspect, near, far })
}

/// Root mean square of the difference over that of `b`.
#[must_use]
pub fn relative_rmse(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    let square = |x: f32| f64::from(x) * f64::from(x);
    let (difference, whole) = pairs.fold((0.0, 0.0), |(d, w), (a, b)| (d + square(a - b), w + square(*b)));
    (difference / whole).sqrt()
}
