//! Makes a mesh clean, or says why it cannot be: drops what cannot carry light and counts what it dropped.

use std::collections::{HashMap, HashSet};
use std::fmt;

use glam::{DVec3, Vec3};

use crate::mesh::Mesh;
use crate::normals::smooth_normals;
use crate::weld::weld;

/// A triangle whose height over its longest edge is below this share of the mesh's diagonal has no area. Positions
/// are stored to about 6e-8 of the diagonal, so the direction of such a triangle is noise, and `uvunwrap` lays none
/// out below 1e-6.
const MIN_HEIGHT: f64 = 2e-6;

/// Diagonals within which products of two edges, and their squares, neither vanish nor overflow in f32.
const DIAGONALS: std::ops::RangeInclusive<f32> = 1e-6..=1e9;

/// What [`repair`] changed, and what it saw and left alone.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RepairReport {
    /// Triangles without an area, dropped.
    pub dropped_degenerate: usize,
    /// Repeated triangles (same three positions, same side), dropped.
    pub dropped_duplicate: usize,
    /// Vertices that no remaining triangle uses, dropped.
    pub dropped_vertices: usize,
    /// Edges with one triangle, kept: the surface has holes.
    pub boundary_edges: usize,
    /// Edges with more than two triangles, kept.
    pub non_manifold_edges: usize,
    /// Edges whose two triangles face opposite sides, kept.
    pub inconsistent_edges: usize,
    /// Whether some or all normals were missing, zero or not finite, and were computed.
    pub computed_normals: bool,
}

impl RepairReport {
    /// Whether the mesh came through as it was (computed normals aside) and is closed and consistently oriented.
    #[must_use]
    pub fn is_pristine(&self) -> bool {
        Self { computed_normals: false, ..self.clone() } == Self::default()
    }
}

impl fmt::Display for RepairReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = [
            (self.dropped_degenerate, "triangles without area dropped"),
            (self.dropped_duplicate, "repeated triangles dropped"),
            (self.dropped_vertices, "unused vertices dropped"),
            (self.boundary_edges, "boundary edges"),
            (self.non_manifold_edges, "non-manifold edges"),
            (self.inconsistent_edges, "edges between triangles of opposite sides"),
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

/// Makes a mesh clean: see [`Mesh`]. Order and winding of what remains are kept.
///
/// Triangles without an area, repeated triangles and unused vertices are dropped; normals that are missing, zero or not
/// finite are computed ([`smooth_normals`]), the others are brought to unit length. Edges are counted after joining
/// vertices at the same position; they are not changed.
///
/// # Errors
/// [`RepairError`], where dropping would change what the artist meant: it names the element.
pub fn repair(mut mesh: Mesh) -> Result<(Mesh, RepairReport), RepairError> {
    check(&mesh)?;
    let mut report = RepairReport::default();
    let welded = weld(&mesh.positions);
    drop_triangles(&mut mesh, &welded, &mut report);
    if mesh.triangles.is_empty() {
        let triangles = report.dropped_degenerate;
        return Err(RepairError::NoArea { mesh: mesh.name, triangles });
    }
    count_edges(&mesh.triangles, &welded, &mut report);
    drop_vertices(&mut mesh, &mut report);
    complete_normals(&mut mesh, &mut report);
    Ok((mesh, report))
}

fn check(mesh: &Mesh) -> Result<(), RepairError> {
    let name = || mesh.name.clone();
    let count = mesh.positions.len();
    let mut used = vec![false; count];
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        for &vertex in corners {
            *used.get_mut(vertex as usize).ok_or_else(|| RepairError::Index {
                mesh: name(),
                triangle,
                vertex,
                count,
            })? = true;
        }
    }
    let broken = |points: &[[f32; 3]]| {
        let mut used = used.iter().zip(points);
        used.position(|(&used, p)| used && !p.iter().all(|x| x.is_finite()))
    };
    if let Some(vertex) = broken(&mesh.positions) {
        return Err(RepairError::Vertex { mesh: name(), vertex, position: mesh.positions[vertex] });
    }
    for (target, deltas) in mesh.targets.iter().map(|t| &t.position_deltas).enumerate() {
        if deltas.len() != count {
            return Err(RepairError::TargetCount { mesh: name(), target, deltas: deltas.len(), count });
        }
        if let Some(vertex) = broken(deltas) {
            return Err(RepairError::TargetDelta { mesh: name(), target, vertex, delta: deltas[vertex] });
        }
    }
    if !mesh.normals.is_empty() && mesh.normals.len() != count {
        return Err(RepairError::NormalCount { mesh: name(), normals: mesh.normals.len(), count });
    }
    // A mesh without extent has no area either, and that is the clearer message.
    let diagonal = mesh.diagonal();
    if diagonal != 0.0 && !DIAGONALS.contains(&diagonal) {
        return Err(RepairError::Scale { mesh: name(), diagonal });
    }
    Ok(())
}

fn drop_triangles(mesh: &mut Mesh, welded: &[u32], report: &mut RepairReport) {
    let min_height = MIN_HEIGHT * f64::from(mesh.diagonal());
    let positions = &mesh.positions;
    let mut seen = HashSet::with_capacity(mesh.triangles.len());
    let keep = |triangle: &[u32; 3]| {
        let flat = height(triangle.map(|v| positions[v as usize])) <= min_height;
        let repeated = !flat && !seen.insert(rotated(triangle.map(|v| welded[v as usize])));
        report.dropped_degenerate += usize::from(flat);
        report.dropped_duplicate += usize::from(repeated);
        !flat && !repeated
    };
    let kept: Vec<bool> = mesh.triangles.iter().map(keep).collect();
    retain(&mut mesh.triangles, &kept);
    retain(&mut mesh.uvs, &kept);
}

/// Keeps the entries that are marked; a list without entries stays so.
fn retain<T>(list: &mut Vec<T>, kept: &[bool]) {
    let mut kept = kept.iter();
    list.retain(|_| kept.next() == Some(&true));
}

/// Height over the longest edge; 0 for a point.
fn height(corners: [[f32; 3]; 3]) -> f64 {
    let [a, b, c] = corners.map(|p| DVec3::from(p.map(f64::from)));
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    if longest > 0.0 { (b - a).cross(c - a).length() / longest } else { 0.0 }
}

/// The same triangle beginning with its smallest vertex.
fn rotated([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a <= b && a <= c {
        [a, b, c]
    } else if b <= c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

fn count_edges(triangles: &[[u32; 3]], welded: &[u32], report: &mut RepairReport) {
    // Per edge, how often triangles walk it up and down the vertex numbers.
    let mut walks: HashMap<(u32, u32), [usize; 2]> = HashMap::with_capacity(triangles.len() * 2);
    for triangle in triangles {
        let corner = triangle.map(|v| welded[v as usize]);
        for (from, to) in [(corner[0], corner[1]), (corner[1], corner[2]), (corner[2], corner[0])] {
            walks.entry((from.min(to), from.max(to))).or_default()[usize::from(from > to)] += 1;
        }
    }
    for [up, down] in walks.into_values() {
        report.boundary_edges += usize::from(up + down == 1);
        report.non_manifold_edges += usize::from(up + down > 2);
        report.inconsistent_edges += usize::from(up + down == 2 && up != down);
    }
}

fn drop_vertices(mesh: &mut Mesh, report: &mut RepairReport) {
    let mut used = vec![false; mesh.positions.len()];
    mesh.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    report.dropped_vertices = used.iter().filter(|&&used| !used).count();
    if report.dropped_vertices == 0 {
        return;
    }
    let before = used.iter().scan(0, |kept, &used| {
        let number = *kept;
        *kept += u32::from(used);
        Some(number)
    });
    let renumbered: Vec<u32> = before.collect();
    mesh.triangles.iter_mut().flatten().for_each(|v| *v = renumbered[*v as usize]);
    retain(&mut mesh.positions, &used);
    retain(&mut mesh.normals, &used);
    mesh.targets.iter_mut().for_each(|target| retain(&mut target.position_deltas, &used));
    if let Some(skin) = &mut mesh.skin {
        let used: Vec<bool> =
            used.iter().flat_map(|&used| std::iter::repeat_n(used, skin.per_vertex)).collect();
        retain(&mut skin.influences, &used);
    }
}

fn complete_normals(mesh: &mut Mesh, report: &mut RepairReport) {
    mesh.normals.resize(mesh.positions.len(), [0.0; 3]);
    let units: Vec<Option<Vec3>> = mesh.normals.iter().map(|&n| Vec3::from(n).try_normalize()).collect();
    report.computed_normals = units.contains(&None);
    let computed =
        if report.computed_normals { smooth_normals(&mesh.positions, &mesh.triangles) } else { Vec::new() };
    for (v, unit) in units.into_iter().enumerate() {
        mesh.normals[v] = unit.map_or_else(|| computed[v], |n| n.to_array());
    }
}
