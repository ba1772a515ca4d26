//! Why a mesh cannot be laid around a sphere or an egg.

use crate::repair::RepairError;

/// Why a mesh cannot be laid around a sphere or an egg. Vertices and triangles are numbered from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SphericalError {
    /// An option is out of range.
    #[error("the egg's {option} is {value}; choose {range}")]
    Option {
        /// `radius`, `slenderness` or `taper`.
        option: &'static str,
        /// What was asked for.
        value: f32,
        /// What is possible.
        range: &'static str,
    },
    /// The mesh is not clean.
    #[error(transparent)]
    NotClean(#[from] RepairError),
    /// Two corners of a triangle are at the same position.
    #[error("{mesh}: triangle {triangle} (from 0) has no area; repair the mesh first")]
    NoArea {
        /// The mesh's name.
        mesh: String,
        /// The triangle.
        triangle: usize,
    },
    /// No closed surface has so few triangles.
    #[error("{mesh}: {triangles} triangles; a closed surface has at least 4, check that the file holds one")]
    TooFew {
        /// The mesh's name.
        mesh: String,
        /// Number of triangles.
        triangles: usize,
    },
    /// More than two triangles share an edge.
    #[error(
        "{mesh}: {triangles} triangles meet at the edge from {from:?} to {to:?}; take away those that lie inside, \
         so that two are left"
    )]
    NonManifoldEdge {
        /// The mesh's name.
        mesh: String,
        /// Number of triangles at the edge.
        triangles: usize,
        /// One end of the edge.
        from: [f32; 3],
        /// The other end.
        to: [f32; 3],
    },
    /// Two triangles face opposite sides.
    #[error(
        "{mesh}: the triangles at the edge from {from:?} to {to:?} face opposite sides; repair the mesh first, so that all face outwards"
    )]
    Orientation {
        /// The mesh's name.
        mesh: String,
        /// One end of the edge.
        from: [f32; 3],
        /// The other end.
        to: [f32; 3],
    },
    /// The mesh is in several pieces.
    #[error("{mesh}: {count} separate pieces; only one can become one sphere, so join them or keep one")]
    Components {
        /// The mesh's name.
        mesh: String,
        /// Number of pieces.
        count: usize,
    },
    /// Holes remain that could not be filled.
    #[error(
        "{mesh}: not closed, {edges} edges have one triangle and cannot be filled; close the surface in a modeller"
    )]
    Open {
        /// The mesh's name.
        mesh: String,
        /// Number of boundary edges.
        edges: usize,
    },
    /// The surface touches itself in one point.
    #[error(
        "{mesh}: the surface touches itself at vertex {vertex} (from 0), {position:?}; separate it there, or close the gap"
    )]
    NonManifoldVertex {
        /// The mesh's name.
        mesh: String,
        /// The vertex.
        vertex: u32,
        /// Where it is.
        position: [f32; 3],
    },
    /// The surface has handles.
    #[error(
        "{mesh}: its genus is {genus}; only a surface without handles can become a sphere, so close its tunnels"
    )]
    Genus {
        /// The mesh's name.
        mesh: String,
        /// Number of handles: 1 for a ring.
        genus: usize,
    },
    /// The triangles face inwards.
    #[error("{mesh}: its triangles face inwards; repair the mesh first, or reverse their winding")]
    InsideOut {
        /// The mesh's name.
        mesh: String,
    },
    /// Triangles are turned over after rounding to f32.
    #[error(
        "{mesh}: {flipped} of {triangles} triangles are too small on the egg for 32-bit coordinates; \
         move the model to the origin, ask for a larger egg, or simplify the model"
    )]
    TooFine {
        /// The mesh's name.
        mesh: String,
        /// Number of triangles that are turned over.
        flipped: usize,
        /// Number of triangles.
        triangles: usize,
    },
    /// The progress callback returned `false`.
    #[error("{mesh}: laying was cancelled")]
    Cancelled {
        /// The mesh's name.
        mesh: String,
    },
}
