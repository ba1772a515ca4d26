//! Why a mesh cannot be made clean.

use super::WELD_DISTANCES;

/// Diagonals within which products of two edges, and their squares, neither vanish nor overflow in f32.
pub(super) const DIAGONALS: std::ops::RangeInclusive<f32> = 1e-6..=1e9;

/// Why a mesh cannot be made clean. Vertices, triangles and targets are numbered from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RepairError {
    /// A triangle names a vertex that does not exist.
    #[error(
        "{mesh}: triangle {triangle} (from 0) uses vertex {vertex}, but there are {count}; \
         re-export the file or repair its indices"
    )]
    Index {
        /// The mesh's name.
        mesh: String,
        /// The triangle, from 0.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// Number of vertices.
        count: usize,
    },
    /// A vertex that a triangle uses is not a point.
    #[error("{mesh}: vertex {vertex} (from 0) is at {position:?}; re-export the file or remove the vertex")]
    Vertex {
        /// The mesh's name.
        mesh: String,
        /// The vertex, from 0.
        vertex: usize,
        /// Where it is said to be.
        position: [f32; 3],
    },
    /// A morph target does not have one delta per vertex.
    #[error(
        "{mesh}: morph target {target} (from 0) has {deltas} deltas, but there are {count} vertices; \
         re-export the morph targets with the mesh"
    )]
    TargetCount {
        /// The mesh's name.
        mesh: String,
        /// The target, from 0.
        target: usize,
        /// Number of its deltas.
        deltas: usize,
        /// Number of vertices.
        count: usize,
    },
    /// A morph target moves a vertex to nowhere.
    #[error(
        "{mesh}: morph target {target} moves vertex {vertex} (both from 0) by {delta:?}; re-export the morph targets"
    )]
    TargetDelta {
        /// The mesh's name.
        mesh: String,
        /// The target, from 0.
        target: usize,
        /// The vertex, from 0.
        vertex: usize,
        /// The displacement.
        delta: [f32; 3],
    },
    /// There are normals, but not one per vertex.
    #[error(
        "{mesh}: {normals} normals for {count} vertices; give one per vertex, or none to have them computed"
    )]
    NormalCount {
        /// The mesh's name.
        mesh: String,
        /// Number of normals.
        normals: usize,
        /// Number of vertices.
        count: usize,
    },
    /// There are texture coordinates, but not for each triangle.
    #[error("{mesh}: texture coordinates for {uvs} of {triangles} triangles; give them for all or none")]
    UvCount {
        /// The mesh's name.
        mesh: String,
        /// Number of triangles with texture coordinates.
        uvs: usize,
        /// Number of triangles.
        triangles: usize,
    },
    /// A texture coordinate is no point.
    #[error(
        "{mesh}: triangle {triangle} (from 0) has the texture coordinate {uv:?}; re-export the file or leave out texture coordinates"
    )]
    Uv {
        /// The mesh's name.
        mesh: String,
        /// The triangle, from 0.
        triangle: usize,
        /// Where it is said to be in the texture.
        uv: [f32; 2],
    },
    /// A skin does not have the same number of influences for each vertex, at least one.
    #[error(
        "{mesh}: its skin has {influences} influences for {count} vertices of {per_vertex}; re-export the skin with the mesh"
    )]
    InfluenceCount {
        /// The mesh's name.
        mesh: String,
        /// Number of influences.
        influences: usize,
        /// Influences of each vertex.
        per_vertex: usize,
        /// Number of vertices.
        count: usize,
    },
    /// A vertex follows a joint that does not exist, or by no number.
    #[error(
        "{mesh}: vertex {vertex} (from 0) follows joint {joint} of {joints} by {weight}; re-export the skin with the mesh"
    )]
    Influence {
        /// The mesh's name.
        mesh: String,
        /// The vertex, from 0.
        vertex: usize,
        /// The joint, from 0.
        joint: u32,
        /// Its share.
        weight: f32,
        /// Number of joints.
        joints: usize,
    },
    /// The distance over which vertices shall be joined is out of range.
    #[error(
        "{mesh}: weld distance {share:e} is neither 0 nor within {:e}..={:e} of the diagonal; choose one that is",
        WELD_DISTANCES.start(),
        WELD_DISTANCES.end()
    )]
    WeldDistance {
        /// The mesh's name.
        mesh: String,
        /// The distance as a share of the diagonal.
        share: f32,
    },
    /// No triangle has an area.
    #[error("{mesh}: none of its {triangles} triangles has an area; check that the file holds a surface")]
    NoArea {
        /// The mesh's name.
        mesh: String,
        /// Number of triangles in it.
        triangles: usize,
    },
    /// The mesh is too small or too large for 32-bit arithmetic.
    #[error(
        "{mesh}: its diagonal is {diagonal:e} units, outside {:e}..={:e}; scale the model",
        DIAGONALS.start(),
        DIAGONALS.end()
    )]
    Scale {
        /// The mesh's name.
        mesh: String,
        /// Length of the bounding box's diagonal, model units.
        diagonal: f32,
    },
}
