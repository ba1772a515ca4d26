//! The mesh that every stage speaks.

/// An indexed triangle mesh in the model's own units: right-handed, y up, counter-clockwise front faces.
///
/// A mesh that came out of [`repair`](crate::repair::repair) or of a loader is *clean*: every index is in range, every
/// number finite, every triangle has an area, and at least one triangle exists.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// What to call it in messages: the file's name or the built-in's.
    pub name: String,
    /// Vertex positions, model units.
    pub positions: Vec<[f32; 3]>,
    /// Unit vertex normals, one per position. Vertices may be split where the surface has a hard edge.
    pub normals: Vec<[f32; 3]>,
    /// Triangles, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The file's own texture coordinates, one per corner of each triangle, u to the right and v downwards as in glTF;
    /// empty where the file has none. Corners and not vertices, so that a vertex on a seam stays one vertex.
    pub uvs: Vec<[[f32; 2]; 3]>,
    /// Morph targets (blend shapes); each moves every vertex by its weight times a delta.
    pub targets: Vec<MorphTarget>,
    /// Which joints move each vertex, after the morph targets; `None` for a mesh without a rig.
    pub skin: Option<Skin>,
}

/// One blend shape: `position = rest + Σ weight · delta`. Normals follow from the deformed positions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MorphTarget {
    /// The name an artist gave it; may be empty.
    pub name: String,
    /// Displacement of every vertex at weight 1, model units.
    pub position_deltas: Vec<[f32; 3]>,
}

/// Linear blend skinning: `position = Σ weight · joint matrix · (rest + morph deltas)`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skin {
    /// Number of joints that influences may name; a pose has a matrix for each.
    pub joints: usize,
    /// Influences of each vertex, at least 1.
    pub per_vertex: usize,
    /// `per_vertex` influences for each vertex in turn; unused ones weigh 0. The weights of a vertex add up to 1.
    pub influences: Vec<Influence>,
}

/// One joint's share in a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Influence {
    /// The joint, below [`Skin::joints`].
    pub joint: u32,
    /// Its share, 0..1.
    pub weight: f32,
}

impl Mesh {
    /// The corners of the axis-aligned bounding box of the referenced vertices at rest, model units.
    /// `None` for a mesh without triangles.
    #[must_use]
    pub fn bounds(&self) -> Option<([f32; 3], [f32; 3])> {
        let mut corners = self.triangles.iter().flatten().map(|&v| self.positions[v as usize]);
        let first = corners.next()?;
        Some(corners.fold((first, first), |(low, high), p| {
            (std::array::from_fn(|k| low[k].min(p[k])), std::array::from_fn(|k| high[k].max(p[k])))
        }))
    }

    /// Length of the bounding box's diagonal, model units; 0 for a mesh without triangles.
    #[must_use]
    pub fn diagonal(&self) -> f32 {
        self.bounds().map_or(0.0, |(low, high)| {
            // In f64, so that squares of tiny and huge sides neither vanish nor overflow.
            let side = |k: usize| f64::from(high[k]) - f64::from(low[k]);
            (0..3).map(|k| side(k).powi(2)).sum::<f64>().sqrt() as f32
        })
    }

    /// Corner positions of one triangle at rest.
    #[must_use]
    pub fn corners(&self, triangle: usize) -> [[f32; 3]; 3] {
        self.triangles[triangle].map(|v| self.positions[v as usize])
    }
}
