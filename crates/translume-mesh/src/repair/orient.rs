//! Makes neighbouring triangles face the same side, and closed surfaces face outwards.

use glam::DVec3;

use super::edges::{Across, Edges};
use super::nesting::{Solid, outermost};
use crate::mesh::Mesh;

/// Volume of a closed piece, as a share of its bounding box's diagonal cubed, that may be nothing but rounding.
const FLAT: f64 = 1e-9;

/// What makes the orientation consistent.
#[derive(Default)]
pub(super) struct Orientation {
    /// Triangles to turn over.
    pub flipped: Vec<usize>,
    /// Pieces that have only one side.
    pub unorientable: usize,
}

/// Triangles that are joined by edges of two triangles.
struct Piece {
    triangles: Vec<u32>,
    /// Whether no edge leads outside.
    closed: bool,
    orientable: bool,
}

impl Orientation {
    /// Turns over the smaller part of each piece that has parts of both sides, and each closed piece whose volume would be
    /// negative, together with what lies inside it: a cavity stays a cavity.
    pub fn of(mesh: &Mesh, edges: &Edges<'_>) -> Self {
        let mut flip = vec![false; mesh.triangles.len()];
        let mut pieces = pieces(edges, &mut flip);
        for piece in &pieces {
            let turned = piece.triangles.iter().filter(|&&t| flip[t as usize]).count();
            if !piece.orientable {
                piece.triangles.iter().for_each(|&t| flip[t as usize] = false);
            } else if 2 * turned > piece.triangles.len() {
                piece.triangles.iter().for_each(|&t| flip[t as usize] ^= true);
            }
        }
        let unorientable = pieces.iter().filter(|piece| !piece.orientable).count();
        mark_open(edges, &flip, &mut pieces);
        let solids: Vec<Solid> = pieces
            .into_iter()
            .filter(|piece| piece.closed && piece.orientable)
            .map(|piece| Solid::new(mesh, piece.triangles, &flip))
            .collect();
        let inside_out = |solid: &Solid| solid.volume < -FLAT * solid.diagonal().powi(3);
        if solids.iter().any(inside_out) {
            for (solid, outermost) in solids.iter().zip(outermost(mesh, &solids)) {
                if inside_out(&solids[outermost]) {
                    solid.triangles.iter().for_each(|&t| flip[t as usize] ^= true);
                }
            }
        }
        let flipped = (0..flip.len()).filter(|&t| flip[t]).collect();
        Self { flipped, unorientable }
    }

    /// Turns the triangles over, and negates normals that then point away from their triangles.
    pub fn apply(&self, mesh: &mut Mesh) {
        if self.flipped.is_empty() {
            return;
        }
        let mut turned = vec![false; mesh.positions.len()];
        for &t in &self.flipped {
            mesh.triangles[t].swap(1, 2);
            if let Some(uvs) = mesh.uvs.get_mut(t) {
                uvs.swap(1, 2);
            }
            mesh.triangles[t].iter().for_each(|&v| turned[v as usize] = true);
        }
        let mut sides = vec![DVec3::ZERO; mesh.positions.len()];
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = mesh.corners(t).map(|p| DVec3::from(p.map(f64::from)));
            triangle.iter().for_each(|&v| sides[v as usize] += (b - a).cross(c - a));
        }
        for ((normal, side), turned) in mesh.normals.iter_mut().zip(sides).zip(turned) {
            if turned && DVec3::from(normal.map(f64::from)).dot(side) < 0.0 {
                *normal = normal.map(|x| -x);
            }
        }
    }
}

/// Collects the pieces, and marks in `flip` the triangles that face another side than the first of their piece.
fn pieces(edges: &Edges<'_>, flip: &mut [bool]) -> Vec<Piece> {
    let mut seen = vec![false; flip.len()];
    let mut pieces = Vec::new();
    for first in 0..flip.len() as u32 {
        if std::mem::replace(&mut seen[first as usize], true) {
            continue;
        }
        let mut piece = Piece { triangles: vec![first], closed: true, orientable: true };
        let mut next = 0;
        while let Some(&triangle) = piece.triangles.get(next) {
            next += 1;
            for half in 3 * triangle..3 * triangle + 3 {
                let (twin, turned) = match edges.across[half as usize] {
                    Across::Same(twin) => (twin, false),
                    Across::Opposite(twin) => (twin, true),
                    Across::Boundary => {
                        piece.closed = false;
                        continue;
                    }
                    Across::Crowd => continue,
                };
                let neighbour = twin / 3;
                let turned = flip[triangle as usize] ^ turned;
                if std::mem::replace(&mut seen[neighbour as usize], true) {
                    piece.orientable &= flip[neighbour as usize] == turned;
                } else {
                    flip[neighbour as usize] = turned;
                    piece.triangles.push(neighbour);
                }
            }
        }
        pieces.push(piece);
    }
    pieces
}

/// At an edge of more than two triangles a piece is closed if as many of its own walk it one way as the other.
fn mark_open(edges: &Edges<'_>, flip: &[bool], pieces: &mut [Piece]) {
    let mut piece_of = vec![0; flip.len()];
    for (number, piece) in pieces.iter().enumerate() {
        piece.triangles.iter().for_each(|&t| piece_of[t as usize] = number);
    }
    for group in edges.groups().filter(|group| group.len() > 2) {
        let mut walks: Vec<(usize, bool)> = group
            .iter()
            .map(|&(higher, half)| {
                let triangle = half as usize / 3;
                (piece_of[triangle], flip[triangle] ^ (edges.half_edges.from(half) == higher))
            })
            .collect();
        walks.sort_unstable();
        for of_piece in walks.chunk_by(|a, b| a.0 == b.0) {
            let back = of_piece.iter().filter(|walk| walk.1).count();
            if 2 * back != of_piece.len() {
                pieces[of_piece[0].0].closed = false;
            }
        }
    }
}
