//! Mesh files: OBJ, glTF and GLB.
//!
//! A loader never panics, whatever the file holds, and reserves memory below a fixed bound or in proportion to the file's
//! own length. Its errors name the file, the element and a way out.

mod accessor;
mod buffers;
mod gltf;
mod obj;

use std::path::Path;

use crate::material::Material;
use crate::mesh::Mesh;
use crate::repair::{RepairError, RepairReport, repair};
use crate::rig::Rig;

/// Extensions that [`load`] reads, in lower case.
pub const EXTENSIONS: [&str; 3] = ["obj", "gltf", "glb"];

/// A clean mesh from a file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Loaded {
    /// The mesh, named after the file.
    pub mesh: Mesh,
    /// What had to be repaired.
    pub repairs: RepairReport,
    /// What a unit of the file is, where the format says so: 1 for glTF (its specification, section 3.4), `None` for OBJ.
    pub metres_per_unit: Option<f32>,
    /// What moves it, where the file has animations or skins; without joints, nodes and animations where it has nothing but
    /// morph targets with default weights other than 0.
    pub rig: Option<Rig>,
    /// What it is made of. A body is one medium, so of the materials that describe a scattering medium
    /// ([`Material::scattering`]) it is the one that covers the largest area of the rest pose; where none does, the one that
    /// covers the largest area. `None` where no material covers anything, and for OBJ.
    pub material: Option<Material>,
}

/// What a format's reader returns.
struct Model {
    mesh: Mesh,
    rig: Option<Rig>,
    material: Option<Material>,
}

/// Why a file could not be loaded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The file, or one it refers to, cannot be read.
    #[error("{file}: cannot be read: {reason}; check the path and its permissions")]
    Read {
        /// The file.
        file: String,
        /// What the operating system said.
        reason: String,
    },
    /// The extension is none that the loader knows.
    #[error("{file}: its extension is none of .obj, .gltf, .glb; convert it to one of them")]
    UnknownExtension {
        /// The file.
        file: String,
    },
    /// The file has the right extension and other contents, or no triangle.
    #[error("{file}: is not a mesh: {reason}; export it again as a triangle mesh")]
    NotAMesh {
        /// The file.
        file: String,
        /// What was found, or missed.
        reason: String,
    },
    /// A line of an OBJ file cannot be understood.
    #[error("{file}: line {line}: {reason}; re-export the file or correct the line")]
    Line {
        /// The file.
        file: String,
        /// The line, from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// A face of an OBJ file names a vertex or normal that does not exist.
    #[error(
        "{file}: face {face} uses {element} {index}, but there are {count}; re-export the file or repair its indices"
    )]
    Face {
        /// The file.
        file: String,
        /// The face, counted from 1 in the order of the file.
        face: usize,
        /// `vertex` or `normal`.
        element: &'static str,
        /// The index as the file has it: from 1, or negative and counted backwards.
        index: i64,
        /// How many there are.
        count: usize,
    },
    /// A vertex that a face of an OBJ file uses is not a point.
    #[error("{file}: vertex {vertex} is at {position:?}; re-export the file or remove the vertex")]
    Vertex {
        /// The file.
        file: String,
        /// The vertex, from 1.
        vertex: usize,
        /// Where it is said to be.
        position: [f32; 3],
    },
    /// An element of a glTF file contradicts the file or the format.
    #[error("{file}: {element}: {reason}; check the file with a glTF validator and re-export it")]
    Gltf {
        /// The file.
        file: String,
        /// The element, by its place in the JSON: `meshes[0].primitives[1]`.
        element: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The file is well formed and its mesh cannot be made clean.
    #[error(transparent)]
    Repair(#[from] RepairError),
}

/// Reads a mesh and repairs it. The extension, in any case, decides the format.
///
/// OBJ: faces of any arity become fans (right for convex ones), objects and groups merge, vertices split where normals
/// differ, texture coordinates and materials are ignored.
///
/// glTF and GLB: the default scene as one mesh.
///
/// - *Parts.* Every triangle primitive of every node, where the node's default transform puts it. `TEXCOORD_0` becomes
///   [`Mesh::uvs`]; points, lines, colours, tangents, further coordinates, cameras, lights and images are not read.
/// - *Skins.* Where the file has animations or skins, every vertex follows joints: of the skin (all sets of joints and
///   weights, brought to a sum of 1; a vertex without weight follows the first joint it names), or one for its node. A part
///   with a skin rests in the shape it was bound in, put in place by the default transform of the skin's first joint and its
///   inverse bind matrix, or left as modelled where that cannot be undone. What a node's default transform flattens (a
///   scale of 0) rests flat, and is dropped with the other triangles without area.
/// - *Morph targets.* They merge by their number where all nodes that have some are driven alike (one node, or nothing
///   animated and the same default weights), else each node's targets are the mesh's own. Names are those of
///   `extras.targetNames`; default weights go to [`Rig::weights`]. Normals and tangents in targets are not read.
/// - *Animations.* Translation, rotation, scale and weights; step, linear and cubic. Channels that move nothing in the scene
///   are left out.
/// - *Materials.* [`Loaded::material`]; factors and no textures, nor the transforms of their coordinates.
///
/// Draco, Meshopt and other compressed geometry is refused. A document may use the same data again and again, but to no
/// more than 192 MB, or 24 bytes for each of its own.
///
/// # Errors
/// [`LoadError`], which names the file and the element.
pub fn load(path: &Path) -> Result<Loaded, LoadError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    let file = path.display().to_string();
    let (model, metres_per_unit) = match extension.as_deref() {
        Some("obj") => {
            let mesh = obj::read(&file, &read_file(path)?)?;
            (Model { mesh, rig: None, material: None }, None)
        }
        Some("gltf" | "glb") => (gltf::read(path, &read_file(path)?)?, Some(1.0)),
        _ => return Err(LoadError::UnknownExtension { file }),
    };
    let Model { mut mesh, rig, material } = model;
    mesh.name = path.file_name().map_or(file, |name| name.to_string_lossy().into_owned());
    let (mesh, repairs) = repair(mesh)?;
    Ok(Loaded { mesh, repairs, metres_per_unit, rig, material })
}

fn read_file(path: &Path) -> Result<Vec<u8>, LoadError> {
    let error = |reason: String| LoadError::Read { file: path.display().to_string(), reason };
    // Devices and pipes may never end.
    if !std::fs::metadata(path).map_err(|e| error(e.to_string()))?.is_file() {
        return Err(error("it is not a regular file".into()));
    }
    std::fs::read(path).map_err(|e| error(e.to_string()))
}
