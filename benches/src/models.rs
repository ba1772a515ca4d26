//! The models of Table 1 of Gong et al. 2008, or what comes nearest.

use std::path::Path;
use translume_mesh::spherical::{EggOptions, to_egg};
use translume_mesh::{Atlas, AtlasOptions, Mesh, builtin, load};

/// A mesh and its atlas.
pub struct Model {
    /// With the number of triangles.
    pub name: String,
    /// The mesh.
    pub mesh: Mesh,
    /// Its atlas.
    pub atlas: Atlas,
}

/// As wide as the paper's.
const ATLAS: u32 = 256;

impl Model {
    /// Unwraps a mesh into an atlas `size` texels wide.
    ///
    /// # Panics
    /// If it cannot be unwrapped.
    #[must_use]
    pub fn new(mesh: Mesh, size: u32) -> Self {
        let atlas = Atlas::build(&mesh, &AtlasOptions { size, ..Default::default() }, |_| true)
            .unwrap_or_else(|error| panic!("{}: {error}", mesh.name));
        Self { name: format!("{} {}", mesh.name, mesh.triangles.len()), mesh, atlas }
    }
}

/// 2,256 triangles, as many as in the paper.
#[must_use]
pub fn teapot() -> Model {
    Model::new(builtin::teapot_with(6), ATLAS)
}

/// About 50,000 triangles, with an egg to morph into.
#[must_use]
pub fn creature() -> Model {
    Model::new(builtin::creature(), ATLAS)
}

/// About 10,000 triangles in an atlas of 64²: for the sum over all pairs of texels.
#[must_use]
pub fn small_creature() -> Model {
    Model::new(builtin::creature_with(10_000), 64)
}

/// Stanford's bunny, 69,451 triangles; `None`, with a word to the person at the terminal, where `TRANSLUME_MODELS` does not lead to it.
///
/// # Panics
/// If the file cannot be read or unwrapped.
#[must_use]
pub fn bunny() -> Option<Model> {
    Some(Model::new(bunny_mesh()?, ATLAS))
}

/// The same with an egg to morph into.
///
/// # Panics
/// If the file cannot be read, unwrapped or laid around an egg.
#[must_use]
pub fn bunny_to_egg() -> Option<Model> {
    let laid = to_egg(&bunny_mesh()?, &EggOptions::default(), |_| true);
    Some(Model::new(laid.unwrap_or_else(|error| panic!("{error}")).mesh, ATLAS))
}

fn bunny_mesh() -> Option<Mesh> {
    const FILE: &str = "stanford-bunny.obj";
    let Some(folder) = std::env::var_os("TRANSLUME_MODELS") else {
        eprintln!("left out: {FILE}; set TRANSLUME_MODELS to the folder that holds it");
        return None;
    };
    let path = Path::new(&folder).join(FILE);
    if !path.is_file() {
        eprintln!("left out: {} is not there", path.display());
        return None;
    }
    Some(load::load(&path).unwrap_or_else(|error| panic!("{error}")).mesh)
}
