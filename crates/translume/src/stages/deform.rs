//! Deform: rest pose, morph targets, joints and warp, or vertices of the host → positions in mm and unit normals, per mesh vertex and per vertex of the atlas.
//!
//! reads  rest pose, deltas, weights, influences, joints, triangle adjacency      writes  positions, normals, corners
//! twin   `translume_reference::deform`                                           WGSL    `deform.wgsl`, `adopt.wgsl`, `normals.wgsl`, `corners.wgsl`

use crate::buffers::Buffers;
use crate::gpu::{self, Pass, READ, UNIFORM, WRITE};

pub(crate) struct Deform {
    pose_layout: wgpu::BindGroupLayout,
    adopt_layout: wgpu::BindGroupLayout,
    normals_layout: wgpu::BindGroupLayout,
    corners_layout: wgpu::BindGroupLayout,
    rigid: wgpu::ComputePipeline,
    skinned: wgpu::ComputePipeline,
    adopt: wgpu::ComputePipeline,
    recompute_normals: wgpu::ComputePipeline,
    unfold: wgpu::ComputePipeline,
}

/// What the three passes read and write for one body.
pub(crate) struct DeformGroups {
    pose: wgpu::BindGroup,
    normals: wgpu::BindGroup,
    corners: wgpu::BindGroup,
}

/// Where the vertices of a frame come from.
pub(crate) enum Source<'a> {
    Rest,
    Skin,
    Host(&'a wgpu::BindGroup),
}

impl Deform {
    pub fn new(device: &wgpu::Device) -> Self {
        let layout = |label, types: &[_]| gpu::layout(device, label, wgpu::ShaderStages::COMPUTE, types);
        let pose_layout = layout("deform", &[UNIFORM, READ, READ, READ, READ, READ, WRITE, WRITE]);
        let adopt_layout = layout("adopt", &[UNIFORM, UNIFORM, READ, READ, READ, READ, WRITE, WRITE]);
        let normals_layout = layout("normals", &[UNIFORM, READ, READ, READ, WRITE]);
        let corners_layout = layout("corners", &[READ, READ, READ, WRITE]);
        let corners = gpu::module(device, translume_shaders::CORNERS);
        let pose = gpu::module(device, translume_shaders::DEFORM);
        let adopt = gpu::module(device, translume_shaders::ADOPT);
        let normals = gpu::module(device, translume_shaders::NORMALS);
        let specialised =
            |skinned| gpu::specialised_pipeline(device, &pose_layout, &pose, "pose", &[("SKINNED", skinned)]);
        Self {
            rigid: specialised(0.0),
            skinned: specialised(1.0),
            adopt: gpu::compute_pipeline(device, &adopt_layout, &adopt, "adopt_vertices"),
            recompute_normals: gpu::compute_pipeline(device, &normals_layout, &normals, "recompute_normals"),
            unfold: gpu::compute_pipeline(device, &corners_layout, &corners, "unfold"),
            pose_layout,
            adopt_layout,
            normals_layout,
            corners_layout,
        }
    }

    pub fn bind(&self, device: &wgpu::Device, buffers: &Buffers) -> DeformGroups {
        let bind = |label, layout, buffers: &[&wgpu::Buffer]| {
            let resources: Vec<_> = buffers.iter().map(|buffer| buffer.as_entire_binding()).collect();
            gpu::bind(device, label, layout, &resources)
        };
        let Buffers { deform_uniform, positions, normals, triangles, adjacency, .. } = buffers;
        let Buffers { rest, deltas, weights, influences, joints, atlas_vertices, corners, .. } = buffers;
        let pose = [deform_uniform, rest, deltas, weights, influences, joints, positions, normals];
        DeformGroups {
            pose: bind("deform", &self.pose_layout, &pose),
            normals: bind(
                "normals",
                &self.normals_layout,
                &[deform_uniform, triangles, adjacency, positions, normals],
            ),
            corners: bind("corners", &self.corners_layout, &[atlas_vertices, positions, normals, corners]),
        }
    }

    /// What the first pass reads where the host deforms: a uniform with places, the `host`'s positions and normals, and its numbers.
    pub fn bind_host(
        &self,
        device: &wgpu::Device,
        buffers: &Buffers,
        uniform: &wgpu::Buffer,
        [host_positions, host_normals]: [wgpu::BindingResource<'_>; 2],
        numbers: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        let Buffers { deform_uniform, rest, positions, normals, .. } = buffers;
        let resources = [
            deform_uniform.as_entire_binding(),
            uniform.as_entire_binding(),
            host_positions,
            host_normals,
            numbers.as_entire_binding(),
            rest.as_entire_binding(),
            positions.as_entire_binding(),
            normals.as_entire_binding(),
        ];
        gpu::bind(device, "adopt", &self.adopt_layout, &resources)
    }

    /// A body that deforms gets its normals from the deformed triangles; a rigid one keeps those of its file.
    pub fn encode(
        &self,
        pass: &mut Pass<'_>,
        groups: &DeformGroups,
        (vertices, corners): (u32, u32),
        source: &Source<'_>,
        deforms: bool,
    ) {
        let (pipeline, group) = match source {
            Source::Rest => (&self.rigid, &groups.pose),
            Source::Skin => (&self.skinned, &groups.pose),
            Source::Host(group) => (&self.adopt, *group),
        };
        pass.set_pipeline(pipeline);
        pass.set_bind_group(group, &[]);
        pass.dispatch(vertices);
        if deforms {
            pass.set_pipeline(&self.recompute_normals);
            pass.set_bind_group(&groups.normals, &[]);
            pass.dispatch(vertices);
        }
        pass.set_pipeline(&self.unfold);
        pass.set_bind_group(&groups.corners, &[]);
        pass.dispatch(corners);
    }
}
