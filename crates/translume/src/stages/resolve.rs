//! Resolve: the dense texels → the square texture that materials sample, gutters filled.
//!
//! reads  exitance per texel, which texel fills which pixel      writes  the exitance texture
//! twin   a look-up per pixel, in the tests                      WGSL    `resolve.wgsl`

use crate::gpu::{self, Pass, READ};

pub(crate) struct Resolve {
    layout: wgpu::BindGroupLayout,
    resolve: wgpu::ComputePipeline,
}

impl Resolve {
    pub fn new(device: &wgpu::Device) -> Self {
        let texture = wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            // Full floats: exitance keeps the host's unit, and sunlight in lux overflows half floats.
            format: wgpu::TextureFormat::Rgba32Float,
            view_dimension: wgpu::TextureViewDimension::D2,
        };
        let layout = gpu::layout(device, "resolve", wgpu::ShaderStages::COMPUTE, &[READ, READ, texture]);
        let module = gpu::module(device, translume_shaders::RESOLVE);
        Self { resolve: gpu::compute_pipeline(device, &layout, &module, "resolve"), layout }
    }

    /// The texture that is written: `size`² texels.
    pub fn texture(&self, device: &wgpu::Device, size: u32) -> wgpu::Texture {
        let usage = wgpu::TextureUsages::STORAGE_BINDING
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC;
        gpu::float_texture(device, "exitance", (size, size), usage)
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

    pub fn encode(&self, pass: &mut Pass<'_>, group: &wgpu::BindGroup, size: u32) {
        pass.set_pipeline(&self.resolve);
        pass.set_bind_group(group, &[]);
        pass.dispatch_workgroups(size.div_ceil(8), size.div_ceil(8));
    }
}
