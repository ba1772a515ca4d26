//! A rig: nodes, joints and the animations that move them; from a time to a pose, and from a pose to positions.
//!
//! ```no_run
//! # #[cfg(feature = "load")]
//! # fn example() -> Result<(), Box<dyn std::error::Error>> {
//! use translume_mesh::{load, rig};
//!
//! let loaded = load::load("fox.glb".as_ref())?;
//! if let Some(rig) = &loaded.rig {
//!     let pose = rig.pose(rig.animations.first(), 0.5);
//!     let positions = rig::posed(&loaded.mesh, &pose)?;
//! }
//! # Ok(())
//! # }
//! ```
//!
//! Source: Khronos, glTF 2.0 specification, sections 3.7.3 (skins), 3.11 (animations) and appendix C (interpolation).

mod pose;
mod sample;

pub use pose::{PoseError, posed, posed_into};
#[cfg(feature = "load")]
pub(crate) use {pose::affine, sample::unit};

/// A hierarchy of nodes, the joints that move a mesh, and the animations of both.
///
/// Every vertex of a rigged mesh follows joints ([`Mesh::skin`](crate::Mesh::skin)): those of its skin, or, where a part of the mesh
/// hangs on a node without a skin, that node alone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rig {
    /// Nodes, parents before their children.
    pub nodes: Vec<Node>,
    /// What [`Skin`](crate::Skin)'s influences name.
    pub joints: Vec<Joint>,
    /// Morph weights where no animation says otherwise, one per target of the mesh.
    pub weights: Vec<f32>,
    /// Animations, in the order of the file.
    pub animations: Vec<Animation>,
}

/// A node and where it stands in its parent.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// The name an artist gave it; may be empty.
    pub name: String,
    /// Index of the parent, lower than the node's own.
    pub parent: Option<u32>,
    /// Where it stands when no animation moves it.
    pub local: Local,
}

/// A transform from a node to its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Local {
    /// Scale, then rotation (unit quaternion x, y, z, w), then translation: what animations can move.
    Trs {
        /// Translation.
        translation: [f32; 3],
        /// Rotation, x, y, z, w.
        rotation: [f32; 4],
        /// Scale.
        scale: [f32; 3],
    },
    /// A matrix, column-major.
    Matrix([[f32; 4]; 4]),
}

/// A joint: a node, and the transform from the mesh at rest into that node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Index of the node.
    pub node: u32,
    /// From the rest pose of the mesh to the node, column-major.
    pub inverse_bind: [[f32; 4]; 4],
}

/// Movement over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Animation {
    /// The name an artist gave it; may be empty.
    pub name: String,
    /// Seconds until the last key.
    pub duration: f32,
    /// What it moves.
    pub channels: Vec<Channel>,
}

/// One moved quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// What it moves.
    pub target: Target,
    /// How to get from key to key.
    pub interpolation: Interpolation,
    /// Seconds of the keys, strictly ascending, at least one.
    pub times: Vec<f32>,
    /// Values of the keys, one after the other; for [`Interpolation::CubicSpline`] each is in-tangent, value, out-tangent.
    pub values: Vec<f32>,
}

/// What a channel moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Translation of a node, 3 numbers.
    Translation(u32),
    /// Rotation of a node, 4 numbers.
    Rotation(u32),
    /// Scale of a node, 3 numbers.
    Scale(u32),
    /// Some of the mesh's morph weights.
    Weights {
        /// The first of them.
        first: u32,
        /// How many.
        count: u32,
    },
}

/// How to get from key to key.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// The earlier key's value until the next.
    Step,
    /// A straight line; for rotations the shorter arc at even speed.
    #[default]
    Linear,
    /// A cubic Hermite spline with stored tangents.
    CubicSpline,
}

/// What a deformation needs of a rig at one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// One weight per morph target of the mesh.
    pub weights: Vec<f32>,
    /// One matrix per joint, from the mesh at rest to model space, column-major.
    pub joints: Vec<[[f32; 4]; 4]>,
}
