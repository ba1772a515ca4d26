//! Measures of a mesh that the built-in models are tested with.

use std::collections::{HashMap, HashSet};

use glam::DVec3;

use crate::Mesh;

/// What is left when vertices at bit-identical positions are one.
pub struct Topology {
    pub vertices: usize,
    pub edges: usize,
    pub triangles: usize,
    pub components: usize,
    /// Directed edges that do not occur exactly once, or whose opposite is missing: 0 on a closed oriented manifold.
    pub bad_edges: usize,
}

impl Topology {
    pub fn of(mesh: &Mesh) -> Self {
        let mut ids = HashMap::new();
        let welded = mesh
            .positions
            .iter()
            .map(|p| {
                let next = ids.len();
                *ids.entry(p.map(|x| (x + 0.0).to_bits())).or_insert(next)
            })
            .collect::<Vec<_>>();
        let mut directed = HashMap::<_, usize>::new();
        let mut parents = (0..ids.len()).collect::<Vec<_>>();
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|v| welded[v as usize]);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *directed.entry((from, to)).or_default() += 1;
                let (from, to) = (root(&mut parents, from), root(&mut parents, to));
                parents[from] = to;
            }
        }
        let bad =
            |(&(a, b), &count): (&(usize, usize), &usize)| count != 1 || !directed.contains_key(&(b, a));
        Self {
            vertices: ids.len(),
            edges: directed.keys().map(|&(a, b)| (a.min(b), a.max(b))).collect::<HashSet<_>>().len(),
            triangles: mesh.triangles.len(),
            components: (0..ids.len()).filter(|&v| parents[v] == v).count(),
            bad_edges: directed.iter().filter(|&entry| bad(entry)).count(),
        }
    }

    /// V − E + F: 2 for one closed piece without handles, 0 for a ring.
    pub fn euler(&self) -> isize {
        self.vertices as isize - self.edges as isize + self.triangles as isize
    }
}

fn root(parents: &mut [usize], mut v: usize) -> usize {
    while parents[v] != v {
        parents[v] = parents[parents[v]];
        v = parents[v];
    }
    v
}

fn corners(mesh: &Mesh, triangle: usize) -> [DVec3; 3] {
    mesh.corners(triangle).map(|p| DVec3::from(p.map(f64::from)))
}

pub fn signed_volume(mesh: &Mesh) -> f64 {
    (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = corners(mesh, t);
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}

pub fn areas(mesh: &Mesh) -> Vec<f64> {
    (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = corners(mesh, t);
            (b - a).cross(c - a).length() / 2.0
        })
        .collect()
}

/// Smallest cosine between a triangle's normal and the normal of one of its corners.
pub fn normal_agreement(mesh: &Mesh) -> f64 {
    (0..mesh.triangles.len())
        .flat_map(|t| {
            let [a, b, c] = corners(mesh, t);
            let face = (b - a).cross(c - a).normalize();
            mesh.triangles[t].map(|v| face.dot(DVec3::from(mesh.normals[v as usize].map(f64::from))))
        })
        .fold(1.0, f64::min)
}

/// Indices in range, everything finite, unit normals, every vertex used, no triangle without area, sizes that fit.
pub fn check_clean(mesh: &Mesh) {
    assert_eq!(mesh.positions.len(), mesh.normals.len());
    assert!(mesh.positions.iter().flatten().all(|x| x.is_finite()));
    let used = mesh.triangles.iter().flatten().collect::<HashSet<_>>();
    assert_eq!(used.len(), mesh.positions.len(), "unreferenced vertices or indices out of range");
    for normal in &mesh.normals {
        let length = normal.iter().map(|x| x * x).sum::<f32>().sqrt();
        assert!((length - 1.0).abs() < 1e-5, "normal of length {length}; f32 rounding is 1e-7");
    }
    let areas = areas(mesh);
    let mean = areas.iter().sum::<f64>() / areas.len() as f64;
    assert!(areas.iter().all(|&a| a > 1e-4 * mean), "a triangle without area");
    assert!(mesh.targets.iter().all(|target| target.position_deltas.len() == mesh.positions.len()));
}
