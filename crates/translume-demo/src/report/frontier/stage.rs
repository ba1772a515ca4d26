//! A scene, ready for every method: its body as it stands, its lights, its camera.

use super::scenes::Source;
use crate::error::Error;
use crate::framing::Subject;
use crate::model::{self, Model};
use crate::motion::Motion;
use crate::scene::{Scene, SceneCamera};
use crate::setup::{Opened, VIEW};
use crate::trace;
use translume::{Camera, Light, Medium};
use translume_mesh::rig::Pose;
use translume_mesh::{Atlas, AtlasOptions, Warp};
use translume_reference::Surface;

/// What is measured.
pub struct Stage {
    pub name: String,
    pub purpose: String,
    pub model: Model,
    pub flat_normals: bool,
    pub medium: Medium,
    pub mm_per_unit: f32,
    pub lights: Vec<Light>,
    pub pose: Pose,
    pub warp: Warp,
    pub camera: SceneCamera,
    /// The same for the library.
    pub look: Camera,
    /// Corners of a box around it, units of the scene.
    pub bounds: ([f32; 3], [f32; 3]),
    /// The same for paths.
    pub paths: trace::Subject,
}

/// Width of the picture of a scene that has no camera.
const SIZE: u32 = 96;

impl Stage {
    pub fn open(source: &Source) -> Result<Self, Error> {
        let (scene, path) = source.scene()?;
        Self::new(source.name(), &scene, &path)
    }

    fn new(name: String, scene: &Scene, path: &std::path::Path) -> Result<Self, Error> {
        let opened = Opened::new(scene, path, &|_| true)?;
        let (pose, warp, subject) = {
            let motion = Motion::new(&opened.model, &scene.wish(), 1)?;
            (motion.moment(0).pose, motion.warp, Subject::new(motion.points()?))
        };
        let lights = opened.lights(scene, &subject, VIEW)?;
        let camera = scene.camera.unwrap_or_else(|| subject.camera(SIZE, VIEW));
        Ok(Self {
            name,
            purpose: scene.purpose.clone(),
            medium: scene.medium()?.unwrap_or_default(),
            mm_per_unit: scene.mm_per_unit(),
            look: subject.look(&camera),
            bounds: subject.bounds(),
            paths: trace::Subject::new(scene, &opened, None)?,
            model: opened.model,
            flat_normals: opened.flat_normals,
            lights,
            pose,
            warp,
            camera,
        })
    }

    pub fn atlas(&self, size: u32) -> Result<Atlas, Error> {
        model::unwrap(&self.model.mesh, &AtlasOptions { size, ..Default::default() })
    }

    /// The surface as it is shaded, mm.
    pub fn surface(&self) -> Surface {
        let mm = f64::from(self.mm_per_unit);
        translume_twin::surface(&self.model.mesh, &self.pose, self.warp, mm, self.flat_normals)
    }

    pub fn pixels(&self) -> [u32; 2] {
        [self.camera.width, self.camera.height]
    }
}
