//! Light that comes through a slab and through the thin parts of a model.

use super::bench::Bench;
use super::judge::Judge;
use super::row::{Case, Part, Row};
use super::{Study, accuracy};
use crate::error::Error;
use crate::report::twin::Twin;
use glam::DVec3;
use translume::Medium;
use translume_reference::Surface;
use translume_reference::gather::Source;

/// The thinnest tenth of what is in the dark counts as thin.
const THIN: usize = 10;
/// Into the body, mm: the ray that measures its thickness starts below the surface.
const BELOW: f64 = 0.01;

pub fn measure(study: &Study<'_>, rows: &mut Vec<Row>) -> Result<(), Error> {
    let size = study.plan.sizes.last().copied().unwrap_or(512);
    for kind in &study.plan.behind {
        let scene = kind.open(size)?;
        study.bar.set_message(scene.name.clone());
        let mut bench = Bench::new(study.gpu, study.translume, &scene)?;
        let twin = Twin::new(&scene.subject, 1);
        for &name in study.plan.media {
            let medium = Medium::preset(name)?;
            bench.set_medium(medium)?;
            let sources = bench.sources()?;
            let thin = thin(&twin.surface, &sources);
            let stride = study.plan.stride(thin.len(), study.plan.converged_samples);
            let receivers = thin.into_iter().step_by(stride).collect();
            let judge = Judge::converged(&twin, &scene.lights, &sources, &medium, receivers);
            let case = Case { scene: &scene.name, atlas: size, medium: name, profile: bench.profile() };
            let methods = accuracy::best_and_pattern();
            let runs = accuracy::run_all(study, &mut bench, &methods)?;
            accuracy::compare(&case, (Part::Transmitted, &judge), &runs, &methods, rows);
            study.bar.inc(1);
        }
    }
    Ok(())
}

/// Texels that no light reaches, where the body below them is thinnest, in their order.
fn thin(surface: &Surface, sources: &[Source]) -> Vec<usize> {
    let dark = (0..sources.len()).filter(|&k| sources[k].area > 0.0 && sources[k].irradiance == [0.0; 3]);
    let dark: Vec<(f64, usize)> = dark.map(|k| (thickness(surface, &sources[k]), k)).collect();
    let mut sorted: Vec<f64> = dark.iter().map(|(thickness, _)| *thickness).collect();
    sorted.sort_by(f64::total_cmp);
    // All of a slab is as thick as its thinnest place, but for rounding.
    let most = sorted.get(sorted.len() / THIN).map_or(0.0, |thickness| 1.001 * thickness);
    dark.into_iter().filter(|(thickness, _)| *thickness <= most).map(|(_, k)| k).collect()
}

/// From one side of the body to the other, mm.
fn thickness(surface: &Surface, source: &Source) -> f64 {
    let inwards = -DVec3::from(source.normal);
    let start = DVec3::from(source.position) + BELOW * inwards;
    surface.closest_hit(start.to_array(), inwards.to_array()).map_or(f64::INFINITY, |hit| hit.t)
}
