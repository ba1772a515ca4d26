//! Two ways to find out how right a picture is, beside the window: paths of light, and all pairs of texels.

use super::events::{Event, Events};
use super::loaded::Loaded;
use super::task::Task;
use crate::albedo;
use crate::error::Error;
use crate::gpu::Gpu;
use crate::motion::Motion;
use crate::overlay;
use crate::picture::{Develop, Picture};
use crate::scene::{Scene, SceneLight};
use crate::setup::{Substance, library_lights};
use crate::trace::{Limits, Subject, samples, trace};
use async_lock::Mutex;
use eframe::egui;
use glam::Vec3;
use std::f32::consts::PI;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use translume::{Body, Config, Evaluate, Frame, Lighting, Method, Translume, Transport, wgpu};
use web_time::Instant;

/// Pixels across a picture by paths.
const WIDTH: u32 = 192;
/// Radius of a sphere in place of a point, of its distance to what is looked at; half angle of a cone in place of a direction.
const LAMP: f32 = 0.15;
const SUN_DEG: f32 = 6.0;
/// Noise at which paths end.
const NOISE: f64 = 0.02;

/// A picture by paths as far as it has come.
pub struct Traced {
    pub image: egui::ColorImage,
    /// Standard error over the mean.
    pub noise: f64,
    pub seconds: f64,
    /// Whether lamps were given an extent.
    pub widened: bool,
    pub done: bool,
}

/// Errors against all pairs.
pub struct Judged {
    /// Of which model's texels.
    pub loaded: u64,
    /// Of each texel.
    pub errors: Arc<Vec<f32>>,
    /// Root mean square, and what 99 % stay below.
    pub rms: f32,
    pub most: f32,
    pub seconds: f64,
}

/// Where scatters are judged, once the first was: drivers keep some of the memory of every device that there was.
pub type Court = Arc<Mutex<Option<(Gpu, Translume)>>>;

/// Follows paths through a scene until little noise is left.
pub fn follow(scene: Scene, loaded: Arc<Loaded>, events: &Events) -> Task {
    let events = events.clone();
    Task::start(async move |number, cancelled| {
        let send = |result| events.send(Event::Traced(number, result));
        let start = Instant::now();
        let exposure = scene.look.exposure;
        let (scene, widened) = match with_extent(scene) {
            Ok(wider) => wider,
            Err(error) => return send(Err(error)),
        };
        let traced = |samples: Vec<[f32; 4]>, width: usize, noise, done| {
            let picture = Picture::from_samples(&samples, width as u32, 1, Develop::Display { exposure });
            let size = [picture.width as usize, picture.height as usize];
            let image = egui::ColorImage::from_rgb(size, &picture.to_srgb());
            Traced { image, noise, seconds: start.elapsed().as_secs_f64(), widened, done }
        };
        let limits =
            Limits { noise: Some(NOISE), seconds: None, samples: None, seed: 1, stop: Some(cancelled) };
        let result = Subject::new(&scene, &loaded.opened, Some(WIDTH)).and_then(|subject| {
            trace(&subject, &limits, |status| {
                let estimate = status.estimate;
                send(Ok(traced(samples(estimate), estimate.width, status.noise, false)));
                !cancelled.load(Ordering::Relaxed)
            })
        });
        if !cancelled.load(Ordering::Relaxed) {
            send(result.map(|estimate| traced(samples(&estimate), estimate.width, estimate.noise(), true)));
        }
    })
}

/// Holds the scatter of a scene against all pairs, on a device of its own, as that may take minutes.
pub fn judge(scene: Scene, loaded: Arc<Loaded>, court: &Court, events: &Events) -> Task {
    let (court, events) = (Arc::clone(court), events.clone());
    Task::start(async move |number, cancelled| {
        let result = errors(&scene, &loaded, &court).await;
        if !cancelled.load(Ordering::Relaxed) {
            events.send(Event::Judged(number, result));
        }
    })
}

/// The scene with lamps that paths can meet through a surface that refracts: points become spheres, directions cones of the sky, as bright as
/// before. Says whether any did.
fn with_extent(mut scene: Scene) -> Result<(Scene, bool), Error> {
    let refracts = scene.medium()?.unwrap_or_default().ior != 1.0;
    let target = scene.camera.map_or(Vec3::ZERO, |camera| camera.target.into());
    let mut any = false;
    for light in scene.lights.iter_mut().flatten().filter(|_| refracts) {
        let wider = match *light {
            SceneLight::Point { position, intensity, shadow, lit_region: None } => {
                let radius = LAMP * target.distance(position.into());
                let radiance = intensity.map(|c| c / (PI * radius * radius));
                SceneLight::Sphere { center: position, radius, radiance, shadow }
            }
            SceneLight::Directional { to_light, irradiance, shadow, lit_region: None } => {
                let radiance = irradiance.map(|c| c / (PI * SUN_DEG.to_radians().sin().powi(2)));
                SceneLight::CapEnv { radiance, axis: to_light, half_angle_deg: SUN_DEG, shadow }
            }
            _ => continue,
        };
        (*light, any) = (wider, true);
    }
    Ok((scene, any))
}

async fn errors(scene: &Scene, loaded: &Loaded, court: &Court) -> Result<Judged, Error> {
    let start = Instant::now();
    let mut court = court.lock().await;
    if court.is_none() {
        let gpu = Gpu::open().await?;
        let translume = Translume::new(&gpu.device, &Config::default())?;
        *court = Some((gpu, translume));
    }
    let Some((gpu, translume)) = &*court else { return Err(Error::Worker) };
    let opened = &loaded.opened;
    let motion = Motion::new(&opened.model, &scene.wish(), 1)?;
    let moment = motion.moment(0);
    let lights = library_lights(scene.lights.as_deref().unwrap_or_default(), opened.just_below_y0())?;
    let frame = Frame {
        model: moment.model.to_cols_array_2d(),
        deformation: (&moment.pose).into(),
        warp: motion.warp,
        lighting: Lighting::Lights(&lights),
        ..Default::default()
    };
    let mut substance = Substance::new(scene, Path::new(""))?;
    let exitance = async |substance: &Substance| {
        let descriptor = substance.descriptor(&opened.model.mesh, &loaded.atlas, opened.flat_normals);
        let mut body = translume.create_body(&gpu.device, &descriptor)?;
        let laid = (&opened.model.mesh, &loaded.atlas);
        albedo::apply(&mut body, &gpu.queue, scene.albedo.as_deref(), laid)?;
        exitance(gpu, &mut body, &frame).await
    };
    if substance.transport == Transport::Auto {
        substance.transport = Transport::Classic;
    }
    let exact = Substance { method: Method::AllPairs, evaluate: Evaluate::PerTexel, ..substance.clone() };
    let errors = overlay::errors(&exitance(&substance).await?, &exitance(&exact).await?);
    let rms = (errors.iter().map(|error| error * error).sum::<f32>() / errors.len().max(1) as f32).sqrt();
    let mut sorted = errors.clone();
    sorted.sort_by(f32::total_cmp);
    let most = sorted.get(sorted.len() * 99 / 100).copied().unwrap_or(0.0);
    let seconds = start.elapsed().as_secs_f64();
    Ok(Judged { loaded: loaded.id, errors: Arc::new(errors), rms, most, seconds })
}

async fn exitance(gpu: &Gpu, body: &mut Body, frame: &Frame<'_>) -> Result<Vec<[f32; 4]>, Error> {
    let Gpu { device, queue, .. } = gpu;
    body.prepare(device, queue, frame)?;
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("judge") });
    body.encode(&mut encoder);
    queue.submit([encoder.finish()]);
    gpu.buffer(body.outputs().exitance).await
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(ior: f32) -> Scene {
        let text = format!(
            r#"{{ "shape": {{ "type": "sphere", "center": [0, 0, 0], "radius": 10 }},
                "material": {{ "sigma_s_prime": [1, 1, 1], "sigma_a": [0, 0, 0], "eta": {ior} }},
                "lights": [
                    {{ "type": "point", "position": [0, 0, 100], "intensity": [5, 5, 5] }},
                    {{ "type": "directional", "to_light": [0, 1, 0], "irradiance": [2, 2, 2] }} ] }}"#
        );
        Scene::parse(&text, Path::new("scene.json")).unwrap()
    }

    #[test]
    fn lamps_are_widened_where_the_surface_refracts_alone() {
        assert_eq!(with_extent(scene(1.0)).unwrap(), (scene(1.0), false));
        let (wider, any) = with_extent(scene(1.3)).unwrap();
        assert!(any);
        let [
            SceneLight::Sphere { radius, radiance, .. },
            SceneLight::CapEnv { radiance: sky, half_angle_deg, .. },
        ] = wider.lights.as_deref().unwrap()
        else {
            panic!("{:?}", wider.lights);
        };
        // Intensity of a sphere from afar, and irradiance of a cone on a plane across: rounding of f32 alone.
        assert!((radiance[0] * PI * radius * radius / 5.0 - 1.0).abs() < 1e-5);
        assert!((sky[0] * PI * half_angle_deg.to_radians().sin().powi(2) / 2.0 - 1.0).abs() < 1e-5);
    }
}
