//! What closes one hole: triangles between the vertices of its rim, or a fan around a new vertex in its middle.

use std::collections::HashSet;

use glam::{DVec3, Vec3};

use super::cover::{Cover, cover, vector_area};
use super::edges::Edges;
use crate::mesh::Mesh;

/// Cosine between a rim's normal and the patch's below which the rim is an edge and no part of one smooth surface.
const CREASE: f32 = 0.5;

/// A patch over one hole.
pub(super) struct Patch {
    rim: Vec<Corner>,
    cover: Cover,
    /// Unit normal, or zero where the hole has none.
    normal: Vec3,
}

/// A vertex of the rim as the triangle beside it knows it.
struct Corner {
    vertex: u32,
    uv: [f32; 2],
}

impl Patch {
    /// Plans the patch of a hole, given by the half-edges that begin at the vertices of its rim. `None` where nothing closes it.
    /// `diagonals` are the edges that earlier patches have drawn.
    pub fn new(
        mesh: &Mesh,
        edges: &Edges<'_>,
        hole: &[u32],
        min_height: f64,
        diagonals: &mut HashSet<[u32; 2]>,
    ) -> Option<Self> {
        let half_edges = edges.half_edges;
        let edge = |i: usize, j: usize| {
            let [a, b] = [i, j].map(|k| half_edges.from(hole[k]));
            [a.min(b), a.max(b)]
        };
        let free = |i: usize, j: usize| {
            let [a, b] = edge(i, j);
            !edges.contains(a, b) && !diagonals.contains(&[a, b])
        };
        let position =
            |&half: &u32| DVec3::from(mesh.positions[half_edges.vertex(half) as usize].map(f64::from));
        let points: Vec<DVec3> = hole.iter().map(position).collect();
        let cover = cover(&points, free, min_height)?;
        if cover.shares.is_empty() {
            let drawn = cover.triangles.iter().flat_map(|&[i, j, k]| [edge(i, j), edge(j, k), edge(k, i)]);
            diagonals.extend(drawn);
        }
        let corner = |&half: &u32| Corner {
            vertex: half_edges.vertex(half),
            uv: mesh.uvs.get(half as usize / 3).map_or([0.0; 2], |uvs| uvs[half as usize % 3]),
        };
        let normal = vector_area(&points).normalize_or_zero().as_vec3();
        Some(Self { rim: hole.iter().map(corner).collect(), cover, normal })
    }

    /// Appends the patch to the mesh.
    pub fn apply(&self, mesh: &mut Mesh) {
        let mut vertices: Vec<u32> = self.rim.iter().map(|corner| self.join(mesh, corner.vertex)).collect();
        let mut uvs: Vec<[f32; 2]> = self.rim.iter().map(|corner| corner.uv).collect();
        if !self.cover.shares.is_empty() {
            vertices.push(self.centre(mesh));
            uvs.push(self.mean(|corner| corner.uv));
        }
        mesh.triangles.extend(self.cover.triangles.iter().map(|t| t.map(|k| vertices[k])));
        if !mesh.uvs.is_empty() {
            mesh.uvs.extend(self.cover.triangles.iter().map(|t| t.map(|k| uvs[k])));
        }
    }

    /// The vertex itself, or a copy with the patch's normal where they meet at an angle. A missing normal is computed later.
    fn join(&self, mesh: &mut Mesh, vertex: u32) -> u32 {
        let normal =
            mesh.normals.get(vertex as usize).map_or(Vec3::ZERO, |&n| Vec3::from(n).normalize_or_zero());
        if normal == Vec3::ZERO || self.normal == Vec3::ZERO || normal.dot(self.normal) > CREASE {
            return vertex;
        }
        let copy = copy(mesh, vertex);
        mesh.normals[copy as usize] = self.normal.to_array();
        copy
    }

    /// Appends the vertex in the middle.
    fn centre(&self, mesh: &mut Mesh) -> u32 {
        let position = self.mean(|corner| mesh.positions[corner.vertex as usize]);
        let distance = |corner: &&Corner| {
            Vec3::from(mesh.positions[corner.vertex as usize]).distance_squared(position.into())
        };
        let nearest = self.rim.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let centre = copy(mesh, nearest.map_or(0, |corner| corner.vertex));
        mesh.positions[centre as usize] = position;
        if let Some(normal) = mesh.normals.get_mut(centre as usize) {
            *normal = self.normal.to_array();
        }
        for target in &mut mesh.targets {
            target.position_deltas[centre as usize] =
                self.mean(|corner| target.position_deltas[corner.vertex as usize]);
        }
        centre
    }

    /// The mean of a quantity over the rim by the shares in the centre.
    fn mean<const N: usize>(&self, quantity: impl Fn(&Corner) -> [f32; N]) -> [f32; N] {
        let mut sum = [0.0; N];
        for (corner, share) in self.rim.iter().zip(&self.cover.shares) {
            let value = quantity(corner);
            (0..N).for_each(|k| sum[k] += share * f64::from(value[k]));
        }
        sum.map(|x| x as f32)
    }
}

/// Appends a copy of a vertex with everything that it carries.
fn copy(mesh: &mut Mesh, vertex: u32) -> u32 {
    let v = vertex as usize;
    mesh.positions.push(mesh.positions[v]);
    if let Some(&normal) = mesh.normals.get(v) {
        mesh.normals.push(normal);
    }
    mesh.targets.iter_mut().for_each(|target| target.position_deltas.push(target.position_deltas[v]));
    if let Some(skin) = &mut mesh.skin {
        skin.influences.extend_from_within(v * skin.per_vertex..(v + 1) * skin.per_vertex);
    }
    mesh.positions.len() as u32 - 1
}
