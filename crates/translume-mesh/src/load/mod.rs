//! Mesh files: OBJ, PLY, glTF and GLB.
//!
//! A loader never panics, whatever the file holds, and reserves memory below a fixed bound or in proportion to the file's
//! own length. Its errors name the file, the element and a way out.

mod accessor;
mod buffers;
mod gltf;
mod listener;
mod obj;
mod ply;
mod polygon;

use std::path::Path;

use crate::material::Material;
use crate::mesh::Mesh;
use crate::progress::Progress;
use crate::repair::{RepairError, RepairReport, repair};
use crate::rig::Rig;
use listener::Listener;

/// Extensions that [`load`] reads, in lower case.
pub const EXTENSIONS: [&str; 4] = ["obj", "ply", "gltf", "glb"];

/// A clean mesh from a file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Loaded {
    /// The mesh, named after the file.
    pub mesh: Mesh,
    /// What had to be repaired.
    pub repairs: RepairReport,
    /// What a unit of the file is, where the format says so: 1 for glTF (its specification, section 3.4), `None` for OBJ and
    /// PLY.
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
    #[error("{file}: its extension is none of .obj, .ply, .gltf, .glb; convert it to one of them")]
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
    /// A line of an OBJ file, or of the header of a PLY file, cannot be understood.
    #[error("{file}: line {line}: {reason}; re-export the file or correct the line")]
    Line {
        /// The file.
        file: String,
        /// The line, from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// A face of an OBJ file names a vertex, texture coordinate or normal that does not exist.
    #[error(
        "{file}: face {face} uses {element} {index}, but there are {count}; re-export the file or repair its indices"
    )]
    Face {
        /// The file.
        file: String,
        /// The face, counted from 1 in the order of the file.
        face: usize,
        /// `vertex`, `texture coordinate` or `normal`.
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
    /// A row of a PLY file is cut off, holds something that is no number, or contradicts the file.
    #[error("{file}: {element}: {reason}; re-export the file")]
    Ply {
        /// The file.
        file: String,
        /// The row, such as `face 12 (from 0)`, or the element.
        element: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A face has more corners than can be cut into triangles in reasonable time, and is not convex.
    #[error(
        "{file}: face {face} has {corners} corners, above {} for one that is not convex; export it as triangles",
        polygon::MAX_CORNERS
    )]
    Polygon {
        /// The file.
        file: String,
        /// The face, counted from 1 in the order of the file.
        face: usize,
        /// Number of its corners.
        corners: usize,
    },
    /// The progress callback returned `false`.
    #[error("{file}: loading was cancelled")]
    Cancelled {
        /// The file.
        file: String,
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
/// OBJ: objects and groups merge, vertices split where normals differ, missing normals are computed, and texture
/// coordinates are kept where every face has them; materials are ignored. Faces of more than three corners become fans
/// where such a fan lies inside them, as in convex ones, and else lose one ear after the other.
///
/// PLY, in text or binary: vertices with x, y, z and, if there, nx, ny, nz, and faces, which are cut as those of OBJ; other elements
/// and properties are skipped.
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
/// Repair takes its defaults; [`repair_with`](crate::repair::repair_with) the mesh again to weld it or to close its holes.
///
/// # Errors
/// [`LoadError`], which names the file and the element.
pub fn load(path: &Path) -> Result<Loaded, LoadError> {
    load_with_progress(path, |_| true)
}

/// [`load`] for files that take a while. `progress` hears of the stages `reading` and `parsing`, in bytes, and
/// `repairing`; when it returns `false` loading ends.
///
/// # Errors
/// [`LoadError::Cancelled`] when `progress` returned `false`, and those of [`load`].
pub fn load_with_progress(path: &Path, progress: impl Fn(Progress) -> bool) -> Result<Loaded, LoadError> {
    parse(path, &progress, |listener| listener.read(path))
}

/// [`load_with_progress`] of a file whose bytes are in memory, from an archive or a browser. `path` names it: its extension decides the
/// format, and buffers of a glTF file that it does not hold itself are read from the disk beside it.
///
/// # Errors
/// Those of [`load_with_progress`].
pub fn load_bytes(
    path: &Path,
    bytes: Vec<u8>,
    progress: impl Fn(Progress) -> bool,
) -> Result<Loaded, LoadError> {
    parse(path, &progress, |_| Ok(bytes))
}

fn parse(
    path: &Path,
    progress: &dyn Fn(Progress) -> bool,
    bytes: impl FnOnce(&Listener<'_>) -> Result<Vec<u8>, LoadError>,
) -> Result<Loaded, LoadError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    let file = path.display().to_string();
    let listener = Listener { file: &file, progress };
    let bare = |mesh| Model { mesh, rig: None, material: None };
    let (model, metres_per_unit) = match extension.as_deref() {
        Some("obj") => (bare(obj::read(bytes(&listener)?, &listener)?), None),
        Some("ply") => (bare(ply::read(&bytes(&listener)?, &listener)?), None),
        Some("gltf" | "glb") => (gltf::read(path, &bytes(&listener)?)?, Some(1.0)),
        _ => return Err(LoadError::UnknownExtension { file }),
    };
    listener.tell("repairing", 0, None)?;
    let Model { mut mesh, rig, material } = model;
    mesh.name = path.file_name().map_or_else(|| file.clone(), |name| name.to_string_lossy().into_owned());
    let (mesh, repairs) = repair(mesh)?;
    Ok(Loaded { mesh, repairs, metres_per_unit, rig, material })
}

fn read_file(path: &Path) -> Result<Vec<u8>, LoadError> {
    Listener { file: &path.display().to_string(), progress: &|_| true }.read(path)
}
