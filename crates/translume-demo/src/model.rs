//! From a name on the command line to a clean mesh and its atlas.

use crate::error::Error;
use crate::progress;
use glam::{Mat4, Vec3};
use std::f32::consts::FRAC_PI_2;
use std::path::Path;
use std::sync::OnceLock;
use translume_mesh::repair::{RepairOptions, repair_with};
use translume_mesh::rig::{self, Animation, Pose, Rig};
use translume_mesh::spherical::{EggOptions, to_egg};
use translume_mesh::{Atlas, AtlasOptions, Mesh, Progress, RepairReport, builtin, load};

/// Hears how far work has come, and ends it by `false`.
pub type Watch<'a> = &'a (dyn Fn(Progress) -> bool + Sync);

/// A mesh, what had to be done to it, and what moves it.
pub struct Model {
    pub mesh: Mesh,
    pub repairs: RepairReport,
    /// Without nodes and animations where the file has none.
    pub rig: Rig,
    /// From the rig's model space to the mesh's: they differ when the mesh alone was turned.
    turn: Mat4,
    /// Of the file's own pose, once they were asked for: every picture needs them, and posing takes milliseconds.
    bounds: OnceLock<([f32; 3], [f32; 3])>,
}

impl Model {
    fn new(mesh: Mesh, repairs: RepairReport, rig: Option<Rig>) -> Self {
        let weights = vec![0.0; mesh.targets.len()];
        let rig = rig.unwrap_or_else(|| Rig { weights, ..Rig::default() });
        Self { mesh, repairs, rig, turn: Mat4::IDENTITY, bounds: OnceLock::new() }
    }

    /// A pose of the mesh by a rig that is this model's but for its weights.
    pub fn pose(&self, rig: &Rig, animation: Option<&Animation>, seconds: f32) -> Pose {
        let mut pose = rig.pose(animation, seconds);
        for joint in &mut pose.joints {
            let turned = self.turn * Mat4::from_cols_array_2d(joint) * self.turn.inverse();
            *joint = turned.to_cols_array_2d();
        }
        pose
    }

    /// Corners of a box around the model as its file shows it.
    pub fn bounds(&self) -> Result<([f32; 3], [f32; 3]), Error> {
        if let Some(known) = self.bounds.get() {
            return Ok(*known);
        }
        let posed = rig::posed(&self.mesh, &self.pose(&self.rig, None, 0.0))?;
        let points = posed.into_iter().map(Vec3::from);
        let around = |(low, high): (Vec3, Vec3), p| (low.min(p), high.max(p));
        let (low, high) = points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), around);
        Ok(*self.bounds.get_or_init(|| (low.to_array(), high.to_array())))
    }

    /// From corner to corner of that box.
    pub fn diagonal(&self) -> Result<f32, Error> {
        let (low, high) = self.bounds()?;
        Ok(Vec3::from(low).distance(high.into()))
    }

    /// The model with one morph target, an egg or, if asked, a sphere; its own targets, skin and animations are gone.
    pub fn into_round(self, sphere: bool, watch: Watch<'_>) -> Result<Self, Error> {
        let mesh = Mesh { targets: Vec::new(), skin: None, ..self.mesh };
        let options = if sphere { EggOptions::SPHERE } else { EggOptions::default() };
        let laid = to_egg(&mesh, &options, watch)?;
        let figures = &laid.report;
        progress::tell(&format!(
            "{}: laid around {} in {:.2} s, {} holes filled, {} triangles flipped",
            mesh.name,
            if sphere { "a sphere" } else { "an egg" },
            figures.seconds,
            figures.holes_filled,
            figures.flipped
        ));
        Ok(Self::new(laid.mesh, self.repairs, None))
    }

    /// The model with its holes of up to so many edges closed.
    pub fn closed(self, max_edges: Option<usize>) -> Result<Self, Error> {
        if max_edges.is_none() {
            return Ok(self);
        }
        let options = RepairOptions { fill_holes: max_edges, ..RepairOptions::default() };
        let (mesh, repairs) = repair_with(self.mesh, &options)?;
        Ok(Self { mesh, repairs, bounds: OnceLock::new(), ..self })
    }

    /// Numbers and names of the animations, to choose from.
    pub fn animations(&self) -> String {
        let animations = self.rig.animations.iter().enumerate();
        let name = |(k, Animation { name, .. }): (usize, &Animation)| format!("{k} {name}").trim().to_owned();
        let names: Vec<_> = animations.map(name).collect();
        if names.is_empty() { "no animations".to_owned() } else { names.join(", ") }
    }

    /// Turns a model whose z axis points up, as CAD programs and scanners write them.
    pub fn turn_z_up(&mut self) {
        let Mesh { positions, normals, targets, .. } = &mut self.mesh;
        let deltas = targets.iter_mut().flat_map(|target| &mut target.position_deltas);
        for vector in positions.iter_mut().chain(normals).chain(deltas) {
            *vector = [vector[0], vector[2], -vector[1]];
        }
        self.bounds = OnceLock::new();
        self.turn = Mat4::from_rotation_x(-FRAC_PI_2);
    }
}

/// A built-in model by its name, else a file.
pub fn open(name: &str) -> Result<Model, Error> {
    if !Path::new(name).exists()
        && let Some(mesh) = builtin::builtin(name)
    {
        return clean(mesh);
    }
    open_file(Path::new(name), &|_| true)
}

/// A mesh file.
pub fn open_file(path: &Path, watch: Watch<'_>) -> Result<Model, Error> {
    #[cfg(not(target_arch = "wasm32"))]
    let loaded = load::load_with_progress(path, watch)?;
    #[cfg(target_arch = "wasm32")]
    let loaded = load::load_bytes(path, handed_over(path)?, watch)?;
    Ok(Model::new(loaded.mesh, loaded.repairs, loaded.rig))
}

#[cfg(target_arch = "wasm32")]
fn handed_over(path: &Path) -> Result<Vec<u8>, load::LoadError> {
    let file = path.display().to_string();
    crate::files::read(path).map_err(|error| load::LoadError::Read { file, reason: error.to_string() })
}

/// A mesh made here, through the same checks as one from a file.
pub fn clean(mesh: Mesh) -> Result<Model, Error> {
    let (mesh, repairs) = translume_mesh::repair::repair(mesh)?;
    Ok(Model::new(mesh, repairs, None))
}

/// Builds an atlas behind a progress bar.
pub fn unwrap(mesh: &Mesh, options: &AtlasOptions) -> Result<Atlas, Error> {
    Ok(progress::during("unwrap", |watch| Atlas::build(mesh, options, watch))?)
}
