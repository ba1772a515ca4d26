//! Closing holes: loops of boundary edges become patches of triangles.

use std::collections::{HashMap, HashSet};

use super::MIN_HEIGHT;
use super::edges::{Across, Edges, next};
use super::patch::Patch;
use crate::mesh::Mesh;
use crate::weld::weld;

/// Closes the holes of a clean mesh that have at most `max_edges` boundary edges, and returns how many it closed.
///
/// A hole is a loop of edges with one triangle, after joining vertices at the same position, that passes no vertex twice.
/// Up to eight edges it gets the triangles of least area between its vertices, beyond that a fan around a new vertex in
/// its middle, or, where such a fan would turn triangles over, the triangles of least area again. Existing triangles and
/// vertices keep their numbers; new ones follow after them. A new vertex gets the means of normals, texture coordinates
/// and morph deltas, and the skin influences of the nearest vertex of the rim.
///
/// Left open are loops that meet edges with more than two triangles or between triangles of opposite sides, and holes
/// that only triangles without an area would close. To topology the border of a sheet is a hole like any other: a limit
/// of `usize::MAX` gives every sheet a second side.
pub fn fill_holes(mesh: &mut Mesh, max_edges: usize) -> usize {
    let min_height = MIN_HEIGHT * f64::from(mesh.diagonal());
    let welded = weld(&mesh.positions);
    let edges = Edges::new(&mesh.triangles, &welded);
    let mut diagonals = HashSet::new();
    let mut patches = Vec::new();
    for hole in holes(&edges).iter().filter(|hole| hole.len() <= max_edges) {
        patches.extend(Patch::new(mesh, &edges, hole, min_height, &mut diagonals));
    }
    patches.iter().for_each(|patch| patch.apply(mesh));
    patches.len()
}

/// The half-edges that begin at the vertices of each hole's rim, in the order in which the missing triangles walk them.
fn holes(edges: &Edges<'_>) -> Vec<Vec<u32>> {
    let mut seen = HashSet::new();
    let mut holes = Vec::new();
    for (half, across) in (0..).zip(&edges.across) {
        if *across == Across::Boundary
            && !seen.contains(&half)
            && let Some(mut rim) = walk(edges, half, &mut seen)
        {
            // The missing triangles walk the rim against those that are there.
            rim.reverse();
            split(edges, &rim, &mut holes);
        }
    }
    holes
}

/// The boundary half-edges from `first` around the hole and back; `None` where they do not lead back.
fn walk(edges: &Edges<'_>, first: u32, seen: &mut HashSet<u32>) -> Option<Vec<u32>> {
    let mut rim = vec![first];
    seen.insert(first);
    loop {
        let half = boundary_after(edges, *rim.last()?)?;
        if half == first {
            return Some(rim);
        }
        if !seen.insert(half) {
            return None;
        }
        rim.push(half);
    }
}

/// The boundary half-edge that begins where another ends, found through the triangles around that vertex.
fn boundary_after(edges: &Edges<'_>, half: u32) -> Option<u32> {
    let mut half = next(half);
    loop {
        match edges.across[half as usize] {
            Across::Boundary => return Some(half),
            Across::Same(twin) => half = next(twin),
            Across::Opposite(_) | Across::Crowd => return None,
        }
    }
}

/// Cuts a rim where it touches itself, so that no loop passes a vertex twice.
fn split(edges: &Edges<'_>, rim: &[u32], holes: &mut Vec<Vec<u32>>) {
    let mut path: Vec<u32> = Vec::new();
    let mut places = HashMap::new();
    for &half in rim {
        if let Some(&begin) = places.get(&edges.half_edges.from(half)) {
            let hole = path.split_off(begin);
            for &half in &hole {
                places.remove(&edges.half_edges.from(half));
            }
            holes.push(hole);
        }
        places.insert(edges.half_edges.from(half), path.len());
        path.push(half);
    }
    holes.push(path);
}
