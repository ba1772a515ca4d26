//! Resolve: the dense texels → the square texture that materials sample, gutters filled.
//!
//! reads  exitance per texel, which texel fills which pixel      writes  the exitance texture
//! twin   a look-up per pixel, in the tests                      WGSL    `resolve.wgsl`

use crate::gpu::{self, READ};

pub(crate) struct Resolve {
    layout: wgpu::BindGroupLayout,
    resolve: wgpu::ComputePipeline,
}

impl Resolve {
    /// Full floats: exitance keeps the host's unit, and sunlight in lux overflows half floats.
    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

    pub fn new(device: &wgpu::Device) -> Self {
        let texture = wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: Self::FORMAT,
            view_dimension: wgpu::TextureViewDimension::D2,
        };
        let layout = gpu::layout(device, "resolve", wgpu::ShaderStages::COMPUTE, &[READ, READ, texture]);
        let module = gpu::module(device, translume_shaders::RESOLVE);
        Self { resolve: gpu::compute_pipeline(device, &layout, &module, "resolve"), layout }
    }

    /// The texture that is written: `size`² texels.
    pub fn texture(&self, device: &wgpu::Device, size: u32) -> wgpu::Texture {
        device.create_texture(&wgpu::TextureDescriptor {
            label: Some("exitance"),
            size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: Self::FORMAT,
            usage: wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    }

    pub fn bind(
        &self,
        device: &wgpu::Device,
        values: &wgpu::Buffer,
        pixels: &wgpu::Buffer,
        texture: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        let resources = [
            values.as_entire_binding(),
            pixels.as_entire_binding(),
            wgpu::BindingResource::TextureView(texture),
        ];
        gpu::bind(device, "resolve", &self.layout, &resources)
    }

    pub fn encode(&self, pass: &mut wgpu::ComputePass<'_>, group: &wgpu::BindGroup, size: u32) {
        pass.set_pipeline(&self.resolve);
        pass.set_bind_group(0, group, &[]);
        pass.dispatch_workgroups(size.div_ceil(8), size.div_ceil(8), 1);
    }
}
