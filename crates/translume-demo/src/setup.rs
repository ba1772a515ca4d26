//! From a scene to what the library takes.

use crate::error::Error;
use crate::framing::Subject;
use crate::model::{Model, Watch};
use crate::motion::Motion;
use crate::scene::{Scene, SceneCamera, SceneLight};
use std::path::Path;
use translume::{BodyDescriptor, Evaluate, Light, Medium, Method, Profile, ShadowOptions, Transport};
use translume_mesh::{Atlas, Mesh};

/// Width of a picture whose scene has no camera.
pub const DEFAULT_SIZE: u32 = 768;
/// Without units a model is taken to be as large as something held in a hand.
pub const ASSUMED_DIAGONAL_MM: f32 = 100.0;
/// Wax without a highlight looks dead.
pub const DEFAULT_ROUGHNESS: f32 = 0.35;
/// From where a scene without a camera is seen: degrees to the right of the front and upwards.
pub const VIEW: [f32; 2] = [14.0, 9.0];

/// A model as a scene names it.
pub struct Opened {
    pub model: Model,
    pub flat_normals: bool,
}

impl Opened {
    /// Reads the model of a scene at `path`.
    pub fn new(scene: &Scene, path: &Path, watch: Watch<'_>) -> Result<Self, Error> {
        let (model, flat_normals) = scene.model(path, watch)?;
        Ok(Self { model, flat_normals })
    }

    /// Height that still counts as the face y = 0.
    pub fn just_below_y0(&self) -> f32 {
        -1e-4 * self.model.mesh.diagonal()
    }

    /// Where the surface is.
    pub fn subject(&self, scene: &Scene) -> Result<Subject, Error> {
        Ok(Subject::new(Motion::new(&self.model, &scene.wish(), 1)?.points()?))
    }

    /// The scene's lights, or ones that suit it seen from `view`.
    pub fn lights(&self, scene: &Scene, subject: &Subject, view: [f32; 2]) -> Result<Vec<Light>, Error> {
        let own;
        let lights = match &scene.lights {
            Some(lights) => lights,
            None => {
                own = subject.lamps(view);
                &own
            }
        };
        library_lights(lights, self.just_below_y0())
    }
}

pub fn library_lights(lights: &[SceneLight], just_below_y0: f32) -> Result<Vec<Light>, Error> {
    let all = lights.iter().map(|light| light.lights(just_below_y0)).collect::<Result<Vec<_>, _>>()?;
    Ok(all.concat())
}

/// The scene's camera, or one that sees all of the subject from `view`.
pub fn camera(scene: &Scene, subject: &Subject, view: [f32; 2]) -> SceneCamera {
    scene.camera.unwrap_or_else(|| subject.camera(DEFAULT_SIZE, view))
}

/// What of a scene a body is made of, besides its mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Substance {
    pub medium: Medium,
    pub profile: Profile,
    pub transport: Transport,
    pub method: Method,
    pub evaluate: Evaluate,
    pub shadows: ShadowOptions,
    pub mm_per_unit: f32,
}

impl Substance {
    /// Of a scene in `directory`.
    pub fn new(scene: &Scene, directory: &Path) -> Result<Self, Error> {
        let quality = &scene.quality;
        Ok(Self {
            medium: scene.medium()?.unwrap_or_default(),
            profile: quality.profile(directory)?,
            transport: quality.transport()?,
            method: quality.method()?,
            evaluate: quality.evaluate()?,
            shadows: quality.shadows(),
            mm_per_unit: scene.mm_per_unit(),
        })
    }

    /// Whether a body of one becomes a body of the other by another medium and other shadows.
    pub fn is_like(&self, other: &Self) -> bool {
        let Self { profile, transport, method, evaluate, mm_per_unit, .. } = other;
        (&self.profile, &self.transport, &self.method, &self.evaluate, &self.mm_per_unit)
            == (profile, transport, method, evaluate, mm_per_unit)
    }

    pub fn descriptor<'a>(&self, mesh: &'a Mesh, atlas: &'a Atlas, flat_normals: bool) -> BodyDescriptor<'a> {
        BodyDescriptor {
            medium: self.medium,
            profile: self.profile.clone(),
            transport: self.transport,
            method: self.method,
            evaluate: self.evaluate,
            mm_per_unit: self.mm_per_unit,
            flat_normals,
            shadows: self.shadows,
            ..BodyDescriptor::new(mesh, atlas)
        }
    }
}
