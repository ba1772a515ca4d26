//! Which closed surface lies inside which.

use std::collections::HashMap;

use glam::{DVec2, DVec3, Vec3Swizzles};

use crate::mesh::Mesh;

/// A closed piece of a mesh.
pub(super) struct Solid {
    pub triangles: Vec<u32>,
    /// Positive where the triangles, turned over as planned, face outwards.
    pub volume: f64,
    low: DVec3,
    high: DVec3,
}

impl Solid {
    /// `flip` tells which triangles of the mesh are to be turned over.
    pub fn new(mesh: &Mesh, triangles: Vec<u32>, flip: &[bool]) -> Self {
        let mut solid = Self { triangles, volume: 0.0, low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        let origin = solid.triangles.first().map_or(DVec3::ZERO, |&t| corners(mesh, t)[0]);
        for &t in &solid.triangles {
            let [a, b, c] = corners(mesh, t);
            solid.low = solid.low.min(a).min(b).min(c);
            solid.high = solid.high.max(a).max(b).max(c);
            let volume = (a - origin).dot((b - origin).cross(c - origin)) / 6.0;
            solid.volume += if flip[t as usize] { -volume } else { volume };
        }
        solid
    }

    pub fn diagonal(&self) -> f64 {
        self.low.distance(self.high)
    }

    /// Whether its volume and bounding box leave room for another.
    fn may_hold(&self, other: &Self) -> bool {
        self.volume.abs() > other.volume.abs()
            && self.low.cmple(other.low).all()
            && self.high.cmpge(other.high).all()
    }
}

/// For each solid the outermost one around it; itself, where it lies in none.
///
/// A solid lies inside another if a ray from one of its vertices leaves the other more often than it enters, or less often.
pub(super) fn outermost(mesh: &Mesh, solids: &[Solid]) -> Vec<usize> {
    let mut holders: Vec<usize> = (0..solids.len()).collect();
    if solids.len() > 1 {
        sweep(mesh, solids, &mut holders);
    }
    let mut by_volume: Vec<usize> = (0..solids.len()).collect();
    by_volume.sort_by(|&a, &b| solids[b].volume.abs().total_cmp(&solids[a].volume.abs()));
    // A holder is larger than what it holds, so it comes first.
    for k in by_volume {
        holders[k] = holders[holders[k]];
    }
    holders
}

/// Finds the largest solid around each, by rays along z from points in the order of x.
fn sweep(mesh: &Mesh, solids: &[Solid], holders: &mut [usize]) {
    let mut walls: Vec<(f64, usize, u32)> = Vec::new();
    for (k, solid) in solids.iter().enumerate() {
        walls.extend(solid.triangles.iter().map(|&t| {
            let [a, b, c] = corners(mesh, t);
            (a.x.min(b.x).min(c.x), k, t)
        }));
    }
    walls.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut points: Vec<(DVec3, usize)> =
        solids.iter().enumerate().map(|(k, solid)| (corners(mesh, solid.triangles[0])[0], k)).collect();
    points.sort_by(|a, b| a.0.x.total_cmp(&b.0.x));

    let mut walls = walls.into_iter().peekable();
    let mut active: Vec<(usize, [DVec3; 3])> = Vec::new();
    for (point, inner) in points {
        while let Some((_, k, t)) = walls.next_if(|wall| wall.0 <= point.x) {
            active.push((k, corners(mesh, t)));
        }
        active.retain(|(_, [a, b, c])| a.x.max(b.x).max(c.x) >= point.x);
        let mut windings: HashMap<usize, i32> = HashMap::new();
        for (outer, corners) in &active {
            if solids[*outer].may_hold(&solids[inner]) {
                *windings.entry(*outer).or_default() += crossing(point, *corners);
            }
        }
        let around = windings.into_iter().filter(|(_, winding)| *winding != 0).map(|(outer, _)| outer);
        let larger =
            |a: &usize, b: &usize| solids[*a].volume.abs().total_cmp(&solids[*b].volume.abs()).then(b.cmp(a));
        holders[inner] = around.max_by(larger).unwrap_or(inner);
    }
}

/// 1 or −1 where the ray from `point` along z crosses the triangle, by the side of it. Neighbours agree on a ray through their edge.
fn crossing(point: DVec3, corners: [DVec3; 3]) -> i32 {
    let [a, b, c] = corners.map(|p| p - point);
    let winding: i32 = [(a, b), (b, c), (c, a)].iter().map(|(from, to)| turn(from.xy(), to.xy())).sum();
    let normal = (b - a).cross(c - a);
    if winding != 0 && normal.dot(a) * normal.z > 0.0 { winding } else { 0 }
}

/// How an edge takes part in the winding around the origin: 1 or −1 where it crosses the positive half of the first axis.
fn turn(from: DVec2, to: DVec2) -> i32 {
    let left = from.perp_dot(to);
    match (from.y <= 0.0, to.y <= 0.0) {
        (true, false) if left > 0.0 => 1,
        (false, true) if left < 0.0 => -1,
        _ => 0,
    }
}

fn corners(mesh: &Mesh, triangle: u32) -> [DVec3; 3] {
    mesh.corners(triangle as usize).map(|p| DVec3::from(p.map(f64::from)))
}
