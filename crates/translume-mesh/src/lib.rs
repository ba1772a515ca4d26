//! The ground floor of translume: any mesh becomes an [`Atlas`] fit for light.
//!
//! | module | what it does |
//! | --- | --- |
//! | [`mesh`] | the [`Mesh`] everything speaks: positions, normals, triangles, morph targets |
//! | [`load`] | OBJ, PLY, glTF and GLB files, with errors that name the element |
//! | [`repair`] | drops what cannot carry light, orients, welds, closes holes, and counts it all |
//! | [`normals`] | vertex normals at rest, and which triangles make them up on any pose |
//! | [`atlas`] | charts and packing (by `uvunwrap`), the one-time raster into texels, gutters, texel order |
//! | [`spherical`] | a closed surface without handles laid around a sphere or an egg, as a morph target |
//! | [`rig`] | nodes, joints, animations: from a time to the weights and matrices of a pose |
//! | [`warp`] | twist, bend and inflation |
//! | [`material`] | what a file says a surface and the volume behind it are made of |
//! | [`builtin`] | sphere, torus knot, Newell's teapot, and the creature that melts into an egg |
//!
//! Nothing here knows a GPU. Lengths are the model's own units throughout; `translume` converts to millimetres.

pub mod atlas;
#[cfg(feature = "builtin")]
pub mod builtin;
#[cfg(feature = "load")]
pub mod load;
pub mod material;
pub mod mesh;
pub mod normals;
mod progress;
pub mod repair;
pub mod rig;
pub mod spherical;
pub mod warp;
mod weld;

pub use atlas::{Atlas, AtlasError, AtlasReport, AtlasVertex, Texel};
#[cfg(feature = "unwrap")]
pub use atlas::{AtlasOptions, ChartSource};
pub use material::{Material, Scattering};
pub use mesh::{Influence, Mesh, MorphTarget, Skin};
pub use progress::Progress;
pub use repair::{RepairError, RepairOptions, RepairReport};
pub use warp::Warp;
