//! `translume render`: a model or a scene becomes a picture.

use crate::cli::Render;
use crate::error::Error;
use crate::gpu::Gpu;
use crate::picture::{Develop, Format, Output};
use crate::scene::{Scene, SceneCamera};
use crate::studio::Studio;
use crate::{model, progress};
use glam::{Mat4, Vec3};
use std::f32::consts::TAU;
use std::path::Path;
use std::time::Instant;
use translume::{
    AmbientLight, BodyDescriptor, Camera, Deformation, DirectionalLight, Frame, Gloss, Light, Lighting,
    LookAt, Medium, Method, PointLight, Profile,
};
use translume_mesh::Mesh;

/// Everything a picture needs, in the units of the scene.
struct Setup {
    model: model::Model,
    flat_normals: bool,
    medium: Medium,
    mm_per_unit: f32,
    lights: Vec<Light>,
    camera: SceneCamera,
    morph: Vec<f32>,
    gloss: Gloss,
}

/// Without units a model is taken to be as large as something held in a hand.
const ASSUMED_DIAGONAL_MM: f32 = 100.0;
const DEFAULT_SIZE: u32 = 768;
/// Wax without a highlight looks dead.
const DEFAULT_ROUGHNESS: f32 = 0.35;

pub fn run(arguments: &Render) -> Result<(), Error> {
    let output = Output::new(&arguments.output)?;
    if arguments.frames > 1 && output.format != Format::Png {
        return Err(Error::Option { option: "--frames", problem: "only a PNG can be animated".to_owned() });
    }
    let profile = Profile::named(&arguments.profile)?;
    let method = method(arguments)?;
    let gpu = Gpu::new()?;
    let options = model::atlas_options(&arguments.layout)?;
    check_atlas(options.size, &gpu)?;
    let setup = match &arguments.scene {
        Some(path) => from_scene(path, arguments)?,
        None => from_model(arguments.model.as_deref().unwrap_or_default(), arguments)?,
    };
    let mesh = &setup.model.mesh;
    let start = Instant::now();
    let atlas = model::unwrap(mesh, &options)?;
    let unwrapped = start.elapsed().as_secs_f32();

    let descriptor = BodyDescriptor {
        medium: setup.medium,
        profile,
        method,
        mm_per_unit: setup.mm_per_unit,
        flat_normals: setup.flat_normals,
        shadow_resolution: arguments.shadow,
        ..BodyDescriptor::new(mesh, &atlas)
    };
    let samples = arguments.samples.unwrap_or(match output.format {
        Format::Png => 2,
        Format::Exr => 1,
    });
    let mut studio = Studio::new(gpu, &descriptor, setup.camera.width, setup.camera.height, samples)?;
    let camera = camera(&setup);
    let develop = match output.format {
        Format::Png => Develop::Display { exposure: arguments.exposure },
        Format::Exr => Develop::Radiance,
    };
    let bar = progress::bar("render");
    bar.set_length(arguments.frames.into());
    let start = Instant::now();
    let mut frames = Vec::new();
    for k in 0..arguments.frames {
        let (model, weights) = pose(&setup, k, arguments.frames);
        let frame = Frame {
            model: model.to_cols_array_2d(),
            deformation: Deformation::Morph(&weights),
            lighting: Lighting::Lights(&setup.lights),
        };
        frames.push(studio.take(&frame, &camera, setup.gloss, develop)?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let rendered = start.elapsed().as_secs_f32();
    output.write(&frames)?;
    progress::tell(&format!(
        "{}: {} triangles, 1 unit = {} mm, {} texels in {} charts; unwrapped in {unwrapped:.2} s, rendered in {rendered:.2} s on {}",
        mesh.name,
        mesh.triangles.len(),
        setup.mm_per_unit,
        atlas.texels.len(),
        atlas.report.charts,
        studio.adapter(),
    ));
    Ok(())
}

fn method(arguments: &Render) -> Result<Method, Error> {
    match arguments.method.as_str() {
        "tree" => Ok(Method::Tree { theta: arguments.theta }),
        "all-pairs" => Ok(Method::AllPairs),
        other => Err(Error::Option {
            option: "--method",
            problem: format!("no method is called \"{other}\"; known are tree, all-pairs"),
        }),
    }
}

/// Fails before the unwrapping rather than after.
fn check_atlas(size: u32, gpu: &Gpu) -> Result<(), Error> {
    let limit = translume::largest_atlas(&gpu.device.limits());
    if size <= limit {
        return Ok(());
    }
    let problem = format!("{size} texels exceed what {} can hold; choose at most {limit}", gpu.adapter);
    Err(Error::Option { option: "--atlas", problem })
}

fn from_scene(path: &Path, arguments: &Render) -> Result<Setup, Error> {
    let scene = Scene::read(path)?;
    let (model, flat_normals) = scene.model(path)?;
    let mesh = &model.mesh;
    let mm_per_unit = arguments.mm_per_unit.unwrap_or(scene.length_unit.mm());
    let mut camera = scene.camera.unwrap_or_else(|| frame_all(mesh, DEFAULT_SIZE, arguments.view));
    if let Some(width) = arguments.size {
        let height = (f64::from(width) * f64::from(camera.height) / f64::from(camera.width)).round() as u32;
        (camera.width, camera.height) = (width, height.max(1));
    }
    let lights = match &scene.lights {
        Some(lights) => lights.iter().map(|light| light.light(-1e-4 * mesh.diagonal())).collect(),
        None => key_and_fill(mesh, arguments.view),
    };
    let medium = match &arguments.medium {
        Some(name) => Medium::preset(name)?,
        None => scene.medium()?.unwrap_or_default(),
    };
    let morph =
        morph_weights(if arguments.morph.is_empty() { &scene.morph } else { &arguments.morph }, mesh)?;
    let gloss = gloss(arguments.gloss.unwrap_or(0.0))?;
    Ok(Setup { model, flat_normals, medium, mm_per_unit, lights, camera, morph, gloss })
}

fn from_model(name: &str, arguments: &Render) -> Result<Setup, Error> {
    let medium = arguments.medium.as_deref().map(Medium::preset).transpose()?.unwrap_or(Medium::JADE);
    let mut model = model::open(name)?;
    if arguments.up == "z" {
        model::turn_z_up(&mut model.mesh);
    }
    let mesh = &model.mesh;
    Ok(Setup {
        flat_normals: false,
        medium,
        mm_per_unit: arguments.mm_per_unit.unwrap_or(ASSUMED_DIAGONAL_MM / mesh.diagonal()),
        lights: key_and_fill(mesh, arguments.view),
        camera: frame_all(mesh, arguments.size.unwrap_or(DEFAULT_SIZE), arguments.view),
        morph: morph_weights(&arguments.morph, mesh)?,
        gloss: gloss(arguments.gloss.unwrap_or(DEFAULT_ROUGHNESS))?,
        model,
    })
}

fn morph_weights(given: &[f32], mesh: &Mesh) -> Result<Vec<f32>, Error> {
    if given.len() > mesh.targets.len() {
        let problem =
            format!("{} weights, but {} has {} morph targets", given.len(), mesh.name, mesh.targets.len());
        return Err(Error::Option { option: "--morph", problem });
    }
    let mut weights = given.to_vec();
    weights.resize(mesh.targets.len(), 0.0);
    Ok(weights)
}

/// Middle and radius of a sphere around the mesh.
fn bounding_sphere(mesh: &Mesh) -> (Vec3, f32) {
    let (low, high) = mesh.bounds().unwrap_or_default();
    ((Vec3::from(low) + Vec3::from(high)) * 0.5, 0.5 * mesh.diagonal())
}

fn gloss(roughness: f32) -> Result<Gloss, Error> {
    match roughness {
        0.0 => Ok(Gloss::None),
        _ if (0.03..=1.0).contains(&roughness) => Ok(Gloss::Rough(roughness)),
        _ => Err(Error::Option {
            option: "--gloss",
            problem: format!("{roughness} is neither 0 nor between 0.03 and 1"),
        }),
    }
}

/// From the object towards a camera at these degrees, and the frame around that direction turned with it.
fn turned(view: [f32; 2], v: Vec3) -> Vec3 {
    let [yaw, pitch] = view.map(f32::to_radians);
    Mat4::from_rotation_y(yaw).transform_vector3(Mat4::from_rotation_x(-pitch).transform_vector3(v))
}

/// The whole object in the picture, at rest and at each morph target.
fn frame_all(mesh: &Mesh, size: u32, view: [f32; 2]) -> SceneCamera {
    const FOV_DEG: f32 = 26.0;
    const FILLED: f32 = 0.86;
    let (middle, _) = bounding_sphere(mesh);
    let tangent = FILLED * (0.5 * FOV_DEG.to_radians()).tan();
    let [right, up, back] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| turned(view, axis));
    let rest = mesh.positions.iter().copied().map(Vec3::from);
    let posed = mesh.targets.iter().flat_map(|target| mesh.positions.iter().zip(&target.position_deltas));
    let distance =
        rest.chain(posed.map(|(p, d)| Vec3::from(*p) + Vec3::from(*d))).fold(0.0, |distance: f32, point| {
            let offset = point - middle;
            distance.max(offset.dot(right).abs().max(offset.dot(up).abs()) / tangent + offset.dot(back))
        });
    SceneCamera {
        eye: (middle + back * distance).to_array(),
        target: middle.to_array(),
        up: up.to_array(),
        fov_deg: FOV_DEG,
        width: size,
        height: size,
    }
}

/// Seen from the camera: a lamp behind that shines through what is thin, a key from the upper right, and a little sky.
fn key_and_fill(mesh: &Mesh, view: [f32; 2]) -> Vec<Light> {
    let (middle, radius) = bounding_sphere(mesh);
    let lamp = turned([view[0], 0.0], Vec3::new(-0.75, 1.1, -1.5)) * radius * 1.5;
    vec![
        Light::Point(PointLight {
            position: (middle + lamp).to_array(),
            intensity: [7.5, 6.9, 6.0].map(|c| c * lamp.length_squared()),
            ..Default::default()
        }),
        Light::Directional(DirectionalLight {
            to_light: turned([view[0], 0.0], Vec3::new(0.9, 0.9, 0.75)).to_array(),
            irradiance: [1.5, 1.6, 1.75],
            ..Default::default()
        }),
        Light::Ambient(AmbientLight { radiance: [0.08, 0.09, 0.11], ..Default::default() }),
    ]
}

fn camera(setup: &Setup) -> Camera {
    let (middle, radius) = bounding_sphere(&setup.model.mesh);
    let distance = middle.distance(setup.camera.eye.into());
    // A morph may double the size of a body; the depth range has room for it.
    LookAt {
        eye: setup.camera.eye,
        target: setup.camera.target,
        up: setup.camera.up,
        horizontal_fov: setup.camera.fov_deg.to_radians(),
        aspect: setup.camera.width as f32 / setup.camera.height as f32,
        near: (distance - 2.0 * radius).max(0.01 * radius),
        far: distance + 2.0 * radius,
    }
    .into()
}

/// Frame k of an animation: through the first morph target and back, or once around the upright axis.
fn pose(setup: &Setup, k: u32, frames: u32) -> (Mat4, Vec<f32>) {
    let mut weights = setup.morph.clone();
    if frames < 2 {
        return (Mat4::IDENTITY, weights);
    }
    let turn = TAU * k as f32 / frames as f32;
    if let Some(weight) = weights.first_mut() {
        *weight = 0.5 - 0.5 * turn.cos();
        return (Mat4::IDENTITY, weights);
    }
    let (middle, _) = bounding_sphere(&setup.model.mesh);
    (Mat4::from_translation(middle) * Mat4::from_rotation_y(turn) * Mat4::from_translation(-middle), weights)
}
