//! `translume render`: a model or a scene becomes a picture.

use crate::albedo::Albedo;
use crate::canvas::Canvas;
use crate::cli::{Render, put};
use crate::environment::Environment;
use crate::error::Error;
use crate::framing::Subject;
use crate::gpu::Gpu;
use crate::model;
use crate::motion::Motion;
use crate::picture::{Format, Output};
use crate::progress;
use crate::scene::{Round, Scene, SceneAnimation, SceneLight, Up};
use crate::setup::{ASSUMED_DIAGONAL_MM, DEFAULT_ROUGHNESS, Opened, Substance, camera};
use crate::studio::Studio;
use crate::timings::table;
use std::path::{Path, PathBuf};
use std::time::Instant;
use translume::{Config, Frame, Lighting, Medium, Translume, View};

pub fn run(arguments: &Render) -> Result<(), Error> {
    let mut output = Output::new(&arguments.output)?;
    if arguments.frames > 1 && output.format != Format::Png {
        return Err(Error::Option { option: "--frames", problem: "only a PNG can be animated".to_owned() });
    }
    let (mut scene, path) = scene(arguments)?;
    overrule(&mut scene, arguments)?;
    let blame = |error| blame(error, arguments);
    let directory = path.parent().unwrap_or(Path::new(""));
    let mut substance = Substance::new(&scene, directory).map_err(blame)?;
    let gloss = scene.look.gloss().map_err(blame)?;
    scene.quality.atlas(1.0).map_err(blame)?;
    let gpu = Gpu::new()?;
    check_atlas(scene.quality.atlas, &gpu).map_err(blame)?;
    let opened = progress::during("load", |watch| Opened::new(&scene, &path, watch))?;
    let mesh = &opened.model.mesh;
    if arguments.scene.is_none() && arguments.mm_per_unit.is_none() {
        substance.mm_per_unit = ASSUMED_DIAGONAL_MM / opened.model.diagonal()?;
    }
    let motion = Motion::new(&opened.model, &scene.wish(), arguments.frames).map_err(blame)?;
    output.frame_seconds = motion.frame_seconds().unwrap_or(output.frame_seconds);
    let subject = Subject::new(motion.points().map_err(blame)?);
    let camera = camera(&scene, &subject, arguments.view);
    let camera = arguments.size.map_or(camera, |width| camera.resized(width));
    let albedo = scene.albedo.as_ref().map(|file| Albedo::open(file, mesh)).transpose()?;
    let lights = opened.lights(&scene, &subject, arguments.view)?;
    let start = Instant::now();
    let atlas = model::unwrap(mesh, &scene.quality.atlas(substance.mm_per_unit).map_err(blame)?)?;
    let unwrapped = start.elapsed().as_secs_f32();

    let descriptor = substance.descriptor(mesh, &atlas, opened.flat_normals);
    let samples = arguments.samples.unwrap_or(output.format.samples());
    let translume = Translume::new(&gpu.device, &Config::default())?;
    let composite = Canvas::composite(&gpu.device, &translume);
    let mut studio =
        Studio::new(&gpu, (&translume, &composite), &descriptor, [camera.width, camera.height], samples)?;
    let variations = albedo.map(|albedo| albedo.variations(mesh, &atlas));
    studio.body_mut().set_variation(&gpu.queue, variations.as_deref())?;
    studio.body_mut().set_timings(arguments.timings);
    let camera = subject.look(&camera);
    let develop = output.format.develop(scene.look.exposure);
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
        studio.draw(&frame, &camera, gloss)?;
        frames.push(pollster::block_on(studio.picture(develop))?);
        timings.extend(studio.body().timings());
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
        substance.mm_per_unit,
        atlas.texels.len(),
        atlas.report.charts,
        gpu.adapter,
    ));
    Ok(())
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

/// What is to be rendered before the command line has its say, and where its files are.
fn scene(arguments: &Render) -> Result<(Scene, PathBuf), Error> {
    if let Some(path) = &arguments.scene {
        return Ok((Scene::read(path)?, path.clone()));
    }
    let mut scene = Scene::of_model(arguments.model.as_deref().unwrap_or_default());
    scene.look.gloss = DEFAULT_ROUGHNESS;
    if arguments.up == "z" {
        scene.up = Up::Z;
    }
    scene.into =
        arguments.into.as_ref().map(|shape| if shape == "sphere" { Round::Sphere } else { Round::Egg });
    Ok((scene, PathBuf::new()))
}

/// The command line has the last word.
fn overrule(scene: &mut Scene, arguments: &Render) -> Result<(), Error> {
    if let Some(name) = &arguments.medium {
        Medium::preset(name)?;
        (scene.medium, scene.material) = (Some(name.clone()), None);
    }
    put(&mut scene.albedo, arguments.albedo.clone().map(Some));
    put(&mut scene.mm_per_unit, arguments.mm_per_unit.map(Some));
    put(&mut scene.lights, environment(arguments).map(Some));
    put(&mut scene.look.gloss, arguments.gloss);
    put(&mut scene.look.exposure, arguments.exposure);
    put(&mut scene.warp.twist_deg, arguments.twist);
    put(&mut scene.warp.bend_deg, arguments.bend);
    put(&mut scene.warp.inflate, arguments.inflate);
    put(&mut scene.animation, arguments.animation.clone().map(|name| Some(SceneAnimation::Name(name))));
    put(&mut scene.time, arguments.time.map(Some));
    if !arguments.morph.is_empty() {
        scene.morph.clone_from(&arguments.morph);
    }
    let quality = &mut scene.quality;
    arguments.layout.put(quality);
    quality.even |= arguments.even;
    put(&mut quality.finer_below, arguments.finer_below.map(Some));
    // The command line's files are not the scene's.
    let profile = |name: &String| std::path::absolute(name).ok().filter(|_| name.ends_with(".json"));
    let profile = |name: &String| profile(name).map_or(name.clone(), |path| path.display().to_string());
    put(&mut quality.profile, arguments.profile.as_ref().map(profile));
    if let Some(method) = &arguments.method {
        // Numbers of the scene's method are not those of another.
        (quality.tolerance, quality.theta) = (None, None);
        quality.method.clone_from(method);
    }
    if arguments.tolerance.is_some() || arguments.theta.is_some() {
        (quality.tolerance, quality.theta) = (arguments.tolerance, arguments.theta);
    }
    put(&mut quality.transport, arguments.transport.clone());
    put(&mut quality.evaluate, arguments.evaluate.clone());
    put(&mut quality.shadow, arguments.shadow);
    put(&mut quality.directions, arguments.directions);
    Ok(())
}

/// The map that the command line names, in place of other lights.
fn environment(arguments: &Render) -> Option<Vec<SceneLight>> {
    let file = arguments.env.clone()?;
    let environment = Environment { rotation_deg: arguments.env_rotation, ..Environment::new(file) };
    Some(vec![SceneLight::Environment(environment)])
}

/// What cannot be came from the scene where the command line is silent.
fn blame(error: Error, arguments: &Render) -> Error {
    let said = |option| match option {
        "--morph" => !arguments.morph.is_empty(),
        "--animation" => arguments.animation.is_some(),
        "--time" => arguments.time.is_some(),
        "--twist" => arguments.twist.is_some(),
        "--bend" => arguments.bend.is_some(),
        "--gloss" => arguments.gloss.is_some(),
        "--method" => arguments.method.is_some(),
        "--transport" => arguments.transport.is_some(),
        "--tolerance" => arguments.tolerance.is_some(),
        "--theta" => arguments.theta.is_some(),
        "--evaluate" => arguments.evaluate.is_some(),
        "--atlas" => arguments.layout.atlas.is_some(),
        "--charts" => arguments.layout.charts.is_some(),
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
