//! Triangles whose three corners lie on a line. Dropping one leaves a slit as wide as nothing, but a slit: the surface is no longer
//! closed. Turning its longest edge instead gives the corner in the middle to the neighbour there.

use glam::DVec3;

use super::cover::height;
use super::edges::{Across, Edges, next};
use crate::mesh::Mesh;
use crate::weld::weld;

/// Turns the longest edge of each triangle without an area, where the neighbour across it faces the same side, shares its vertices and
/// texture coordinates, and the two triangles that come of it have an area. Returns how many edges it turned.
pub(super) fn turn_edges(mesh: &mut Mesh, min_height: f64) -> usize {
    let mut turned = 0;
    // A turned edge may be what the next triangle in a row of flat ones waits for; a row is at most as long as there are triangles.
    loop {
        let flat: Vec<usize> = (0..mesh.triangles.len()).filter(|&t| is_flat(mesh, t, min_height)).collect();
        if flat.is_empty() {
            return turned;
        }
        let before = turned;
        turned += turn_those(mesh, &flat, min_height);
        if turned == before {
            return turned;
        }
    }
}

pub(super) fn is_flat(mesh: &Mesh, t: usize, min_height: f64) -> bool {
    height(points(mesh, mesh.triangles[t])) <= min_height
}

fn turn_those(mesh: &mut Mesh, flat: &[usize], min_height: f64) -> usize {
    let welded = weld(&mesh.positions);
    let before = mesh.triangles.clone();
    let edges = Edges::new(&before, &welded);
    let mut touched = vec![false; before.len()];
    let mut drawn = std::collections::HashSet::new();
    let mut turned = 0;
    for &t in flat {
        let half = longest(mesh, t);
        let Across::Same(twin) = edges.across[half as usize] else { continue };
        let n = twin as usize / 3;
        let apexes = [half, twin].map(|half| edges.half_edges.from(next(next(half))));
        let edge = (apexes[0].min(apexes[1]), apexes[0].max(apexes[1]));
        if touched[t] || touched[n] || edges.contains(edge.0, edge.1) || drawn.contains(&edge) {
            continue;
        }
        let Some(pair) = Turned::new(mesh, half, twin) else { continue };
        if pair.triangles.iter().all(|&triangle| height(points(mesh, triangle)) > min_height) {
            pair.apply(mesh, [t, n]);
            drawn.insert(edge);
            (touched[t], touched[n]) = (true, true);
            turned += 1;
        }
    }
    turned
}

/// The two triangles that a pair becomes.
struct Turned {
    triangles: [[u32; 3]; 2],
    uvs: Option<[[[f32; 2]; 3]; 2]>,
}

impl Turned {
    /// `None` where the pair meets in a seam: what the neighbour's chart would be at the new corner nobody knows.
    fn new(mesh: &Mesh, half: u32, twin: u32) -> Option<Self> {
        // From a to b along the edge, c before it and d beyond.
        let [a, b, c] = around(half).map(|half| mesh.triangles[half as usize / 3][half as usize % 3]);
        let [b_beyond, a_beyond, d] =
            around(twin).map(|half| mesh.triangles[half as usize / 3][half as usize % 3]);
        let uvs = if mesh.uvs.is_empty() {
            None
        } else {
            let uv = |half: u32| mesh.uvs[half as usize / 3][half as usize % 3];
            let ([a, b, c], [b_beyond, a_beyond, d]) = (around(half).map(uv), around(twin).map(uv));
            if (a, b) != (a_beyond, b_beyond) {
                return None;
            }
            Some([[c, a, d], [d, b, c]])
        };
        ((a, b) == (a_beyond, b_beyond)).then_some(Self { triangles: [[c, a, d], [d, b, c]], uvs })
    }

    fn apply(self, mesh: &mut Mesh, places: [usize; 2]) {
        for k in 0..2 {
            mesh.triangles[places[k]] = self.triangles[k];
            if let Some(uvs) = self.uvs {
                mesh.uvs[places[k]] = uvs[k];
            }
        }
    }
}

/// A half-edge and the two that follow it.
fn around(half: u32) -> [u32; 3] {
    [half, next(half), next(next(half))]
}

fn longest(mesh: &Mesh, t: usize) -> u32 {
    let p = points(mesh, mesh.triangles[t]);
    let length = |k: usize| p[k].distance_squared(p[(k + 1) % 3]);
    let k = (1..3).fold(0, |best, k| if length(k) > length(best) { k } else { best });
    (3 * t + k) as u32
}

fn points(mesh: &Mesh, triangle: [u32; 3]) -> [DVec3; 3] {
    triangle.map(|v| DVec3::from(mesh.positions[v as usize].map(f64::from)))
}
