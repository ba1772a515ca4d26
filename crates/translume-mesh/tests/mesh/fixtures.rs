//! Meshes and layouts made by hand.

use std::collections::{HashMap, HashSet};

use translume_mesh::{Atlas, AtlasVertex, Mesh, repair::repair};

/// Side 2, centred, eight vertices.
pub fn cube() -> Mesh {
    let positions =
        (0..8).map(|k| [k & 1, k >> 1 & 1, k >> 2].map(|bit| if bit == 1 { 1.0 } else { -1.0 })).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { name: "cube".into(), positions, triangles, ..Mesh::default() }
}

/// Every other corner of the cube.
pub fn tetrahedron() -> Mesh {
    Mesh {
        name: "tetrahedron".into(),
        positions: vec![[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]],
        ..Mesh::default()
    }
}

/// A unit octahedron, each triangle split in four `levels` times, on the unit sphere.
pub fn sphere(levels: usize) -> Mesh {
    let mut positions: Vec<[f32; 3]> = vec![
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let [p, q] = [a, b].map(|v| positions[v as usize]);
                let sum: [f32; 3] = std::array::from_fn(|k| p[k] + q[k]);
                let length = sum.iter().map(|x| x * x).sum::<f32>().sqrt();
                positions.push(sum.map(|x| x / length));
                (positions.len() - 1) as u32
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let [d, e, f] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
            })
            .collect();
    }
    Mesh { name: "sphere".into(), positions, triangles, ..Mesh::default() }
}

pub fn clean(mesh: Mesh) -> Mesh {
    repair(mesh).unwrap().0
}

/// Every triangle a chart of its own, in a grid, `margin` texels from the border of its cell.
pub fn grid_layout(mesh: &Mesh, size: u32, margin: f32) -> (Vec<AtlasVertex>, Vec<[u32; 3]>) {
    let side = (mesh.triangles.len() as f32).sqrt().ceil();
    let cell = 1.0 / side;
    let margin = margin / size as f32;
    assert!(cell > 2.0 * margin, "the grid has no room");
    let mut vertices = Vec::new();
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let low = [t % side as usize, t / side as usize].map(|k| k as f32 * cell + margin);
        let extent = cell - 2.0 * margin;
        let corners = [low, [low[0] + extent, low[1]], [low[0] + extent * 0.3, low[1] + extent]];
        vertices.extend(triangle.iter().zip(corners).map(|(&xref, uv)| AtlasVertex { xref, uv }));
    }
    let triangles = (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    (vertices, triangles)
}

pub fn grid_atlas(mesh: &Mesh, size: u32) -> Atlas {
    let (vertices, triangles) = grid_layout(mesh, size, 2.3);
    Atlas::from_uvs(mesh, size, vertices, triangles).unwrap()
}

pub fn area(mesh: &Mesh) -> f64 {
    (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t).map(|p| p.map(f64::from));
            let [u, v]: [[f64; 3]; 2] = [b, c].map(|p| std::array::from_fn(|k| p[k] - a[k]));
            let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            cross.iter().map(|x| x * x).sum::<f64>().sqrt() / 2.0
        })
        .sum()
}

/// The smallest generator of numbers that look random (Knuth's MMIX constants).
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % n as u64) as usize
    }

    /// Between −1 and 1.
    pub fn signed(&mut self) -> f32 {
        self.below(1 << 24) as f32 / (1 << 23) as f32 - 1.0
    }

    pub fn point(&mut self, size: f32) -> [f32; 3] {
        std::array::from_fn(|_| size * self.signed())
    }
}

/// A folder that goes away with the test.
#[cfg(feature = "load")]
pub struct Folder(tempfile::TempDir);

#[cfg(feature = "load")]
impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self) -> &std::path::Path {
        self.0.path()
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> std::path::PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    pub fn load(
        &self,
        name: &str,
        bytes: impl AsRef<[u8]>,
    ) -> Result<translume_mesh::load::Loaded, translume_mesh::load::LoadError> {
        translume_mesh::load::load(&self.write(name, bytes))
    }
}

/// What is left when vertices at the same position are one.
pub struct Topology {
    /// V − E + F: 2 for one closed piece without handles.
    pub euler: isize,
    /// Directed edges that do not occur once, or whose opposite does not: 0 on a closed, oriented manifold.
    pub bad_edges: usize,
}

impl Topology {
    pub fn of(mesh: &Mesh) -> Self {
        let point = |v: u32| mesh.positions[v as usize].map(|x| (x + 0.0).to_bits());
        let mut vertices = HashSet::new();
        let mut edges = HashMap::new();
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(point);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                vertices.insert(from);
                *edges.entry((from, to)).or_insert(0) += 1;
            }
        }
        let pairs: HashSet<_> = edges.keys().map(|&(from, to)| (from.min(to), from.max(to))).collect();
        let bad = |&(&(from, to), &count): &(&([u32; 3], [u32; 3]), &usize)| {
            count != 1 || edges.get(&(to, from)) != Some(&1)
        };
        Self {
            euler: vertices.len() as isize - pairs.len() as isize + mesh.triangles.len() as isize,
            bad_edges: edges.iter().filter(bad).count(),
        }
    }
}

/// Volume inside a closed mesh, positive if its triangles face outwards.
pub fn volume(mesh: &Mesh) -> f64 {
    (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t).map(|p| p.map(f64::from));
            (a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]))
                / 6.0
        })
        .sum()
}
