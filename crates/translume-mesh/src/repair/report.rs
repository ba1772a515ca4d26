//! What was repaired.

use std::fmt;

/// What [`repair_with`](super::repair_with) changed, and what it saw and left alone.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RepairReport {
    /// Edges turned so that a triangle without an area got one.
    pub turned_edges: usize,
    /// Triangles without an area, dropped.
    pub dropped_degenerate: usize,
    /// Repeated triangles (same three positions, same side), dropped.
    pub dropped_duplicate: usize,
    /// Vertices that no remaining triangle uses, dropped.
    pub dropped_vertices: usize,
    /// Vertices joined with one that carries the same.
    pub welded_vertices: usize,
    /// Triangles turned over to face the side of their neighbours, or outwards.
    pub flipped_triangles: usize,
    /// Normals negated because most of the mesh's pointed away from their triangles.
    pub turned_normals: usize,
    /// Holes closed.
    pub filled_holes: usize,
    /// Edges with one triangle, kept: the surface has holes.
    pub boundary_edges: usize,
    /// Edges with more than two triangles, kept.
    pub non_manifold_edges: usize,
    /// Edges whose two triangles face opposite sides, kept.
    pub inconsistent_edges: usize,
    /// Pieces of the surface that have only one side, left as they are.
    pub unorientable_pieces: usize,
    /// Whether some or all normals were missing, zero or not finite, and were computed.
    pub computed_normals: bool,
    /// For each vertex of the repaired mesh its number in the mesh that was given, or [`NEW`](Self::NEW): where a caller's own vertex
    /// buffer keeps it.
    pub origins: Vec<u32>,
}

impl RepairReport {
    /// The origin of a vertex that closes a hole.
    pub const NEW: u32 = u32::MAX;

    /// Whether the mesh came through as it was (computed normals aside) and is closed and consistently oriented.
    #[must_use]
    pub fn is_pristine(&self) -> bool {
        Self { computed_normals: false, origins: Vec::new(), ..self.clone() } == Self::default()
    }
}

impl fmt::Display for RepairReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = [
            (self.turned_edges, "edges turned to give triangles an area"),
            (self.dropped_degenerate, "triangles without area dropped"),
            (self.dropped_duplicate, "repeated triangles dropped"),
            (self.dropped_vertices, "unused vertices dropped"),
            (self.welded_vertices, "vertices welded"),
            (self.flipped_triangles, "triangles turned over"),
            (self.turned_normals, "normals turned around"),
            (self.filled_holes, "holes closed"),
            (self.boundary_edges, "boundary edges"),
            (self.non_manifold_edges, "non-manifold edges"),
            (self.inconsistent_edges, "edges between triangles of opposite sides"),
            (self.unorientable_pieces, "one-sided pieces"),
        ];
        let mut parts: Vec<_> =
            counts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
        if parts.is_empty() {
            parts.push("closed, nothing to repair".into());
        }
        if self.computed_normals {
            parts.push("normals computed".into());
        }
        f.write_str(&parts.join(", "))
    }
}
