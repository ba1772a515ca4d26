//! Small meshes with small atlases: a software rasteriser has to run them all.

use std::sync::{Arc, OnceLock};
use translume_mesh::{Atlas, AtlasOptions, AtlasVertex, Influence, Mesh, MorphTarget, Skin, builtin};

/// A mesh and its atlas.
#[derive(Clone, Debug)]
pub struct Model {
    /// The mesh.
    pub mesh: Mesh,
    /// Its atlas.
    pub atlas: Atlas,
}

impl Model {
    /// Unwraps a mesh.
    ///
    /// # Panics
    /// If it cannot be unwrapped.
    #[must_use]
    pub fn new(mesh: Mesh, size: u32) -> Arc<Self> {
        let options = AtlasOptions { size, ..AtlasOptions::default() };
        let atlas = Atlas::build(&mesh, &options, |_| true).expect("the atlas of a built-in mesh");
        Arc::new(Self { mesh, atlas })
    }
}

/// The creature at about 5,000 triangles with its morph target, atlas 64².
#[must_use]
pub fn creature() -> Arc<Model> {
    static MODEL: OnceLock<Arc<Model>> = OnceLock::new();
    Arc::clone(MODEL.get_or_init(|| Model::new(builtin::creature_with(5000), 64)))
}

/// A sphere of radius 50 around the origin, 1,280 triangles, atlas 48².
#[must_use]
pub fn sphere() -> Arc<Model> {
    static MODEL: OnceLock<Arc<Model>> = OnceLock::new();
    Arc::clone(MODEL.get_or_init(|| sphere_with(48)))
}

/// The same sphere with an atlas of another size.
#[must_use]
pub fn sphere_with(size: u32) -> Arc<Model> {
    Model::new(builtin::sphere([0.0; 3], 50.0, 3), size)
}

/// The sphere with a morph target that pulls its front out, and a skin of three joints, one above the other.
#[must_use]
pub fn limb() -> Arc<Model> {
    static MODEL: OnceLock<Arc<Model>> = OnceLock::new();
    Arc::clone(MODEL.get_or_init(|| {
        let mut mesh = builtin::sphere([0.0; 3], 50.0, 3);
        let pulled = mesh.positions.iter().map(|p| [0.0, 0.0, p[2].max(0.0)]).collect();
        mesh.targets = vec![MorphTarget { name: "pulled".to_owned(), position_deltas: pulled }];
        // Below the lowest joint and above the highest there is one influence, between two of them two.
        let influences = mesh.positions.iter().flat_map(|p| {
            let place = (p[1] / 30.0 + 1.0).clamp(0.0, 2.0);
            let below = place.floor().min(1.0);
            let influence =
                |joint: f32| Influence { joint: joint as u32, weight: 1.0 - (place - joint).abs() };
            [influence(below), influence(below + 1.0)]
        });
        mesh.skin = Some(Skin { joints: 3, per_vertex: 2, influences: influences.collect() });
        Model::new(mesh, 48)
    }))
}

/// Newell's teapot, 992 triangles, atlas 64².
#[must_use]
pub fn teapot() -> Arc<Model> {
    static MODEL: OnceLock<Arc<Model>> = OnceLock::new();
    Arc::clone(MODEL.get_or_init(|| Model::new(builtin::teapot_with(4), 64)))
}

/// Boxes given by low and high corner in one mesh, atlas 64².
#[must_use]
pub fn cuboids(boxes: &[([f32; 3], [f32; 3])]) -> Arc<Model> {
    let mut all = Mesh { name: "boxes".to_owned(), ..Mesh::default() };
    for &(low, high) in boxes {
        let mesh = builtin::cuboid(low, high, [4, 2, 4]);
        let first = all.positions.len() as u32;
        all.positions.extend(mesh.positions);
        all.normals.extend(mesh.normals);
        all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    Model::new(all, 64)
}

/// A square of this side in the plane y = 0, facing up, that fills an atlas of `size`² texels edge to edge.
///
/// # Panics
/// Never: the square can be laid out.
#[must_use]
pub fn plane(side: f32, size: u32) -> Arc<Model> {
    const CELLS: u32 = 8;
    let mut mesh = Mesh { name: "plane".to_owned(), ..Mesh::default() };
    let mut vertices = Vec::new();
    for row in 0..=CELLS {
        for column in 0..=CELLS {
            let uv = [column, row].map(|k| k as f32 / CELLS as f32);
            vertices.push(AtlasVertex { xref: vertices.len() as u32, uv });
            mesh.positions.push([(uv[0] - 0.5) * side, 0.0, (0.5 - uv[1]) * side]);
            mesh.normals.push([0.0, 1.0, 0.0]);
        }
    }
    for row in 0..CELLS {
        for column in 0..CELLS {
            let a = row * (CELLS + 1) + column;
            let [b, c, d] = [a + 1, a + CELLS + 2, a + CELLS + 1];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let triangles = mesh.triangles.clone();
    let atlas = Atlas::from_uvs(&mesh, size, vertices, triangles).expect("the atlas of a square");
    Arc::new(Model { mesh, atlas })
}
