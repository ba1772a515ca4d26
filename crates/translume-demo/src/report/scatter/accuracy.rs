//! Every method against all pairs, and the best against the converged integral.

use super::Study;
use super::bench::Bench;
use super::judge::Judge;
use super::row::{Case, Part, Row};
use super::scene::{Kind, Scene};
use crate::error::Error;
use crate::report::twin::Twin;
use std::time::Instant;
use translume::{Medium, Method};
use translume_reference::gather::Source;

pub fn measure(study: &Study<'_>, kind: &Kind, rows: &mut Vec<Row>) -> Result<(), Error> {
    let plan = study.plan;
    let mut total = Vec::new();
    for &size in &plan.total_sizes {
        let scene = kind.open(size)?;
        study.bar.set_message(scene.name.clone());
        let mut bench = Bench::new(study.gpu, study.translume, &scene)?;
        let twin = Twin::new(&scene.subject, 1);
        for &name in plan.media {
            let medium = Medium::preset(name)?;
            bench.set_medium(medium)?;
            let sources = bench.sources()?;
            let case = Case { scene: &scene.name, atlas: size, medium: name, profile: bench.profile() };
            if plan.sizes.contains(&size) {
                let stride = plan.stride(sources.len(), plan.samples);
                let receivers = (0..sources.len()).step_by(stride).collect();
                let start = Instant::now();
                let judge = Judge::all_pairs(&sources, &medium, receivers);
                let judged = start.elapsed();
                compare(study, &mut bench, &case, (Part::AllPairs, &judge), &plan.methods, rows)?;
                log::info!(
                    "{} {size} {name}: all pairs {judged:.1?}, all {:.1?}",
                    scene.name,
                    start.elapsed()
                );
                study.bar.inc(1);
            }
            let start = Instant::now();
            let judge = converged(study, &twin, &scene, &sources, &medium);
            let methods = [Method::default(), Method::Pattern];
            compare(study, &mut bench, &case, (Part::Converged, &judge), &methods, &mut total)?;
            log::info!("{} {size} {name}: converged {:.1?}", scene.name, start.elapsed());
            study.bar.inc(1);
        }
    }
    rows.extend(total);
    Ok(())
}

/// At texels that hold surface: the rim lies beyond the triangles.
fn converged(study: &Study<'_>, twin: &Twin, scene: &Scene, sources: &[Source], medium: &Medium) -> Judge {
    let inside: Vec<usize> = (0..sources.len()).filter(|&k| sources[k].area > 0.0).collect();
    let stride = study.plan.stride(inside.len(), study.plan.converged_samples);
    let receivers = inside.into_iter().step_by(stride).collect();
    Judge::converged(twin, &scene.lights, sources, medium, receivers)
}

pub fn compare(
    study: &Study<'_>,
    bench: &mut Bench<'_>,
    case: &Case<'_>,
    (part, judge): (Part, &Judge),
    methods: &[Method],
    rows: &mut Vec<Row>,
) -> Result<(), Error> {
    for &method in methods {
        let run = bench.run(method, study.plan.repeats)?;
        let figures = judge.compare(&run.exitance);
        rows.push(Row { figures, ..Row::new(part, case, method, &run) });
    }
    Ok(())
}
