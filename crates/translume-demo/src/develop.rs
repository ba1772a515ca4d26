//! Develops what was drawn for the screen, on the GPU.
//!
//! reads  samples of radiance and coverage       writes  8-bit sRGB
//! twin   [`Picture::from_samples`](crate::picture::Picture::from_samples)      WGSL    `develop.wgsl`

use crate::error::Error;
use crate::gpu::Gpu;
use crate::picture::BACKDROP;
use translume::wgpu;

/// The pipeline, and room for pictures as large as the last.
pub struct Developer {
    pipeline: wgpu::ComputePipeline,
    settings: wgpu::Buffer,
    bytes: Option<wgpu::Buffer>,
}

const SETTINGS_BYTES: u64 = 24;
const GROUP: u32 = 8;

impl Developer {
    pub fn new(device: &wgpu::Device) -> Self {
        let module = device.create_shader_module(wgpu::include_wgsl!("develop.wgsl"));
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("develop"),
            layout: None,
            module: &module,
            entry_point: Some("develop"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let settings = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("develop settings"),
            size: SETTINGS_BYTES,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { pipeline, settings, bytes: None }
    }

    /// RGBA of a picture, row by row from the top, of `side`² samples a pixel. Waits for the GPU.
    pub async fn develop(
        &mut self,
        gpu: &Gpu,
        radiance: &wgpu::Texture,
        side: u32,
        exposure: f32,
    ) -> Result<Vec<u8>, Error> {
        let Gpu { device, queue, .. } = gpu;
        let [width, height] = [radiance.width() / side, radiance.height() / side];
        let bytes = self.room(device, 4 * u64::from(width) * u64::from(height));
        let gain = exposure.exp2();
        let words = [width, height, side, gain.to_bits(), BACKDROP[0].to_bits(), BACKDROP[1].to_bits()];
        let words = words.map(u32::to_le_bytes);
        queue.write_buffer(&self.settings, 0, words.as_flattened());
        let view = radiance.create_view(&wgpu::TextureViewDescriptor::default());
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("develop"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: self.settings.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&view) },
                wgpu::BindGroupEntry { binding: 2, resource: bytes.as_entire_binding() },
            ],
        });
        let mut encoder =
            device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("develop") });
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("develop"),
                timestamp_writes: None,
            });
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(width.div_ceil(GROUP), height.div_ceil(GROUP), 1);
        }
        queue.submit([encoder.finish()]);
        gpu.buffer(&bytes).await
    }

    fn room(&mut self, device: &wgpu::Device, size: u64) -> wgpu::Buffer {
        if let Some(bytes) = self.bytes.as_ref().filter(|bytes| bytes.size() == size) {
            return bytes.clone();
        }
        let bytes = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("picture"),
            size,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        self.bytes = Some(bytes.clone());
        bytes
    }
}
