//! `translume render`: a model or a scene becomes a picture.

use crate::cli::Render;
use crate::environment::Environment;
use crate::error::Error;
use crate::framing::Subject;
use crate::gpu::Gpu;
use crate::motion::{Motion, Wish};
use crate::picture::{Develop, Format, Output};
use crate::scene::{Scene, SceneCamera, SceneLight};
use crate::studio::Studio;
use crate::timings::table;
use crate::{model, profile, progress};
use std::path::Path;
use std::time::Instant;
use translume::{
    BodyDescriptor, Evaluate, Frame, Gloss, Light, Lighting, Medium, Method, ShadowOptions, View,
};

/// Everything a picture needs, in the units of the scene.
struct Setup {
    model: model::Model,
    flat_normals: bool,
    medium: Medium,
    mm_per_unit: f32,
    /// `None` for lamps that suit the subject.
    lights: Option<Vec<SceneLight>>,
    /// `None` for one that sees all of the subject.
    camera: Option<SceneCamera>,
    wish: Wish,
    gloss: Gloss,
}

/// Without units a model is taken to be as large as something held in a hand.
const ASSUMED_DIAGONAL_MM: f32 = 100.0;
pub const DEFAULT_SIZE: u32 = 768;
/// Wax without a highlight looks dead.
const DEFAULT_ROUGHNESS: f32 = 0.35;

pub fn run(arguments: &Render) -> Result<(), Error> {
    let mut output = Output::new(&arguments.output)?;
    if arguments.frames > 1 && output.format != Format::Png {
        return Err(Error::Option { option: "--frames", problem: "only a PNG can be animated".to_owned() });
    }
    let profile = profile::open(&arguments.profile)?;
    let method = method(arguments)?;
    let evaluate = evaluate(arguments)?;
    let gpu = Gpu::new()?;
    let options = model::atlas_options(&arguments.layout, arguments.even)?;
    check_atlas(options.size, &gpu)?;
    let setup = match &arguments.scene {
        Some(path) => from_scene(path, arguments)?,
        None => from_model(arguments.model.as_deref().unwrap_or_default(), arguments)?,
    };
    let mesh = &setup.model.mesh;
    let motion =
        Motion::new(&setup.model, &setup.wish, arguments.frames).map_err(|error| blame(error, arguments))?;
    output.frame_seconds = motion.frame_seconds().unwrap_or(output.frame_seconds);
    let subject = Subject::new(motion.points()?);
    let camera = sized(setup.camera, &subject, arguments);
    let lights = match &setup.lights {
        Some(lights) => library_lights(lights, -1e-4 * mesh.diagonal())?,
        None => subject.lamps(arguments.view),
    };
    let start = Instant::now();
    let atlas = model::unwrap(mesh, &options)?;
    let unwrapped = start.elapsed().as_secs_f32();

    let descriptor = BodyDescriptor {
        medium: setup.medium,
        profile,
        method,
        evaluate,
        mm_per_unit: setup.mm_per_unit,
        flat_normals: setup.flat_normals,
        shadows: ShadowOptions {
            resolution: arguments.shadow,
            directions: arguments.directions,
            ..Default::default()
        },
        ..BodyDescriptor::new(mesh, &atlas)
    };
    let samples = arguments.samples.unwrap_or(match output.format {
        Format::Png => 2,
        Format::Exr => 1,
    });
    let mut studio = Studio::new(gpu, &descriptor, camera.width, camera.height, samples)?;
    studio.set_timings(arguments.timings);
    let camera = subject.look(&camera);
    let develop = match output.format {
        Format::Png => Develop::Display { exposure: arguments.exposure },
        Format::Exr => Develop::Radiance,
    };
    let bar = progress::bar("render");
    bar.set_length(arguments.frames.into());
    let start = Instant::now();
    let (mut frames, mut timings) = (Vec::new(), Vec::new());
    for k in 0..arguments.frames {
        let moment = motion.moment(k);
        let frame = Frame {
            model: moment.model.to_cols_array_2d(),
            deformation: (&moment.pose).into(),
            warp: motion.warp,
            lighting: Lighting::Lights(&lights),
            casters: None,
            view: Some(View { camera, pixels: studio.pixels() }),
        };
        frames.push(studio.take(&frame, &camera, setup.gloss, develop)?);
        timings.extend(studio.timings());
        bar.inc(1);
    }
    bar.finish_and_clear();
    let rendered = start.elapsed().as_secs_f32();
    output.write(&frames)?;
    if arguments.timings {
        progress::print(&table(&timings));
    }
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
    let name = arguments.method.as_str();
    let fail = |option, problem| Err(Error::Option { option, problem });
    if arguments.tolerance.is_some() && name != "dual" {
        return fail("--tolerance", format!("{name} has none; only dual keeps a tolerance"));
    }
    if arguments.theta.is_some() && !matches!(name, "dual" | "tree") {
        return fail("--theta", format!("{name} has no opening angle; dual and tree have"));
    }
    let tolerance = arguments.tolerance.unwrap_or(0.01);
    if !(0.0001..=0.1).contains(&tolerance) {
        return fail("--tolerance", format!("{tolerance} is not between 0.0001 and 0.1"));
    }
    if let Some(theta) = arguments.theta.filter(|theta| !(0.05..=2.0).contains(theta)) {
        return fail("--theta", format!("{theta} is not between 0.05 and 2"));
    }
    match (name, arguments.theta) {
        ("dual", None) => Ok(Method::Within { tolerance }),
        ("dual", Some(theta)) => Ok(Method::Dual { theta }),
        ("tree", theta) => Ok(Method::Tree { theta: theta.unwrap_or(0.4) }),
        ("all-pairs", _) => Ok(Method::AllPairs),
        ("pattern", _) => Ok(Method::Pattern),
        (other, _) => fail(
            "--method",
            format!("no method is called \"{other}\"; known are dual, tree, all-pairs, pattern"),
        ),
    }
}

fn evaluate(arguments: &Render) -> Result<Evaluate, Error> {
    let name = arguments.evaluate.as_str();
    let fail = |problem| Err(Error::Option { option: "--evaluate", problem });
    match Evaluate::NAMES.iter().find(|(known, _)| *known == name) {
        None => fail(format!("\"{name}\" is no place; known are texel, vertex, fragment, auto")),
        Some((_, Evaluate::PerVertex | Evaluate::PerFragment)) if arguments.method != "dual" => {
            fail(format!("{} is evaluated at texels alone; use dual", arguments.method))
        }
        Some((_, evaluate)) => Ok(*evaluate),
    }
}

/// Fails before the unwrapping rather than after.
pub fn check_atlas(size: u32, gpu: &Gpu) -> Result<(), Error> {
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
    let medium = match &arguments.medium {
        Some(name) => Medium::preset(name)?,
        None => scene.medium()?.unwrap_or_default(),
    };
    Ok(Setup {
        model,
        flat_normals,
        medium,
        mm_per_unit: arguments.mm_per_unit.unwrap_or(scene.length_unit.mm()),
        wish: overridden(scene.wish(), arguments),
        lights: environment(arguments).or(scene.lights),
        camera: scene.camera,
        gloss: gloss(arguments.gloss.unwrap_or(0.0))?,
    })
}

fn from_model(name: &str, arguments: &Render) -> Result<Setup, Error> {
    let medium = arguments.medium.as_deref().map(Medium::preset).transpose()?.unwrap_or(Medium::JADE);
    let mut model = model::open(name)?;
    if arguments.up == "z" {
        model.turn_z_up();
    }
    if let Some(shape) = &arguments.into {
        model = model.into_round(shape == "sphere")?;
    }
    let mm_per_unit = match arguments.mm_per_unit {
        Some(mm_per_unit) => mm_per_unit,
        None => ASSUMED_DIAGONAL_MM / model.diagonal()?,
    };
    Ok(Setup {
        flat_normals: false,
        medium,
        mm_per_unit,
        lights: environment(arguments),
        camera: None,
        wish: overridden(Wish::default(), arguments),
        gloss: gloss(arguments.gloss.unwrap_or(DEFAULT_ROUGHNESS))?,
        model,
    })
}

/// The map that the command line names, in place of other lights.
fn environment(arguments: &Render) -> Option<Vec<SceneLight>> {
    let file = arguments.env.clone()?;
    let environment = Environment { rotation_deg: arguments.env_rotation, ..Environment::new(file) };
    Some(vec![SceneLight::Environment(environment)])
}

fn library_lights(lights: &[SceneLight], just_below_y0: f32) -> Result<Vec<Light>, Error> {
    let mut all = Vec::new();
    for light in lights {
        all.extend(light.lights(just_below_y0)?);
    }
    Ok(all)
}

/// The command line has the last word.
fn overridden(wish: Wish, arguments: &Render) -> Wish {
    Wish {
        morph: if arguments.morph.is_empty() { wish.morph } else { arguments.morph.clone() },
        animation: arguments.animation.clone().or(wish.animation),
        time: arguments.time.or(wish.time),
        twist_deg: arguments.twist.unwrap_or(wish.twist_deg),
        bend_deg: arguments.bend.unwrap_or(wish.bend_deg),
        inflate: arguments.inflate.unwrap_or(wish.inflate),
    }
}

/// A wish that cannot be met came from the scene where the command line is silent.
fn blame(error: Error, arguments: &Render) -> Error {
    let said = |option| match option {
        "--morph" => !arguments.morph.is_empty(),
        "--animation" => arguments.animation.is_some(),
        "--time" => arguments.time.is_some(),
        "--twist" => arguments.twist.is_some(),
        "--bend" => arguments.bend.is_some(),
        _ => arguments.inflate.is_some(),
    };
    match (error, &arguments.scene) {
        (Error::Option { option, problem }, Some(path)) if !said(option) => Error::Scene {
            path: path.clone(),
            problem: format!("{}: {problem}", option.trim_start_matches('-')),
        },
        (error, _) => error,
    }
}

/// The scene's camera or one that sees all of the subject, with as many pixels as the command line says.
fn sized(camera: Option<SceneCamera>, subject: &Subject, arguments: &Render) -> SceneCamera {
    let camera = camera.unwrap_or_else(|| subject.camera(DEFAULT_SIZE, arguments.view));
    arguments.size.map_or(camera, |width| camera.resized(width))
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
