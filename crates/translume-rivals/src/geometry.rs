//! The body as both rivals draw it.

use crate::{Error, gpu};
use translume::{Body, wgpu};

/// Vertices in millimetres and triangles, on the GPU. A body that moves writes its vertices anew; nothing else has to be made again.
pub struct Geometry {
    positions: wgpu::Buffer,
    normals: wgpu::Buffer,
    triangles: wgpu::Buffer,
    corners: u32,
}

impl Geometry {
    /// Room for `vertices` vertices, and the triangles between them.
    ///
    /// # Errors
    /// [`Error::Mesh`] names the triangle whose corner is not there.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        vertices: usize,
        triangles: &[[u32; 3]],
    ) -> Result<Self, Error> {
        if let Some(k) = triangles.iter().position(|t| t.iter().any(|&v| v as usize >= vertices)) {
            let problem = format!("has triangle {k} {:?}, but {vertices} vertices", triangles[k]);
            return Err(Error::Mesh { problem, remedy: "repair its indices" });
        }
        let vectors = |label| gpu::buffer(device, label, 16 * vertices as u64, wgpu::BufferUsages::VERTEX);
        let indices: &[u8] = bytemuck::cast_slice(triangles);
        let geometry = Self {
            positions: vectors("rival positions"),
            normals: vectors("rival normals"),
            triangles: gpu::buffer(
                device,
                "rival triangles",
                indices.len() as u64,
                wgpu::BufferUsages::INDEX,
            ),
            corners: 3 * triangles.len() as u32,
        };
        queue.write_buffer(&geometry.triangles, 0, indices);
        Ok(geometry)
    }

    /// The pose of the next frame: positions in mm and unit normals, four floats each.
    ///
    /// # Errors
    /// [`Error::Mesh`] where there are more or fewer than at first.
    pub fn write(
        &self,
        queue: &wgpu::Queue,
        positions: &[[f32; 4]],
        normals: &[[f32; 4]],
    ) -> Result<(), Error> {
        for (content, buffer) in [(positions, &self.positions), (normals, &self.normals)] {
            let bytes: &[u8] = bytemuck::cast_slice(content);
            if bytes.len() as u64 != buffer.size() {
                let problem = format!("has {} vertices now and had {}", content.len(), buffer.size() / 16);
                return Err(Error::Mesh { problem, remedy: "make a new Geometry for another mesh" });
            }
            queue.write_buffer(buffer, 0, bytes);
        }
        Ok(())
    }

    /// The same from what a body's last frame left, on the GPU.
    ///
    /// # Errors
    /// [`Error::Mesh`] where the body has another number of vertices.
    pub fn follow(&self, encoder: &mut wgpu::CommandEncoder, body: &Body) -> Result<(), Error> {
        let outputs = body.outputs();
        for (from, to) in [(outputs.positions, &self.positions), (outputs.normals, &self.normals)] {
            if from.size() != to.size() {
                let problem = format!("has {} vertices, the body {}", to.size() / 16, from.size() / 16);
                return Err(Error::Mesh { problem, remedy: "make the Geometry of the body's own mesh" });
            }
            encoder.copy_buffer_to_buffer(from, 0, to, 0, from.size());
        }
        Ok(())
    }

    /// Draws the triangles; shaders see `instance` as the index of the instance.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, instance: u32) {
        pass.set_vertex_buffer(0, self.positions.slice(..));
        pass.set_vertex_buffer(1, self.normals.slice(..));
        pass.set_index_buffer(self.triangles.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.corners, 0, instance..instance + 1);
    }
}
