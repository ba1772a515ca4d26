//! What a scene's picture should be: the integral of a profile over the surface, and light followed through the volume.

use super::stage::Stage;
use crate::error::Error;
use crate::picture::{Develop, Picture};
use crate::trace;
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::time::{Duration, Instant};
use translume::{Medium, Profile};
use translume_reference::composite::Camera;
use translume_reference::converged::Converged;
use translume_reference::fresnel::{hemispherical_transmittance, transmittance};
use translume_reference::profile::Numeric;
use translume_reference::{Boundary, Hit, Light, Surface};

/// How long light is followed through a scene.
#[derive(Clone, Copy, Debug)]
pub struct Patience {
    /// Pixels at which integrals are summed, about.
    pub samples: usize,
    /// Root mean square of the standard error over the mean: so little is enough.
    pub noise: f64,
    pub most: Duration,
}

/// The name of a profile, and radiance by it at some pixels.
type Integral = (&'static str, Vec<[f64; 3]>);

/// Both truths, pixel by pixel.
pub struct Truths {
    width: u32,
    /// Pixels that the body fills, as far as their neighbours tell.
    pub mask: Vec<bool>,
    /// Pixels at which integrals are known, spread over the mask.
    samples: Vec<usize>,
    /// At those.
    converged: Vec<Integral>,
    pub traced: Option<Traced>,
    /// Why light was not followed.
    pub untraced: Option<String>,
    /// Stops that make the picture neither dark nor burnt out.
    exposure: f32,
}

/// Light followed through the volume.
pub struct Traced {
    pub radiance: Vec<[f64; 3]>,
    /// One standard error of it.
    pub error: Vec<[f64; 3]>,
    /// Paths per pixel.
    pub samples: u32,
    pub seconds: f64,
}

/// Steps on which light is cast, over the body's size; shadows in the integral are as sharp as that.
const EDGE: f64 = 1.0 / 80.0;
/// This share of the pixels is darker than the level below.
const BRIGHT_SHARE: f64 = 0.95;
const BRIGHT_LEVEL: f64 = 0.7;

impl Truths {
    /// `profiles`: by name, those whose integral is wanted. `proceed` is told what is under way.
    pub fn new(
        stage: &Stage,
        profiles: &[&'static str],
        patience: Patience,
        told: &dyn Fn(&str),
    ) -> Result<Self, Error> {
        let surface = stage.surface();
        let lights = &stage.paths.lights;
        let seen = Seen::new(&stage.paths.camera, &surface);
        let samples = spread(&seen.mask, patience.samples);
        let converged = integrals(stage, &seen, (&surface, lights), (&samples, profiles), told)?;
        told("paths");
        let (traced, untraced) = match follow(&stage.paths, patience) {
            Ok(traced) => (Some(traced), None),
            Err(reason @ Error::Path(_)) => (None, Some(reason.to_string())),
            Err(other) => return Err(other),
        };
        let mut truths = Self {
            width: stage.camera.width,
            mask: seen.mask,
            samples,
            converged,
            traced,
            untraced,
            exposure: 0.0,
        };
        truths.exposure = truths.exposure();
        Ok(truths)
    }

    pub fn converged(&self, profile: &str) -> Option<&[[f64; 3]]> {
        self.converged.iter().find(|(name, _)| *name == profile).map(|(_, radiance)| radiance.as_slice())
    }

    /// What a picture has where integrals are known.
    pub fn sampled<T: Copy>(&self, picture: &[T]) -> Vec<T> {
        self.samples.iter().filter_map(|&k| picture.get(k).copied()).collect()
    }

    fn exposure(&self) -> f32 {
        match (&self.traced, self.converged.first()) {
            (Some(traced), _) => exposure(&self.sampled(&traced.radiance)),
            (None, Some((_, radiance))) => exposure(radiance),
            (None, None) => 0.0,
        }
    }

    /// A picture as it is shown, the pixels that the body fills before a backdrop.
    pub fn shown<T: Shown>(&self, radiance: &[T]) -> Option<Picture> {
        if radiance.len() != self.mask.len() {
            return None;
        }
        let sample = |(pixel, inside): (&T, &bool)| {
            let [r, g, b] = pixel.rgb().map(|c| c as f32);
            if *inside { [r, g, b, 1.0] } else { [0.0; 4] }
        };
        let samples: Vec<[f32; 4]> = radiance.iter().zip(&self.mask).map(sample).collect();
        Some(Picture::from_samples(&samples, self.width, 1, Develop::Display { exposure: self.exposure }))
    }
}

/// Linear colour of a pixel.
pub trait Shown {
    fn rgb(&self) -> [f64; 3];
}

impl Shown for [f32; 3] {
    fn rgb(&self) -> [f64; 3] {
        self.map(f64::from)
    }
}

impl Shown for [f64; 3] {
    fn rgb(&self) -> [f64; 3] {
        *self
    }
}

/// Where the middles of pixels meet the surface.
struct Seen {
    hits: Vec<Option<(Hit, DVec3)>>,
    mask: Vec<bool>,
}

impl Seen {
    fn new(camera: &Camera, surface: &Surface) -> Self {
        let (width, height) = (camera.width, camera.height);
        let hit = |index: usize| {
            let direction = camera.direction(index % width, index / width);
            surface
                .closest_hit(camera.eye, direction)
                .map(|hit| (hit, DVec3::from(direction).normalize_or_zero()))
        };
        let hits: Vec<_> = (0..width * height).into_par_iter().map(hit).collect();
        let inside = |index: usize| {
            let (x, y) = (index % width, index / width);
            let near = |k: usize, most: usize| k.saturating_sub(1)..(k + 2).min(most);
            near(y, height).all(|row| near(x, width).all(|column| hits[row * width + column].is_some()))
        };
        let mask = (0..width * height).map(inside).collect();
        Self { hits, mask }
    }
}

/// The profile of each channel. That of a half-space is the library's own table: its twin is random walks, whose noise would count as an error.
fn twins(profile: &Profile, medium: &Medium) -> Result<Option<[Numeric; 3]>, Error> {
    if !matches!(profile, Profile::HalfSpace(_)) {
        return Ok(translume_twin::profiles(profile, medium));
    }
    let table = profile.reflectance(medium)?;
    let channel = |k: usize| {
        let mean_free_path = 1.0 / f64::from(medium.sigma_s_prime[k] + medium.sigma_a[k]);
        let range = [1e-4, 1e3].map(|x| x * mean_free_path);
        // As 1/r near 0: of what lies nearer than this, seven points of a patch are enough.
        Numeric::new(|r| table.at(r)[k], table.decay()[k], 0.02 * mean_free_path, range)
    };
    Ok(Some([0, 1, 2].map(channel)))
}

/// Some of the pixels that count, every so manieth.
fn spread(mask: &[bool], samples: usize) -> Vec<usize> {
    let inside: Vec<usize> = (0..mask.len()).filter(|&k| mask[k]).collect();
    let stride = inside.len().div_ceil(samples).max(1);
    inside.into_iter().step_by(stride).collect()
}

/// Radiance at the middle of some pixels by each profile that the reference knows; light is cast once for all whose gain of entry is the same.
fn integrals(
    stage: &Stage,
    seen: &Seen,
    (surface, lights): (&Surface, &[Light]),
    (samples, profiles): (&[usize], &[&'static str]),
    told: &dyn Fn(&str),
) -> Result<Vec<Integral>, Error> {
    let eta = f64::from(stage.medium.ior);
    let edge = EDGE * f64::from(stage.model.mesh.diagonal() * stage.mm_per_unit);
    let hits: Vec<(Hit, DVec3)> = samples.iter().filter_map(|&k| seen.hits[k]).collect();
    let places: Vec<[f64; 3]> =
        hits.iter().map(|(hit, _)| surface.point(hit.triangle, hit.barycentric)).collect();
    let leaving = |((hit, direction), b): (&(Hit, DVec3), [f64; 3])| {
        let normal = DVec3::from(surface.normal(hit.triangle, hit.barycentric));
        let leaves = transmittance(eta, -normal.dot(*direction)) / (PI * hemispherical_transmittance(eta));
        b.map(|b| b * leaves)
    };
    let mut lit: Option<(Boundary, Converged<'_, Numeric>)> = None;
    let mut all = Vec::new();
    for &name in profiles {
        told(&format!("integral of {name}"));
        let start = Instant::now();
        let profile = Profile::named(name)?;
        let Some(twins) = twins(&profile, &stage.medium)? else { continue };
        let boundary = translume_twin::boundary(&profile, &stage.medium);
        let (_, converged) = match &mut lit {
            Some(known) if known.0 == boundary => {
                known.1.set_profiles(twins);
                known
            }
            _ => lit.insert((boundary, Converged::with_profiles(surface, lights, boundary, twins, edge))),
        };
        all.push((name, hits.iter().zip(converged.exitance(&places)).map(leaving).collect()));
        log::info!("{}: integral of {name} in {:.1?}", stage.name, start.elapsed());
    }
    Ok(all)
}

/// Follows light until it is quiet enough, or long enough.
fn follow(subject: &trace::Subject, patience: Patience) -> Result<Traced, Error> {
    let start = Instant::now();
    let limits = trace::Limits {
        noise: Some(patience.noise),
        seconds: Some(patience.most.as_secs_f64()),
        samples: None,
        seed: 1,
        stop: None,
    };
    let mut samples = 0;
    let estimate = trace::trace(subject, &limits, |status| {
        samples = status.samples;
        true
    })?;
    Ok(Traced {
        radiance: estimate.radiance,
        error: estimate.error,
        samples,
        seconds: start.elapsed().as_secs_f64(),
    })
}

fn exposure(radiance: &[[f64; 3]]) -> f32 {
    let mut levels: Vec<f64> = radiance.iter().map(|rgb| rgb.iter().copied().fold(0.0, f64::max)).collect();
    levels.sort_by(f64::total_cmp);
    let rank = (BRIGHT_SHARE * levels.len() as f64) as usize;
    let bright = levels.get(rank).copied().unwrap_or(0.0);
    if bright > 0.0 { (BRIGHT_LEVEL / bright).log2() as f32 } else { 0.0 }
}
