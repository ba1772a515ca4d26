//! On which texel each vertex stands.

use crate::variation::{VERTEX_MARK, Variation};
use glam::Vec3;
use translume_mesh::{Atlas, Mesh};

/// The texel under each vertex, and which texels have a vertex.
pub(crate) struct Standing {
    pub texels: Vec<u32>,
    /// Of each texel, without variation of the medium.
    pub marks: Vec<u32>,
    /// The texels in the order of the boundary solver's sites.
    pub order: Vec<u32>,
}

impl Standing {
    pub fn new(mesh: &Mesh, atlas: &Atlas) -> Self {
        let mut texels = vec![Atlas::EMPTY; mesh.positions.len()];
        for vertex in &atlas.vertices {
            let slot = &mut texels[vertex.xref as usize];
            if *slot == Atlas::EMPTY {
                *slot = around(atlas, vertex.uv);
            }
        }
        let mut drawn = vec![false; mesh.positions.len()];
        atlas.vertices.iter().for_each(|vertex| drawn[vertex.xref as usize] = true);
        for (vertex, texel) in texels.iter_mut().enumerate().filter(|(_, texel)| **texel == Atlas::EMPTY) {
            // Nobody sees a vertex of no triangle.
            *texel = if drawn[vertex] { nearest(mesh, atlas, mesh.positions[vertex].into()) } else { 0 };
        }
        let mut marks = vec![Variation::default().mark(); atlas.texels.len()];
        texels.iter().for_each(|texel| marks[*texel as usize] |= VERTEX_MARK);
        Self { texels, marks, order: atlas.block_order(mesh) }
    }

    /// The marks, then where each texel is in the order of sites, then that order.
    pub fn words(&self) -> Vec<u32> {
        let mut places = vec![0; self.order.len()];
        self.order.iter().enumerate().for_each(|(place, texel)| places[*texel as usize] = place as u32);
        [&self.marks[..], &places, &self.order].concat()
    }
}

/// The texel of the pixel at a place in the atlas, or of one beside it.
fn around(atlas: &Atlas, uv: [f32; 2]) -> u32 {
    let size = atlas.size as i32;
    let [x, y] = uv.map(|t| (t * size as f32) as i32);
    let beside = [(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, -1), (-1, 1), (1, 1)];
    let pixels = beside.map(|(right, down)| {
        let [column, row] = [x + right, y + down].map(|k| k.clamp(0, size - 1));
        atlas.pixels[(row * size + column) as usize]
    });
    pixels.into_iter().find(|texel| *texel != Atlas::EMPTY).unwrap_or(Atlas::EMPTY)
}

/// The texel closest to a place at rest: for a vertex of a chart that holds no pixel's centre.
fn nearest(mesh: &Mesh, atlas: &Atlas, place: Vec3) -> u32 {
    let distance = |texel: &translume_mesh::Texel| {
        let [a, b, c] = mesh.corners(texel.triangle as usize).map(Vec3::from);
        (a + texel.barycentric[0] * (b - a) + texel.barycentric[1] * (c - a)).distance_squared(place)
    };
    let distances = atlas.texels.iter().map(distance).enumerate();
    distances.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(texel, _)| texel as u32)
}
