//! Makes a mesh clean, or says why it cannot be: drops what cannot carry light and counts what it dropped.

mod cover;
pub(crate) mod edges;
mod error;
mod holes;
mod patch;
mod report;

use std::collections::HashSet;

use glam::{DVec3, Vec3};

pub use error::RepairError;
pub use holes::fill_holes;
pub use report::RepairReport;

use crate::mesh::Mesh;
use crate::normals::smooth_normals;
use crate::weld::weld;
use edges::{Across, Edges};
use error::DIAGONALS;

/// A triangle whose height over its longest edge is below this share of the mesh's diagonal has no area. Positions
/// are stored to about 6e-8 of the diagonal, so the direction of such a triangle is noise, and `uvunwrap` lays none
/// out below 1e-6.
const MIN_HEIGHT: f64 = 2e-6;

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

pub(crate) fn check(mesh: &Mesh) -> Result<(), RepairError> {
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
        let flat =
            cover::height(triangle.map(|v| DVec3::from(positions[v as usize].map(f64::from)))) <= min_height;
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
    let edges = Edges::new(triangles, welded);
    let count = |which: fn(&Across) -> bool| edges.across.iter().filter(|a| which(a)).count();
    report.boundary_edges = count(|a| *a == Across::Boundary);
    report.inconsistent_edges = count(|a| matches!(a, Across::Opposite(_))) / 2;
    report.non_manifold_edges = edges.groups().filter(|group| group.len() > 2).count();
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
