//! Deform: rest pose and morph targets → positions in mm and unit normals, per mesh vertex.
//!
//! reads  rest pose, deltas, weights, triangle adjacency      writes  positions, normals
//! twin   `translume_reference::deform`                       WGSL    `deform.wgsl`

use crate::buffers::Buffers;
use crate::gpu::{self, READ, UNIFORM, WRITE};

pub(crate) struct Deform {
    layout: wgpu::BindGroupLayout,
    morph: wgpu::ComputePipeline,
    recompute_normals: wgpu::ComputePipeline,
}

impl Deform {
    pub fn new(device: &wgpu::Device) -> Self {
        let types = [UNIFORM, READ, READ, READ, READ, READ, WRITE, WRITE];
        let layout = gpu::layout(device, "deform", wgpu::ShaderStages::COMPUTE, &types);
        let module = gpu::module(device, translume_shaders::DEFORM);
        Self {
            morph: gpu::compute_pipeline(device, &layout, &module, "morph"),
            recompute_normals: gpu::compute_pipeline(device, &layout, &module, "recompute_normals"),
            layout,
        }
    }

    pub fn bind(&self, device: &wgpu::Device, buffers: &Buffers) -> wgpu::BindGroup {
        let resources = [
            &buffers.deform_uniform,
            &buffers.rest,
            &buffers.deltas,
            &buffers.weights,
            &buffers.triangles,
            &buffers.adjacency,
            &buffers.positions,
            &buffers.normals,
        ];
        gpu::bind(device, "deform", &self.layout, &resources.map(wgpu::Buffer::as_entire_binding))
    }

    /// A body that deforms gets its normals from the deformed triangles; a rigid one keeps those of its file.
    pub fn encode(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        group: &wgpu::BindGroup,
        vertices: u32,
        deforms: bool,
    ) {
        pass.set_bind_group(0, group, &[]);
        pass.set_pipeline(&self.morph);
        gpu::dispatch(pass, vertices);
        if deforms {
            pass.set_pipeline(&self.recompute_normals);
            gpu::dispatch(pass, vertices);
        }
    }
}
