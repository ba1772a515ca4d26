//! A scene as paths see it.

use crate::error::Error;
use crate::framing;
use crate::motion::{Motion, Wish};
use crate::progress;
use crate::scene::{Scene, SceneCamera, Shape, Up};
use crate::setup::{Opened, VIEW, camera};
use std::path::Path;
use translume_reference::composite::Camera;
use translume_reference::path::{Ball, Block, Volume};
use translume_reference::{Light, Surface};

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
        let opened = progress::during("load", |watch| Opened::new(&scene, path, watch))?;
        Self::new(&scene, &opened, width)
    }

    /// A scene whose model is known already. Spheres and boxes that nothing deforms are exact.
    pub fn new(scene: &Scene, opened: &Opened, width: Option<u32>) -> Result<Self, Error> {
        let Opened { model, flat_normals } = opened;
        if let Some(path) = scene.albedo.clone() {
            let problem = "paths of light know no albedo texture; remove `albedo` from the scene".to_owned();
            return Err(Error::Texture { path, problem });
        }
        let mm_per_unit = f64::from(scene.mm_per_unit());
        let wish = scene.wish();
        let motion = Motion::new(model, &wish, 1)?;
        let body = exact(scene, &wish, mm_per_unit).unwrap_or_else(|| {
            let pose = motion.moment(0).pose;
            Body::Mesh(translume_twin::surface(&model.mesh, &pose, motion.warp, mm_per_unit, *flat_normals))
        });
        let seen = framing::Subject::new(motion.points()?);
        let camera = camera(scene, &seen, VIEW);
        let camera = width.map_or(camera, |width| camera.resized(width));
        let lamps = scene.lights.clone().unwrap_or_else(|| seen.lamps(VIEW));
        let twins = lamps.iter().map(|light| light.twins(opened.just_below_y0(), mm_per_unit));
        let lights = twins.collect::<Result<Vec<_>, _>>()?.concat();
        let medium = scene.medium()?.unwrap_or_default();
        Ok(Self {
            body,
            volume: Volume::new(&translume_twin::medium(&medium), medium.g.into()),
            lights,
            camera: in_mm(&camera, mm_per_unit),
        })
    }
}

fn exact(scene: &Scene, wish: &Wish, mm_per_unit: f64) -> Option<Body> {
    let mm = |p: [f32; 3]| p.map(|x| f64::from(x) * mm_per_unit);
    let is_warped = wish.twist_deg != 0.0 || wish.bend_deg != 0.0 || wish.inflate != 0.0;
    if is_warped || scene.into.is_some() || scene.up != Up::Y {
        return None;
    }
    match scene.shape {
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
