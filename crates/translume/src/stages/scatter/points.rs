//! Points: exitance where no texel is, at vertices and fragments, from the expansions and lists that the dual scatter left.
//!
//! reads  bounds, lamps, expansions, heads, lists, kernel table      writes  exitance per vertex, linear RGB
//! judge  `Method::AllPairs` on the same adapter                     WGSL    `vertices.wgsl`, `shared/point.wgsl`

use crate::buffers::Buffers;
use crate::evaluate::Evaluate;
use crate::gpu::{self, FLOAT_TEXTURE, MediumKind, Pass, PerMedium, READ, UNIFORM, WRITE};
use crate::layout::DualLayout;
use wgpu::ShaderStages;

pub(crate) struct Points {
    /// What the dual scatter left, for the stage and for [`Composite`](crate::Composite).
    pub field: wgpu::BindGroupLayout,
    /// Exitance of the vertices, for [`Composite`](crate::Composite).
    pub seen: wgpu::BindGroupLayout,
    vertices_layout: wgpu::BindGroupLayout,
    pub vertices: PerMedium,
}

/// What a body whose exitance is evaluated at points remembers.
pub(crate) enum PointMemory {
    Vertices { exitance: wgpu::Buffer, field: wgpu::BindGroup, own: wgpu::BindGroup, seen: wgpu::BindGroup },
    Fragments { field: wgpu::BindGroup },
}

/// What the dual scatter left.
pub(crate) struct Field<'a> {
    pub uniforms: &'a wgpu::Buffer,
    pub expansions: &'a wgpu::Buffer,
    pub heads: &'a wgpu::Buffer,
    pub lists: &'a wgpu::Buffer,
    pub kernel_table: &'a wgpu::TextureView,
}

impl Points {
    pub fn new(device: &wgpu::Device) -> Self {
        let types = [UNIFORM, READ, READ, READ, READ, READ, READ, FLOAT_TEXTURE];
        let stages = ShaderStages::COMPUTE | ShaderStages::FRAGMENT;
        let field = gpu::layout(device, "field", stages, &types);
        let vertices_layout = gpu::layout(device, "vertices", ShaderStages::COMPUTE, &[READ, WRITE]);
        let layout = gpu::pipeline_layout(device, "vertices", &[&vertices_layout, &field]);
        Self {
            vertices: PerMedium::new(device, &layout, [translume_shaders::VERTICES; 2], "vertices"),
            seen: gpu::layout(device, "exitance of vertices", ShaderStages::VERTEX, &[READ]),
            field,
            vertices_layout,
        }
    }

    /// `None` where texels do.
    pub fn memory(
        &self,
        device: &wgpu::Device,
        buffers: &Buffers,
        field: &Field<'_>,
        evaluate: Evaluate,
    ) -> Option<PointMemory> {
        match evaluate {
            Evaluate::PerVertex => {
                let exitance = gpu::buffer(device, "exitance of vertices", buffers.positions.size());
                let own = [buffers.positions.as_entire_binding(), exitance.as_entire_binding()];
                Some(PointMemory::Vertices {
                    field: self.bind(device, buffers, field, &buffers.vertex_texels),
                    own: gpu::bind(device, "vertices", &self.vertices_layout, &own),
                    seen: gpu::bind(device, "vertices", &self.seen, &[exitance.as_entire_binding()]),
                    exitance,
                })
            }
            Evaluate::PerFragment => {
                Some(PointMemory::Fragments { field: self.bind(device, buffers, field, &buffers.pixels) })
            }
            Evaluate::PerTexel | Evaluate::Auto => None,
        }
    }

    fn bind(
        &self,
        device: &wgpu::Device,
        buffers: &Buffers,
        field: &Field<'_>,
        standing: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        let resources = [
            gpu::uniform_slot::<DualLayout>(field.uniforms),
            buffers.bounds.as_entire_binding(),
            buffers.lamps.as_entire_binding(),
            field.expansions.as_entire_binding(),
            field.heads.as_entire_binding(),
            field.lists.as_entire_binding(),
            standing.as_entire_binding(),
            wgpu::BindingResource::TextureView(field.kernel_table),
        ];
        gpu::bind(device, "field", &self.field, &resources)
    }

    pub fn encode(&self, pass: &mut Pass<'_>, memory: &PointMemory, vertices: u32, kind: MediumKind) {
        if let PointMemory::Vertices { field, own, .. } = memory {
            pass.set_pipeline(self.vertices.get(kind));
            pass.set_bind_group(own, &[]);
            pass.set_second_group(field);
            pass.dispatch(vertices);
        }
    }
}

impl PointMemory {
    /// Group 1 of the picture.
    pub fn drawn(&self) -> &wgpu::BindGroup {
        match self {
            Self::Vertices { seen, .. } => seen,
            Self::Fragments { field } => field,
        }
    }

    pub fn vertex_exitance(&self) -> Option<&wgpu::Buffer> {
        match self {
            Self::Vertices { exitance, .. } => Some(exitance),
            Self::Fragments { .. } => None,
        }
    }
}
