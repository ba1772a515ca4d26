//! The scene format: JSON, lengths in the unit it states, linear colours. Unknown fields and types are errors that name them.

mod lights;
mod quality;

pub use lights::SceneLight;
pub use quality::{Look, Quality, THETA, TOLERANCE};

use crate::error::Error;
use crate::files;
use crate::model;
use crate::motion::Wish;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use translume::Medium;
use translume_mesh::builtin;

/// A scene file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    #[serde(default, skip_serializing_if = "is_default")]
    pub name: String,
    #[serde(default, skip_serializing_if = "is_default")]
    pub purpose: String,
    /// "mm" (default), "cm" or "m".
    #[serde(default, skip_serializing_if = "is_default")]
    pub length_unit: LengthUnit,
    /// How long the unit is in millimetres, where it is none of those.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mm_per_unit: Option<f32>,
    pub shape: Shape,
    /// Which axis of the mesh points up.
    #[serde(default, skip_serializing_if = "is_default")]
    pub up: Up,
    /// What the mesh melts into: it takes the place of its own morph targets and skin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub into: Option<Round>,
    /// Coefficients in 1/mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<Material>,
    /// A preset by name instead of `material`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub medium: Option<String>,
    /// A PNG or JPEG on the mesh's own texture coordinates: how much of the light comes back.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub albedo: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lights: Option<Vec<SceneLight>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<SceneCamera>,
    /// Weight of each morph target.
    #[serde(default, skip_serializing_if = "is_default")]
    pub morph: Vec<f32>,
    #[serde(default, skip_serializing_if = "is_default")]
    pub warp: SceneWarp,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub animation: Option<SceneAnimation>,
    /// Seconds into the animation, the first one if none is named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<f32>,
    #[serde(default, skip_serializing_if = "is_default")]
    pub look: Look,
    #[serde(default, skip_serializing_if = "is_default")]
    pub quality: Quality,
}

pub(crate) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Up {
    #[default]
    Y,
    Z,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Round {
    Egg,
    Sphere,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SceneWarp {
    /// By how much the top turns against the bottom.
    pub twist_deg: f32,
    /// The arc that the upright axis becomes.
    pub bend_deg: f32,
    /// Outwards, in the scene's unit.
    pub inflate: f32,
}

/// An animation by name or by number from 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum SceneAnimation {
    Index(usize),
    Name(String),
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum LengthUnit {
    #[default]
    #[serde(rename = "mm")]
    Millimetre,
    #[serde(rename = "cm")]
    Centimetre,
    #[serde(rename = "m")]
    Metre,
}

impl LengthUnit {
    pub fn mm(self) -> f32 {
        match self {
            Self::Millimetre => 1.0,
            Self::Centimetre => 10.0,
            Self::Metre => 1000.0,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    Mesh {
        file: PathBuf,
        #[serde(default, skip_serializing_if = "is_default")]
        normals: Normals,
        /// Close holes of up to this many edges.
        #[serde(skip_serializing_if = "Option::is_none")]
        fill_holes: Option<usize>,
    },
    Sphere {
        center: [f32; 3],
        radius: f32,
    },
    Box {
        min: [f32; 3],
        max: [f32; 3],
    },
    Builtin {
        name: String,
        #[serde(default, skip_serializing_if = "is_default")]
        normals: Normals,
        #[serde(skip_serializing_if = "Option::is_none")]
        fill_holes: Option<usize>,
    },
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Normals {
    #[default]
    Smooth,
    Flat,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    pub sigma_s_prime: [f32; 3],
    pub sigma_a: [f32; 3],
    /// Mean cosine of the phase function, by which `sigma_s_prime` is already reduced.
    #[serde(default)]
    pub g: f32,
    #[serde(default = "one")]
    pub eta: f32,
}

fn one() -> f32 {
    1.0
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneCamera {
    pub eye: [f32; 3],
    pub target: [f32; 3],
    #[serde(default = "y_up")]
    pub up: [f32; 3],
    /// Full horizontal angle.
    pub fov_deg: f32,
    pub width: u32,
    pub height: u32,
}

fn y_up() -> [f32; 3] {
    [0.0, 1.0, 0.0]
}

impl Scene {
    /// Reads a scene file.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let fail = |problem: String| Error::Scene { path: path.to_owned(), problem };
        let text = files::read_to_string(path).map_err(|error| fail(format!("cannot be read: {error}")))?;
        Self::parse(&text, path)
    }

    /// A scene in words; `path` is where they stand, and where what they refer to is.
    pub fn parse(text: &str, path: &Path) -> Result<Self, Error> {
        let fail = |problem: String| Error::Scene { path: path.to_owned(), problem };
        let mut scene: Self =
            serde_json::from_str(text).map_err(|error| fail(format!("is not a scene: {error}")))?;
        if scene.material.is_some() && scene.medium.is_some() {
            return Err(fail("has both `material` and `medium`; keep one".to_owned()));
        }
        if scene.material.is_some_and(|material| !(-1.0..1.0).contains(&material.g)) {
            return Err(fail("material.g must lie between −1 and 1".to_owned()));
        }
        if let Some(camera) = &scene.camera {
            camera.validate().map_err(|problem| fail(format!("camera: {problem}")))?;
        }
        if let Some(mm) = scene.mm_per_unit.filter(|mm| !(*mm > 0.0 && mm.is_finite())) {
            return Err(fail(format!("mm_per_unit is {mm}, but must be finite and positive")));
        }
        let directory = path.parent().unwrap_or(Path::new(""));
        scene.lights.iter_mut().flatten().for_each(|light| light.find(directory));
        scene.albedo = scene.albedo.map(|file| directory.join(file));
        Ok(scene)
    }

    /// A model by name or file in jade, in the light that suits it.
    pub fn of_model(name: &str) -> Self {
        let shape = if !Path::new(name).exists() && builtin::NAMES.contains(&name) {
            Shape::Builtin { name: name.to_owned(), normals: Normals::Smooth, fill_holes: None }
        } else {
            Shape::Mesh { file: name.into(), normals: Normals::Smooth, fill_holes: None }
        };
        Self {
            name: name.to_owned(),
            purpose: String::new(),
            length_unit: LengthUnit::Millimetre,
            mm_per_unit: None,
            shape,
            up: Up::Y,
            into: None,
            material: None,
            medium: Some("jade".to_owned()),
            albedo: None,
            lights: None,
            camera: None,
            morph: Vec::new(),
            warp: SceneWarp::default(),
            animation: None,
            time: None,
            look: Look::default(),
            quality: Quality::default(),
        }
    }

    /// Millimetres per unit of the scene.
    pub fn mm_per_unit(&self) -> f32 {
        self.mm_per_unit.unwrap_or(self.length_unit.mm())
    }

    /// The scene's medium, if it says one.
    pub fn medium(&self) -> Result<Option<Medium>, Error> {
        if let Some(name) = &self.medium {
            return Ok(Some(Medium::preset(name)?));
        }
        Ok(self.material.map(|m| Medium {
            sigma_s_prime: m.sigma_s_prime,
            sigma_a: m.sigma_a,
            ior: m.eta,
            g: m.g,
        }))
    }

    /// How the scene's mesh is to be deformed.
    pub fn wish(&self) -> Wish {
        let SceneWarp { twist_deg, bend_deg, inflate } = self.warp;
        let animation = self.animation.as_ref().map(ToString::to_string);
        Wish { morph: self.morph.clone(), animation, time: self.time, twist_deg, bend_deg, inflate }
    }

    /// The scene's mesh, its path taken relative to the scene file at `path`, and whether its triangles keep their own normals. `progress` can cancel.
    pub fn model(&self, path: &Path, progress: model::Watch<'_>) -> Result<(model::Model, bool), Error> {
        let (mut model, is_flat) = self.mesh(path, progress)?;
        if self.up == Up::Z {
            model.turn_z_up();
        }
        if let Some(round) = self.into {
            model = model.into_round(round == Round::Sphere, progress)?;
        }
        Ok((model, is_flat))
    }

    fn mesh(&self, path: &Path, progress: model::Watch<'_>) -> Result<(model::Model, bool), Error> {
        match &self.shape {
            Shape::Mesh { file, normals, fill_holes } => {
                let file = self.shape.file(path).unwrap_or_else(|| file.clone());
                Ok((model::open_file(&file, progress)?.closed(*fill_holes)?, *normals == Normals::Flat))
            }
            // 20,480 triangles: no point of the surface is further than 0.02 % of the radius from the sphere.
            Shape::Sphere { center, radius } => {
                Ok((model::clean(builtin::sphere(*center, *radius, 5))?, false))
            }
            Shape::Box { min, max } => Ok((model::clean(builtin::cuboid(*min, *max, [8; 3]))?, false)),
            Shape::Builtin { name, normals, fill_holes } => {
                let mesh = builtin::builtin(name).ok_or_else(|| Error::Scene {
                    path: path.to_owned(),
                    problem: format!(
                        "no built-in is called \"{name}\"; known are {}",
                        builtin::NAMES.join(", ")
                    ),
                })?;
                Ok((model::clean(mesh)?.closed(*fill_holes)?, *normals == Normals::Flat))
            }
        }
    }
}

impl Shape {
    /// The file it is in, for a scene at `path`.
    pub fn file(&self, path: &Path) -> Option<PathBuf> {
        match self {
            Self::Mesh { file, .. } => Some(path.parent().unwrap_or(Path::new("")).join(file)),
            _ => None,
        }
    }
}

impl std::fmt::Display for SceneAnimation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Index(index) => index.fmt(f),
            Self::Name(name) => name.fmt(f),
        }
    }
}

impl SceneCamera {
    /// With so many pixels across, and as many down as its shape asks for.
    pub fn resized(self, width: u32) -> Self {
        let height = (f64::from(width) * f64::from(self.height) / f64::from(self.width)).round() as u32;
        Self { width, height: height.max(1), ..self }
    }

    fn validate(&self) -> Result<(), String> {
        let sight: [f32; 3] = std::array::from_fn(|k| self.target[k] - self.eye[k]);
        let side = glam::Vec3::from(sight).cross(self.up.into());
        if !side.is_finite() || side.length_squared() == 0.0 {
            return Err("eye, target and up must be finite, apart, and not in one line".to_owned());
        }
        if !(self.fov_deg > 0.0 && self.fov_deg < 180.0) {
            return Err(format!("fov_deg is {}, but must lie between 0 and 180", self.fov_deg));
        }
        if self.width == 0 || self.height == 0 {
            return Err(format!("the picture is {} × {} pixels", self.width, self.height));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Scene, Error> {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("scene.json");
        std::fs::write(&path, text).unwrap();
        Scene::read(&path)
    }

    const SPHERE: &str = r#""shape": { "type": "sphere", "center": [0, 0, 0], "radius": 10 }"#;

    #[test]
    fn the_least_scene_is_a_shape() {
        let scene = read(&format!("{{ {SPHERE} }}")).unwrap();
        assert!(scene.lights.is_none() && scene.camera.is_none() && scene.medium().unwrap().is_none());
    }

    #[test]
    fn what_is_unknown_is_named() {
        let cases = [
            (format!(r#"{{ {SPHERE}, "colour": 3 }}"#), "colour"),
            (r#"{ "shape": { "type": "pyramid" } }"#.to_owned(), "pyramid"),
            (format!(r#"{{ {SPHERE}, "lights": [{{ "type": "laser" }}] }}"#), "laser"),
            (
                format!(
                    r#"{{ {SPHERE}, "lights": [{{ "type": "constant_env", "radiance": [1,1,1], "tint": 1 }}] }}"#
                ),
                "tint",
            ),
            (format!(r#"{{ {SPHERE}, "length_unit": "inch" }}"#), "inch"),
        ];
        for (text, name) in cases {
            let message = read(&text).unwrap_err().to_string();
            assert!(message.contains(name) && message.contains("scene.json"), "{message}");
        }
    }

    #[test]
    fn a_camera_without_direction_is_refused() {
        let camera =
            r#""camera": { "eye": [0,0,0], "target": [0,0,0], "fov_deg": 20, "width": 8, "height": 8 }"#;
        assert!(read(&format!("{{ {SPHERE}, {camera} }}")).unwrap_err().to_string().contains("camera"));
    }
}
