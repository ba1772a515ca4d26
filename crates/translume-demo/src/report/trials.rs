//! What is measured: lights, the settings they are tried with, and where the truth comes from.

use super::scenes;
use super::subject::Subject;
use super::twin::Twin;
use std::sync::Arc;
use translume::{
    DirectionalLight, EnvironmentLight, EnvironmentMap, Error, Light, ShadowOptions, SphereLight,
};

/// One or more lights, what they should give, and the settings they are tried with.
pub struct Trial {
    pub name: &'static str,
    pub lights: Vec<Light>,
    pub truth: Truth,
    pub settings: Vec<Setting>,
}

/// Where the reference comes from.
pub enum Truth {
    /// Only the time counts.
    None,
    Rays {
        lights: Vec<translume_reference::Light>,
        samples: u32,
        rays: u32,
    },
    Quadrature(Arc<translume_reference::EnvironmentMap>),
    /// That of the trial before.
    Same,
}

/// How shadows are computed, in words, and which lines of the plot that is a point of.
#[derive(Clone)]
pub struct Setting {
    pub shadow: String,
    pub options: ShadowOptions,
    pub sweeps: &'static [Sweep],
}

/// What changes along a line of the plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sweep {
    Resolution,
    Filter,
    /// Points of an area light, or directions of the sky.
    Samples,
}

const LAMP_RESOLUTION: u32 = 2048;
const LAMP_FILTER: u32 = 4;

/// All trials; fewer settings if `quick`.
pub fn trials(subject: &Subject, twin: &Twin, quick: bool) -> Result<Vec<Trial>, Error> {
    let mut all = vec![trial("no light", Vec::new(), Truth::None, vec![unshaded()])];
    let lamps = map_settings(quick);
    for (name, light) in scenes::lamps(subject) {
        all.push(trial(name, vec![light], rays(twin, &[light], 4, 1), lamps.clone()));
    }
    let window = Light::Rectangle(scenes::window(subject));
    let bulb = Light::Sphere(scenes::bulb(subject));
    for (name, light) in [("rectangle", window), ("sphere", bulb)] {
        all.push(trial(name, vec![light], rays(twin, &[light], 2, 8), point_settings(quick)));
    }
    let constant = Light::Ambient(scenes::constant_sky(true));
    all.push(trial("constant sky", vec![constant], rays(twin, &[constant], 2, 8), sky_settings(quick)));
    all.extend(smooth_skies(quick)?);
    all.extend(suns()?);
    all.extend(costs(subject, twin));
    Ok(all)
}

fn trial(name: &'static str, lights: Vec<Light>, truth: Truth, settings: Vec<Setting>) -> Trial {
    Trial { name, lights, truth, settings }
}

/// The truth of lights that rays know.
fn rays(twin: &Twin, lights: &[Light], samples: u32, rays: u32) -> Truth {
    Truth::Rays { lights: lights.iter().filter_map(|light| twin.light(light)).collect(), samples, rays }
}

fn smooth_skies(quick: bool) -> Result<[Trial; 2], Error> {
    let sky = scenes::sky_map(256, 128, |_| None)?;
    let light = |shadow| vec![Light::Environment(EnvironmentLight { shadow, ..sky.project() })];
    let truth = sky_truth(&sky, [2, 8]);
    let open =
        translume_twin::map(&scenes::sky_map(512, 256, |_| None)?).map_or(Truth::None, Truth::Quadrature);
    Ok([
        trial("smooth sky", light(true), truth, sky_settings(quick)),
        trial("smooth sky, not occluded", light(false), open, vec![unshaded()]),
    ])
}

/// A disc of one degree, ten thousand times as bright as the sky.
fn suns() -> Result<[Trial; 2], Error> {
    let edge = 0.5_f32.to_radians();
    let map = scenes::sky_map(1024, 512, |to| (to.angle_between(scenes::TO_SUN) < edge).then_some([1e4; 3]))?;
    let whole = vec![Light::Environment(EnvironmentLight { shadow: true, ..map.project() })];
    let (peaks, rest) = map.split_peaks();
    let mut split: Vec<_> = peaks.into_iter().map(Light::Directional).collect();
    split.push(Light::Environment(EnvironmentLight { shadow: true, ..rest }));
    let options = sky_options(64, 256);
    let both = ShadowOptions { resolution: LAMP_RESOLUTION, ..options };
    let words = |options: &ShadowOptions| format!("{}; {}", map_words(options), sky_words(options));
    let split_setting = Setting { shadow: words(&both), options: both, sweeps: &[] };
    let setting = Setting { shadow: sky_words(&options), options, sweeps: &[] };
    // The sun's shadow has edges, so more points in each texel; fewer rays to the smooth rest then do.
    let truth = sky_truth(&map, [3, 6]);
    Ok([
        trial("sun in sky, harmonics alone", whole, truth, vec![setting]),
        trial("sun in sky, split", split, Truth::Same, vec![split_setting]),
    ])
}

fn sky_truth(map: &EnvironmentMap, [samples, rays]: [u32; 2]) -> Truth {
    let light =
        translume_twin::map(map).map(|map| translume_reference::Light::Environment { map, shadow: true });
    Truth::Rays { lights: light.into_iter().collect(), samples, rays }
}

/// Lights without shadows, one of a kind, and sixteen lights with shadows.
fn costs(subject: &Subject, twin: &Twin) -> [Trial; 4] {
    let alone = |name, light| trial(name, vec![light], Truth::None, vec![unshaded()]);
    let mixed = scenes::mixed(subject);
    let options = ShadowOptions { resolution: 1024, area_points: 4, ..sky_options(64, 256) };
    let shadow = format!("{}, 4 points; {}", map_words(&options), sky_words(&options));
    let truth = rays(twin, &mixed, 2, 8);
    [
        alone("one directional", Light::Directional(DirectionalLight { shadow: false, ..scenes::sun() })),
        alone("one ambient", Light::Ambient(scenes::constant_sky(false))),
        alone("one sphere", Light::Sphere(SphereLight { shadow: false, ..scenes::bulb(subject) })),
        trial("16 mixed", mixed, truth, vec![Setting { shadow, options, sweeps: &[] }]),
    ]
}

fn map_settings(quick: bool) -> Vec<Setting> {
    const BOTH: &[Sweep] = &[Sweep::Resolution, Sweep::Filter];
    let all = [
        (512, 4, &BOTH[..1]),
        (1024, 4, &BOTH[..1]),
        (2048, 1, &BOTH[1..]),
        (2048, 2, &BOTH[1..]),
        (2048, 4, BOTH),
        (2048, 8, &BOTH[1..]),
        (4096, 4, &BOTH[..1]),
    ];
    let kept = all.into_iter().filter(|(resolution, filter, _)| !quick || resolution * filter <= 2048);
    kept.map(|(resolution, filter, sweeps)| {
        let options = ShadowOptions { resolution, filter, ..Default::default() };
        Setting { shadow: map_words(&options), options, sweeps }
    })
    .collect()
}

fn point_settings(quick: bool) -> Vec<Setting> {
    let counts: &[u32] = if quick { &[4, 16] } else { &[4, 16, 64] };
    let setting = |&area_points| {
        let (resolution, filter) = (LAMP_RESOLUTION, LAMP_FILTER);
        let options = ShadowOptions { resolution, filter, area_points, ..Default::default() };
        let shadow = format!("{}, {area_points} points", map_words(&options));
        Setting { shadow, options, sweeps: &[Sweep::Samples] }
    };
    counts.iter().map(setting).collect()
}

fn sky_settings(quick: bool) -> Vec<Setting> {
    const ALL: [(u32, u32); 7] =
        [(16, 256), (32, 256), (64, 256), (128, 256), (256, 256), (64, 128), (64, 512)];
    let setting = |(directions, width)| {
        let options = sky_options(directions, width);
        let sweeps: &[_] = if width == 256 { &[Sweep::Samples] } else { &[] };
        Setting { shadow: sky_words(&options), options, sweeps }
    };
    let kept = ALL.into_iter().filter(|(directions, width)| !quick || directions * width <= 64 * 256);
    kept.map(setting).collect()
}

fn unshaded() -> Setting {
    Setting { shadow: "none".to_owned(), options: ShadowOptions::default(), sweeps: &[] }
}

pub fn map_words(options: &ShadowOptions) -> String {
    format!("map {}, filter {}", options.resolution, options.filter)
}

pub fn sky_words(options: &ShadowOptions) -> String {
    format!("{} directions, map {}", options.directions, options.direction_resolution)
}

pub fn sky_options(directions: u32, direction_resolution: u32) -> ShadowOptions {
    ShadowOptions { directions, direction_resolution, ..Default::default() }
}
