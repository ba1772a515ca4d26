//! A scene, ready for every method: its body as it stands, its lights, its camera.

use super::scenes::Source;
use crate::error::Error;
use crate::framing::Subject;
use crate::model::{self, Model};
use crate::motion::Motion;
use crate::scene::{Scene, SceneCamera, Shape};
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
    /// Mean cosine of the phase function; the medium's scattering is reduced by it already.
    pub g: f32,
    pub mm_per_unit: f32,
    pub lights: Vec<Light>,
    pub pose: Pose,
    pub warp: Warp,
    pub camera: SceneCamera,
    /// The same for the library.
    pub look: Camera,
    /// Corners of a box around it, units of the scene.
    pub bounds: ([f32; 3], [f32; 3]),
    /// The exact shape, where the scene states one.
    pub exact: Option<Shape>,
}

/// Width of the picture of a scene that has no camera.
const SIZE: u32 = 96;

impl Stage {
    pub fn open(source: &Source) -> Result<Self, Error> {
        let (scene, path) = source.scene()?;
        Self::new(source.name(), scene, &path)
    }

    fn new(name: String, scene: Scene, path: &std::path::Path) -> Result<Self, Error> {
        let (model, flat_normals) = scene.model(path)?;
        let just_below_y0 = -1e-4 * model.mesh.diagonal();
        let mut lights = Vec::new();
        for light in scene.lights.iter().flatten() {
            lights.extend(light.lights(just_below_y0)?);
        }
        let (pose, warp, subject) = {
            let motion = Motion::new(&model, &scene.wish(), 1)?;
            (motion.moment(0).pose, motion.warp, Subject::new(motion.points()?))
        };
        if scene.lights.is_none() {
            lights = subject.lamps([0.0; 2]);
        }
        let camera = scene.camera.unwrap_or_else(|| subject.camera(SIZE, [14.0, 9.0]));
        let exact = matches!(scene.shape, Shape::Sphere { .. } | Shape::Box { .. });
        Ok(Self {
            name,
            purpose: scene.purpose.clone(),
            medium: scene.medium()?.unwrap_or_default(),
            g: scene.material.map_or(0.0, |material| material.g),
            mm_per_unit: scene.length_unit.mm(),
            look: subject.look(&camera),
            bounds: subject.bounds(),
            exact: exact.then(|| scene.shape.clone()),
            model,
            flat_normals,
            lights,
            pose,
            warp,
            camera,
        })
    }

    pub fn atlas(&self, size: u32) -> Result<Atlas, Error> {
        model::unwrap(&self.model.mesh, &AtlasOptions { size, ..Default::default() })
    }

    pub fn surface(&self) -> Surface {
        let mm = f64::from(self.mm_per_unit);
        translume_twin::surface(&self.model.mesh, &self.pose, self.warp, mm, self.flat_normals)
    }

    /// Lights that rays know.
    pub fn twin_lights(&self) -> Vec<translume_reference::Light> {
        let mm = f64::from(self.mm_per_unit);
        self.lights.iter().filter_map(|light| translume_twin::light(light, mm)).collect()
    }

    pub fn twin_camera(&self) -> translume_reference::composite::Camera {
        let SceneCamera { eye, target, up, fov_deg, width, height } = self.camera;
        let mm = |p: [f32; 3]| p.map(|x| f64::from(x) * f64::from(self.mm_per_unit));
        translume_reference::composite::Camera {
            eye: mm(eye),
            target: mm(target),
            up: up.map(f64::from),
            fov: f64::from(fov_deg).to_radians(),
            width: width as usize,
            height: height as usize,
        }
    }

    pub fn pixels(&self) -> [u32; 2] {
        [self.camera.width, self.camera.height]
    }
}
