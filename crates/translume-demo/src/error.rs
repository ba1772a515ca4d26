//! Everything that ends a command, in one line.

use std::path::PathBuf;
use translume_mesh::load::LoadError;
use translume_mesh::rig::PoseError;
use translume_mesh::spherical::SphericalError;
use translume_mesh::{AtlasError, RepairError};

#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Load(#[from] LoadError),
    #[error(transparent)]
    Repair(#[from] RepairError),
    #[error(transparent)]
    Pose(#[from] PoseError),
    #[error(transparent)]
    Atlas(#[from] AtlasError),
    #[error(transparent)]
    Spherical(#[from] SphericalError),
    #[error(transparent)]
    Path(#[from] translume_reference::path::PathError),
    #[error(transparent)]
    Translume(#[from] translume::Error),
    #[error(transparent)]
    Rival(#[from] translume_rivals::Error),
    #[error("{}: {problem}", path.display())]
    Scene { path: PathBuf, problem: String },
    #[error("{}: {problem}", path.display())]
    Environment { path: PathBuf, problem: String },
    #[error("{}: {problem}", path.display())]
    Texture { path: PathBuf, problem: String },
    #[error("{}: {problem}", path.display())]
    Table { path: PathBuf, problem: String },
    #[error("{}: {problem}", path.display())]
    Output { path: PathBuf, problem: String },
    #[error("{option}: {problem}")]
    Option { option: &'static str, problem: String },
    #[error("the graphics driver has failed; save the scene and start the program again")]
    Worker,
    #[error("no window can be opened: {0}; `translume --help` tells what works without one")]
    Window(String),
    #[error(
        "no graphics adapter found ({0}); on Debian or Ubuntu `apt-get install libvulkan1 mesa-vulkan-drivers` brings a software one"
    )]
    NoAdapter(String),
    #[error("{adapter}: no device: {reason}")]
    NoDevice { adapter: String, reason: String },
}
