//! Vertex normals: at rest, and again on every deformed pose.
//!
//! A vertex normal is the sum of the cross products of the triangles around it, which weighs each by its area
//! (Gouraud 1971; area weights as in Thürmer and Wüthrich 1998, "Computing Vertex Normals from Polygonal Facets").

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use crate::mesh::Mesh;
use crate::weld::weld;

/// Cosine above which two normals at one position are the same normal: about 1.15°, wide enough for normals that
/// were stored in 8 bits and far below any crease.
const SAME_NORMAL: f32 = 0.9998;

/// The normal of a vertex around which all area cancels.
const FALLBACK: [f32; 3] = [0.0, 1.0, 0.0];

/// Unit vertex normals, area-weighted. Vertices at the same position, bit for bit, share one normal, so that a
/// surface split for texture coordinates stays smooth.
///
/// Where the areas around a position cancel (a sheet with two sides) each vertex takes the normal of its own
/// triangles, and where those cancel too, or there are none, it takes `[0, 1, 0]`: the result is always finite.
///
/// Every triangle must index `positions`, and every indexed position be finite.
#[must_use]
pub fn smooth_normals(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let welded = weld(positions);
    let mut own = vec![DVec3::ZERO; positions.len()];
    let mut shared = vec![DVec3::ZERO; positions.len()];
    let mut weight = vec![0.0; positions.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| DVec3::from(positions[v as usize].map(f64::from)));
        let cross = (b - a).cross(c - a);
        for &v in triangle {
            own[v as usize] += cross;
            let position = welded[v as usize] as usize;
            shared[position] += cross;
            weight[position] += cross.length();
        }
    }
    // What is left of cancelling areas in f64 is below 1e-12 of them; 1e-6 is far above that and below any real fold.
    let distinct = |sum: DVec3, position: usize| (sum.length() > 1e-6 * weight[position]).then_some(sum);
    (0..positions.len())
        .map(|v| {
            let position = welded[v] as usize;
            distinct(shared[position], position)
                .or_else(|| distinct(own[v], position))
                .map_or(FALLBACK, |sum| sum.normalize().as_vec3().to_array())
        })
        .collect()
}

/// Which triangles make up the normal of each vertex, in compressed rows.
///
/// The normal of vertex `v` on any pose is the normalised sum of the cross products of
/// `triangles[offsets[v]..offsets[v + 1]]`, see [`deformed_normals`]. Those are the triangles that touch a vertex at
/// the same rest position whose rest normal lies within about 1° of that of `v`: copies made for texture
/// coordinates act as one vertex, and hard edges stay hard.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NormalAdjacency {
    /// Where each vertex's row begins in [`triangles`](Self::triangles); one more entry than there are vertices.
    pub offsets: Vec<u32>,
    /// Triangle indices, ascending within a row.
    pub triangles: Vec<u32>,
}

impl NormalAdjacency {
    /// Collects the rows of a clean mesh. Deterministic.
    #[must_use]
    pub fn build(mesh: &Mesh) -> Self {
        let touching = triangles_of_vertices(mesh);
        let mut copies: HashMap<u32, Vec<u32>> = HashMap::new();
        let welded = weld(&mesh.positions);
        for (v, &position) in (0_u32..).zip(&welded) {
            copies.entry(position).or_default().push(v);
        }
        let mut adjacency =
            Self { offsets: vec![0], triangles: Vec::with_capacity(mesh.triangles.len() * 3) };
        let mut row = Vec::new();
        for (v, position) in welded.iter().enumerate() {
            let normal = Vec3::from(mesh.normals[v]);
            row.clear();
            for &w in &copies[position] {
                let same = w as usize == v || normal.dot(Vec3::from(mesh.normals[w as usize])) > SAME_NORMAL;
                if same {
                    row.extend_from_slice(touching.row(w as usize));
                }
            }
            row.sort_unstable();
            row.dedup();
            adjacency.triangles.extend_from_slice(&row);
            adjacency.offsets.push(adjacency.triangles.len() as u32);
        }
        adjacency
    }

    /// The triangles that make up the normal of one vertex.
    #[must_use]
    pub fn row(&self, vertex: usize) -> &[u32] {
        &self.triangles[self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize]
    }
}

fn triangles_of_vertices(mesh: &Mesh) -> NormalAdjacency {
    let mut offsets = vec![0_u32; mesh.positions.len() + 1];
    for &v in mesh.triangles.iter().flatten() {
        offsets[v as usize + 1] += 1;
    }
    for v in 1..offsets.len() {
        offsets[v] += offsets[v - 1];
    }
    let mut next = offsets.clone();
    let mut triangles = vec![0; mesh.triangles.len() * 3];
    for (t, triangle) in (0_u32..).zip(&mesh.triangles) {
        for &v in triangle {
            triangles[next[v as usize] as usize] = t;
            next[v as usize] += 1;
        }
    }
    NormalAdjacency { offsets, triangles }
}

/// Unit vertex normals of a deformed pose, in f32 and in the order of the rows, as a GPU sums them.
///
/// A vertex whose cross products cancel, vanish or overflow gets `[0, 1, 0]`: the result is finite for any finite pose.
#[must_use]
pub fn deformed_normals(
    adjacency: &NormalAdjacency,
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
) -> Vec<[f32; 3]> {
    (0..positions.len())
        .map(|v| {
            let sum = adjacency.row(v).iter().fold(Vec3::ZERO, |sum, &t| {
                let [a, b, c] = triangles[t as usize].map(|v| Vec3::from(positions[v as usize]));
                sum + (b - a).cross(c - a)
            });
            sum.try_normalize().map_or(FALLBACK, |n| n.to_array())
        })
        .collect()
}
