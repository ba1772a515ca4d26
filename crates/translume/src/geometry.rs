//! The deformed surface as a host draws it.

use crate::layout::AtlasVertexLayout;
use wgpu::{VertexAttribute, VertexBufferLayout, VertexFormat, VertexStepMode};

/// The deformed surface of a body in the order of its atlas, which has a vertex on each side of a seam: for pipelines of the host's own.
///
/// ```no_run
/// # fn example(body: &translume::Body, pass: &mut wgpu::RenderPass<'_>) {
/// // The pipeline was made with `buffers: &translume::Geometry::LAYOUTS.map(Some)`, and its shader looks the exitance up at `uv`.
/// body.geometry().draw(pass);
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Geometry<'a> {
    /// The mesh's vertex that each copies, and its place in the atlas.
    pub vertices: &'a wgpu::Buffer,
    /// Position, mm, and unit normal of each, written by the first stage.
    pub corners: &'a wgpu::Buffer,
    /// Three 32-bit indices a triangle, in the order and winding of the mesh.
    pub indices: &'a wgpu::Buffer,
    /// How many.
    pub index_count: u32,
}

impl Geometry<'_> {
    /// Shader locations: 0 the mesh's vertex (`u32`), 1 the place in the atlas (`vec2f`), 2 the position in mm (`vec3f`), 3 the unit
    /// normal (`vec3f`).
    pub const LAYOUTS: [VertexBufferLayout<'static>; 2] = [
        VertexBufferLayout {
            array_stride: size_of::<AtlasVertexLayout>() as u64,
            step_mode: VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Uint32, 1 => Float32x2],
        },
        VertexBufferLayout {
            array_stride: 32,
            step_mode: VertexStepMode::Vertex,
            attributes: &[
                VertexAttribute { format: VertexFormat::Float32x3, offset: 0, shader_location: 2 },
                VertexAttribute { format: VertexFormat::Float32x3, offset: 16, shader_location: 3 },
            ],
        },
    ];

    /// Binds the buffers to slots 0 and 1 and records one draw with the pipeline that is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_vertex_buffer(1, self.corners.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.index_count, 0, 0..1);
    }
}
