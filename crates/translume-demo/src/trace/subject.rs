//! A scene as paths see it.

use crate::error::Error;
use crate::framing;
use crate::model::Model;
use crate::motion::{Motion, Wish};
use crate::render::DEFAULT_SIZE;
use crate::scene::{Scene, SceneCamera, Shape};
use std::path::Path;
use translume_reference::composite::Camera;
use translume_reference::path::{Ball, Block, Volume};
use translume_reference::{Light, Surface};

/// The angles from which a scene without a camera is seen, as those of `render`.
pub const VIEW: [f32; 2] = [14.0, 9.0];

/// A body with its lights and who looks at it, in millimetres.
pub struct Subject {
    pub body: Body,
    pub volume: Volume,
    pub lights: Vec<Light>,
    pub camera: Camera,
}

/// What paths run through.
pub enum Body {
    /// A closed surface.
    Mesh(Surface),
    /// An exact sphere.
    Ball(Ball),
    /// An exact box.
    Block(Block),
}

impl Subject {
    /// Reads a scene.
    pub fn from_scene(path: &Path, width: Option<u32>) -> Result<Self, Error> {
        let scene = Scene::read(path)?;
        let (model, is_flat) = scene.model(path)?;
        Self::new(&scene, &model, is_flat, width)
    }

    /// A scene whose model is known already. Spheres and boxes that nothing deforms are exact.
    pub fn new(scene: &Scene, model: &Model, is_flat: bool, width: Option<u32>) -> Result<Self, Error> {
        let mm_per_unit = f64::from(scene.length_unit.mm());
        let wish = scene.wish();
        let motion = Motion::new(model, &wish, 1)?;
        let body = exact(&scene.shape, &wish, mm_per_unit).unwrap_or_else(|| {
            let pose = motion.moment(0).pose;
            Body::Mesh(translume_twin::surface(&model.mesh, &pose, motion.warp, mm_per_unit, is_flat))
        });
        let seen = framing::Subject::new(motion.points()?);
        let camera = scene.camera.unwrap_or_else(|| seen.camera(DEFAULT_SIZE, VIEW));
        let camera = width.map_or(camera, |width| camera.resized(width));
        let lights = match &scene.lights {
            Some(lights) => {
                let just_below_y0 = -1e-4 * model.mesh.diagonal();
                let twins = lights.iter().map(|light| light.twins(just_below_y0, mm_per_unit));
                twins.collect::<Result<Vec<_>, _>>()?.concat()
            }
            None => {
                let lamps = seen.lamps(VIEW);
                lamps.iter().filter_map(|light| translume_twin::light(light, mm_per_unit)).collect()
            }
        };
        let g = scene.material.map_or(0.0, |material| f64::from(material.g));
        let medium = scene.medium()?.unwrap_or_default();
        Ok(Self {
            body,
            volume: Volume::new(&translume_twin::medium(&medium), g),
            lights,
            camera: in_mm(&camera, mm_per_unit),
        })
    }
}

fn exact(shape: &Shape, wish: &Wish, mm_per_unit: f64) -> Option<Body> {
    let mm = |p: [f32; 3]| p.map(|x| f64::from(x) * mm_per_unit);
    if wish.twist_deg != 0.0 || wish.bend_deg != 0.0 || wish.inflate != 0.0 {
        return None;
    }
    match *shape {
        Shape::Sphere { center, radius } => {
            Some(Body::Ball(Ball { center: mm(center), radius: f64::from(radius) * mm_per_unit }))
        }
        Shape::Box { min, max } => Some(Body::Block(Block { low: mm(min), high: mm(max) })),
        _ => None,
    }
}

fn in_mm(camera: &SceneCamera, mm_per_unit: f64) -> Camera {
    let mm = |p: [f32; 3]| p.map(|x| f64::from(x) * mm_per_unit);
    Camera {
        eye: mm(camera.eye),
        target: mm(camera.target),
        up: camera.up.map(f64::from),
        fov: f64::from(camera.fov_deg).to_radians(),
        width: camera.width as usize,
        height: camera.height as usize,
    }
}
