//! Makes a mesh clean, or says why it cannot be: mends what has one right answer, drops what cannot carry light, and counts both.

mod caps;
pub(crate) mod check;
mod cover;
pub(crate) mod edges;
mod error;
mod holes;
mod nesting;
mod orient;
mod patch;
mod report;
mod vertices;

pub use error::RepairError;
pub use holes::fill_holes;
pub use report::RepairReport;

use edges::{Across, Edges};
use orient::Orientation;

use crate::mesh::Mesh;
use crate::weld::weld;

/// A triangle whose height over its longest edge is below this share of the mesh's diagonal has no area. Positions
/// are stored to about 6e-8 of the diagonal, so the direction of such a triangle is noise, and `uvunwrap` lays none
/// out below 1e-6.
const MIN_HEIGHT: f64 = 2e-6;

/// Distances over which vertices may be joined, as shares of the mesh's diagonal: from what f32 resolves to what an eye does.
const WELD_DISTANCES: std::ops::RangeInclusive<f32> = 1e-8..=1e-2;

/// What [`repair_with`] shall do beyond dropping what cannot carry light.
#[derive(Clone, Debug, PartialEq)]
pub struct RepairOptions {
    /// Join vertices that lie within this share of the mesh's diagonal, 1e-8 to 1e-2, or, if it is 0, at one position:
    /// the first of them gives the position, and those that also agree in normal, morph deltas and skin influences
    /// become one vertex. Split normals stay split, so hard edges stay hard. `None`, the default, keeps every used
    /// vertex, and with it the numbering of a caller's own vertex buffers.
    pub weld_distance: Option<f32>,
    /// Make neighbouring triangles face the same side, and closed surfaces face outwards. On by default.
    pub orient: bool,
    /// Close holes of up to this many edges, see [`fill_holes`]. `None`, the default, closes none.
    pub fill_holes: Option<usize>,
}

impl Default for RepairOptions {
    fn default() -> Self {
        Self { weld_distance: None, orient: true, fill_holes: None }
    }
}

/// [`repair_with`] the default options.
///
/// # Errors
/// Those of [`repair_with`].
pub fn repair(mesh: Mesh) -> Result<(Mesh, RepairReport), RepairError> {
    repair_with(mesh, &RepairOptions::default())
}

/// Makes a mesh clean: see [`Mesh`]. The order of what remains is kept, new vertices and triangles follow after it.
///
/// Always: a triangle whose corners lie on a line gives the middle one to the neighbour across its longest edge, by turning that edge,
/// so that the surface stays closed; triangles without an area where that cannot be, repeated triangles and unused vertices are
/// dropped; normals that are missing, zero
/// or not finite are computed ([`smooth_normals`](crate::normals::smooth_normals)), the others are brought to unit length.
/// A triangle that repeats another from the other side makes a sheet with two sides and stays.
///
/// [`RepairOptions::orient`]: in each piece of the surface, joined by edges of two triangles, the fewer triangles are turned
/// over to face the side of the others. A closed piece whose triangles face inwards is turned outside out, together with
/// what lies inside it; one that lies inside another is otherwise left as it is, for it may be a cavity. A piece with only one
/// side, such as a Möbius strip, is left alone and counted. Normals of turned triangles that then point away from them are negated, and all
/// normals of a mesh where most point away from their triangles.
///
/// All this, and the counts of edges, is after joining vertices at the same position. Repairing a second time with the same
/// options changes nothing but the last bit of some normals.
///
/// # Errors
/// [`RepairError`], where dropping would change what the artist meant: it names the element.
pub fn repair_with(mut mesh: Mesh, options: &RepairOptions) -> Result<(Mesh, RepairReport), RepairError> {
    check::check(&mesh)?;
    let mut report = RepairReport::default();
    let given = mesh.positions.len();
    if let Some(share) = options.weld_distance {
        snap(&mut mesh, share)?;
    }
    let min_height = MIN_HEIGHT * f64::from(mesh.diagonal());
    report.turned_edges = caps::turn_edges(&mut mesh, min_height);
    report.dropped_degenerate = drop_flat(&mut mesh, min_height);
    if mesh.triangles.is_empty() {
        return Err(RepairError::NoArea { mesh: mesh.name, triangles: report.dropped_degenerate });
    }
    let welded = weld(&mesh.positions);
    while mend(&mut mesh, &welded, options.orient, &mut report) {}
    if let Some(max_edges) = options.fill_holes {
        report.filled_holes = fill_holes(&mut mesh, max_edges);
        // A surface that is closed only now shows only now where its outside is.
        let welded = weld(&mesh.positions);
        while mend(&mut mesh, &welded, options.orient, &mut report) {}
    }
    report.origins =
        (0..mesh.positions.len()).map(|v| if v < given { v as u32 } else { RepairReport::NEW }).collect();
    report.dropped_vertices = vertices::drop_unused(&mut mesh, &mut report.origins);
    report.computed_normals = vertices::complete_normals(&mut mesh);
    if options.orient {
        report.turned_normals = vertices::turn_normals(&mut mesh);
    }
    if options.weld_distance.is_some() {
        report.welded_vertices = vertices::join_equal(&mut mesh);
        vertices::drop_unused(&mut mesh, &mut report.origins);
    }
    Ok((mesh, report))
}

fn snap(mesh: &mut Mesh, share: f32) -> Result<(), RepairError> {
    if share != 0.0 {
        if !WELD_DISTANCES.contains(&share) {
            return Err(RepairError::WeldDistance { mesh: mesh.name.clone(), share });
        }
        let distance = f64::from(share) * f64::from(mesh.diagonal());
        vertices::snap(&mut mesh.positions, distance);
    }
    Ok(())
}

fn drop_flat(mesh: &mut Mesh, min_height: f64) -> usize {
    let kept: Vec<bool> = (0..mesh.triangles.len()).map(|t| !caps::is_flat(mesh, t, min_height)).collect();
    keep_triangles(mesh, &kept)
}

/// Drops repeated triangles, or else orients. Either may make room for the other: returns whether something changed.
fn mend(mesh: &mut Mesh, welded: &[u32], orient: bool, report: &mut RepairReport) -> bool {
    let edges = Edges::new(&mesh.triangles, welded);
    report.count_edges(&edges);
    let (kept, orientation) = match unrepeated(&edges) {
        None if orient => (None, Orientation::of(mesh, &edges)),
        kept => (kept, Orientation::default()),
    };
    let dropped = kept.map_or(0, |kept| keep_triangles(mesh, &kept));
    orientation.apply(mesh);
    report.dropped_duplicate += dropped;
    report.flipped_triangles += orientation.flipped.len();
    report.unorientable_pieces = orientation.unorientable;
    dropped > 0 || !orientation.flipped.is_empty()
}

/// Marks all but the repetitions of triangles that have the same corners and side; `None` where there are none.
fn unrepeated(edges: &Edges<'_>) -> Option<Vec<bool>> {
    let mut kept = None;
    // Two triangles that walk an edge in opposite ways are no repetitions, and most edges have just those.
    let suspect = |group: &&[(u32, u32)]| {
        matches!(edges.across[group[0].1 as usize], Across::Opposite(_) | Across::Crowd)
    };
    for group in edges.groups().filter(suspect) {
        let apex = |half| edges.half_edges.to(edges::next(half));
        let mut triangles: Vec<_> =
            group.iter().map(|&(_, half)| (edges.half_edges.from(half), apex(half), half / 3)).collect();
        triangles.sort_unstable();
        for pair in triangles.windows(2).filter(|pair| (pair[0].0, pair[0].1) == (pair[1].0, pair[1].1)) {
            kept.get_or_insert_with(|| vec![true; edges.across.len() / 3])[pair[1].2 as usize] = false;
        }
    }
    kept
}

/// Drops triangles that are not marked; returns how many.
fn keep_triangles(mesh: &mut Mesh, kept: &[bool]) -> usize {
    retain(&mut mesh.triangles, kept);
    retain(&mut mesh.uvs, kept);
    kept.len() - mesh.triangles.len()
}

/// Keeps the entries that are marked; a list without entries stays so.
fn retain<T>(list: &mut Vec<T>, kept: &[bool]) {
    let mut kept = kept.iter();
    list.retain(|_| kept.next() == Some(&true));
}

impl RepairReport {
    fn count_edges(&mut self, edges: &Edges<'_>) {
        let count = |which: fn(&Across) -> bool| edges.across.iter().filter(|across| which(across)).count();
        self.boundary_edges = count(|across| *across == Across::Boundary);
        self.inconsistent_edges = count(|across| matches!(across, Across::Opposite(_))) / 2;
        self.non_manifold_edges = edges.groups().filter(|group| group.len() > 2).count();
    }
}
