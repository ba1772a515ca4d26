//! What is lit.

use crate::cli::Report;
use crate::error::Error;
use crate::model::{self, Model};
use glam::Vec3;
use std::path::PathBuf;
use translume_mesh::rig::Pose;
use translume_mesh::{Atlas, AtlasOptions, Warp};

/// A model, its atlas, and how large it is.
pub struct Subject {
    pub name: String,
    pub model: Model,
    pub atlas: Atlas,
    /// As its file shows it.
    pub pose: Pose,
    pub warp: Warp,
    pub mm_per_unit: f32,
    /// Corners of a box around it, units of the model.
    pub bounds: ([f32; 3], [f32; 3]),
    /// From corner to corner, units of the model.
    pub diagonal: f32,
}

/// Every subject is as large as something held in a hand.
const DIAGONAL_MM: f32 = 100.0;
/// Where more models are.
const MODELS: &str = "TRANSLUME_MODELS";

impl Subject {
    pub fn open(name: &str, size: u32) -> Result<Self, Error> {
        let model = model::open(name)?;
        let mm_per_unit = DIAGONAL_MM / model.diagonal()?;
        Self::new(model, mm_per_unit, size)
    }

    pub fn new(model: Model, mm_per_unit: f32, size: u32) -> Result<Self, Error> {
        let options = AtlasOptions { size, ..Default::default() };
        let atlas = model::unwrap(&model.mesh, &options)?;
        let (bounds, diagonal) = (model.bounds()?, model.diagonal()?);
        let pose = model.pose(&model.rig, None, 0.0);
        let name = model.mesh.name.clone();
        Ok(Self { name, model, atlas, pose, warp: Warp::default(), mm_per_unit, bounds, diagonal })
    }

    /// A point so many diagonals away from the middle of the model.
    pub fn place(&self, direction: [f32; 3], diagonals: f32) -> Vec3 {
        let middle = 0.5 * (Vec3::from(self.bounds.0) + Vec3::from(self.bounds.1));
        middle + diagonals * self.diagonal * Vec3::from(direction).normalize_or(Vec3::Y)
    }
}

/// The models asked for, else the creature, and the bunny where the environment says where to find it.
pub fn names(arguments: &Report) -> Vec<String> {
    if !arguments.models.is_empty() {
        return arguments.models.clone();
    }
    std::iter::once("creature".to_owned()).chain(scan("stanford-bunny.obj")).collect()
}

/// The folder of models, if the environment names one.
pub fn models() -> Option<PathBuf> {
    std::env::var_os(MODELS).map(PathBuf::from)
}

/// A file among those models.
pub fn scan(file: &str) -> Option<String> {
    let path = models()?.join(file);
    path.is_file().then(|| path.to_string_lossy().into_owned())
}
