//! Gather: every light → position, normal, live area and irradiance of every texel.
//!
//! reads  texels, triangles, positions, normals, lights, depth maps      writes  texel positions, normals, irradiance
//! twin   `translume_reference::gather`                                  WGSL    `gather.wgsl`

use crate::body::Buffers;
use crate::gpu::{self, READ, UNIFORM, WRITE};

pub(crate) struct Gather {
    layout: wgpu::BindGroupLayout,
    irradiance: wgpu::ComputePipeline,
    sampler: wgpu::Sampler,
}

impl Gather {
    pub fn new(device: &wgpu::Device) -> Self {
        let depth_maps = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Depth,
            view_dimension: wgpu::TextureViewDimension::D2Array,
            multisampled: false,
        };
        let comparison = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison);
        let types = [UNIFORM, READ, READ, READ, READ, WRITE, WRITE, WRITE, depth_maps, comparison];
        let layout = gpu::layout(device, "gather", wgpu::ShaderStages::COMPUTE, &types);
        let module = gpu::module(device, translume_shaders::GATHER);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("depth map"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        Self { irradiance: gpu::compute_pipeline(device, &layout, &module, "irradiance"), layout, sampler }
    }

    pub fn bind(&self, device: &wgpu::Device, buffers: &Buffers, depth_maps: &wgpu::TextureView) -> wgpu::BindGroup {
        let resources = [
            buffers.gather_uniform.as_entire_binding(),
            buffers.texels.as_entire_binding(),
            buffers.triangles.as_entire_binding(),
            buffers.positions.as_entire_binding(),
            buffers.normals.as_entire_binding(),
            buffers.texel_positions.as_entire_binding(),
            buffers.texel_normals.as_entire_binding(),
            buffers.irradiance.as_entire_binding(),
            wgpu::BindingResource::TextureView(depth_maps),
            wgpu::BindingResource::Sampler(&self.sampler),
        ];
        gpu::bind(device, "gather", &self.layout, &resources)
    }

    pub fn encode(&self, pass: &mut wgpu::ComputePass<'_>, group: &wgpu::BindGroup, texels: u32) {
        pass.set_pipeline(&self.irradiance);
        pass.set_bind_group(0, group, &[]);
        gpu::dispatch(pass, texels);
    }
}
