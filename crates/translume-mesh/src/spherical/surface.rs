//! A mesh seen as one closed surface, if it is one.

use glam::DVec3;

use super::SphericalError;
use crate::mesh::Mesh;
use crate::repair::edges::{Across, Edges, next};
use crate::weld::weld;

/// A closed, oriented surface without handles: a mesh whose vertices at the same position are one.
pub(super) struct Surface {
    /// Model units.
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    /// The position that each vertex of the mesh is at; any for one that no triangle uses.
    pub welded: Vec<u32>,
    /// Squared model units.
    pub area: f64,
    /// Mean of the surface, model units.
    pub centroid: DVec3,
    /// Cubed model units, positive.
    pub volume: f64,
}

impl Surface {
    /// Of a clean mesh.
    pub fn new(mesh: &Mesh) -> Result<Self, SphericalError> {
        let welded = weld(&mesh.positions);
        check(mesh, &welded)?;
        let (welded, positions) = compact(mesh, &welded);
        let triangles = mesh.triangles.iter().map(|t| t.map(|v| welded[v as usize])).collect();
        let surface = Self { positions, triangles, welded, area: 0.0, centroid: DVec3::ZERO, volume: 0.0 };
        let surface = surface.measured();
        if surface.volume > 0.0 {
            Ok(surface)
        } else {
            Err(SphericalError::InsideOut { mesh: mesh.name.clone() })
        }
    }

    fn measured(mut self) -> Self {
        let origin = self.positions.first().copied().unwrap_or_default();
        let mut moment = DVec3::ZERO;
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|v| self.positions[v as usize] - origin);
            let area = (b - a).cross(c - a).length() / 2.0;
            self.area += area;
            moment += area * (a + b + c) / 3.0;
            self.volume += a.dot(b.cross(c)) / 6.0;
        }
        self.centroid = origin + moment / self.area.max(f64::MIN_POSITIVE);
        self
    }
}

/// Numbers the positions that triangles use, without gaps.
fn compact(mesh: &Mesh, welded: &[u32]) -> (Vec<u32>, Vec<DVec3>) {
    let mut used = vec![false; welded.len()];
    mesh.triangles.iter().flatten().for_each(|&v| used[welded[v as usize] as usize] = true);
    let mut numbers = vec![0; welded.len()];
    let mut positions = Vec::new();
    for v in (0..welded.len()).filter(|&v| used[v]) {
        numbers[v] = positions.len() as u32;
        positions.push(DVec3::from(mesh.positions[v].map(f64::from)));
    }
    (welded.iter().map(|&w| numbers[w as usize]).collect(), positions)
}

fn check(mesh: &Mesh, welded: &[u32]) -> Result<(), SphericalError> {
    let name = || mesh.name.clone();
    let count = mesh.triangles.len();
    if count < 4 {
        return Err(SphericalError::TooFew { mesh: name(), triangles: count });
    }
    let flat = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| welded[v as usize]);
        a == b || b == c || c == a
    };
    if let Some(triangle) = mesh.triangles.iter().position(flat) {
        return Err(SphericalError::NoArea { mesh: name(), triangle });
    }
    let edges = Edges::new(&mesh.triangles, welded);
    check_edges(mesh, &edges)?;
    match pieces(&edges) {
        1 => {}
        count => return Err(SphericalError::Components { mesh: name(), count }),
    }
    let open = edges.across.iter().filter(|&&across| across == Across::Boundary).count();
    if open > 0 {
        return Err(SphericalError::Open { mesh: name(), edges: open });
    }
    let vertices = check_fans(mesh, &edges)?;
    // V − E + F = 2 − 2 genus, and on a closed surface 2 E = 3 F.
    match (count + 4 - 2 * vertices) / 4 {
        0 => Ok(()),
        genus => Err(SphericalError::Genus { mesh: name(), genus }),
    }
}

fn check_edges(mesh: &Mesh, edges: &Edges<'_>) -> Result<(), SphericalError> {
    for group in edges.groups() {
        let Some(&(_, half)) = group.first() else { continue };
        let at = |half: u32| mesh.positions[edges.half_edges.vertex(half) as usize];
        let (mesh, from, to) = (mesh.name.clone(), at(half), at(next(half)));
        match edges.across[half as usize] {
            Across::Crowd => {
                return Err(SphericalError::NonManifoldEdge { mesh, triangles: group.len(), from, to });
            }
            Across::Opposite(_) => return Err(SphericalError::Orientation { mesh, from, to }),
            Across::Same(_) | Across::Boundary => {}
        }
    }
    Ok(())
}

/// Number of pieces that hang together by edges.
fn pieces(edges: &Edges<'_>) -> usize {
    let mut seen = vec![false; edges.across.len() / 3];
    let mut count = 0;
    for first in 0..seen.len() {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        count += 1;
        let mut open = vec![first];
        while let Some(triangle) = open.pop() {
            for across in &edges.across[3 * triangle..3 * triangle + 3] {
                if let Across::Same(twin) = *across {
                    let beyond = twin as usize / 3;
                    if !std::mem::replace(&mut seen[beyond], true) {
                        open.push(beyond);
                    }
                }
            }
        }
    }
    count
}

/// The number of vertices of a closed surface, each with one fan of triangles.
fn check_fans(mesh: &Mesh, edges: &Edges<'_>) -> Result<usize, SphericalError> {
    let mut seen = vec![false; edges.across.len()];
    let mut fans = vec![false; mesh.positions.len()];
    let mut count = 0;
    for first in 0..edges.half_edges.count() {
        if seen[first as usize] {
            continue;
        }
        let vertex = edges.half_edges.from(first);
        if std::mem::replace(&mut fans[vertex as usize], true) {
            let position = mesh.positions[vertex as usize];
            return Err(SphericalError::NonManifoldVertex { mesh: mesh.name.clone(), vertex, position });
        }
        count += 1;
        let mut half = first;
        while !std::mem::replace(&mut seen[half as usize], true) {
            if let Across::Same(twin) = edges.across[half as usize] {
                half = next(twin);
            }
        }
    }
    Ok(count)
}
