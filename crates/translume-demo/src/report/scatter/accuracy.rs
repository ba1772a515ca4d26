//! Every method against all pairs, and the best against the converged integral.

use super::Study;
use super::bench::{Bench, Run};
use super::judge::Judge;
use super::row::{Case, Part, Row};
use super::scene::{Kind, Scene};
use crate::error::Error;
use crate::report::twin::Twin;
use std::time::Instant;
use translume::{Medium, Method};
use translume_reference::gather::Source;

/// What is compared with the integral.
pub fn best_and_pattern() -> [Method; 2] {
    [Method::default(), Method::Pattern]
}

pub fn measure(study: &Study<'_>, kind: &Kind, rows: &mut Vec<Row>) -> Result<(), Error> {
    let plan = study.plan;
    let (both, mut total) = (best_and_pattern(), Vec::new());
    for &size in &plan.total_sizes {
        let scene = kind.open(size)?;
        study.bar.set_message(scene.name.clone());
        let mut bench = Bench::new(study.gpu, study.translume, &scene)?;
        let twin = Twin::new(&scene.subject, 1);
        let all = plan.sizes.contains(&size);
        let methods = if all { plan.methods.as_slice() } else { &both };
        for &name in plan.media {
            let start = Instant::now();
            let medium = Medium::preset(name)?;
            bench.set_medium(medium)?;
            let sources = bench.sources()?;
            let case = Case { scene: &scene.name, atlas: size, medium: name, profile: bench.profile() };
            let runs = run_all(study, &mut bench, methods)?;
            let measured = start.elapsed();
            if all {
                let stride = plan.stride(sources.len(), plan.samples);
                let receivers = (0..sources.len()).step_by(stride).collect();
                let judge = Judge::all_pairs(&sources, &medium, receivers);
                compare(&case, (Part::AllPairs, &judge), &runs, methods, rows);
                study.bar.inc(1);
            }
            let summed = start.elapsed();
            let judge = converged(study, &twin, &scene, &sources, &medium);
            compare(&case, (Part::Converged, &judge), &runs, &both, &mut total);
            study.bar.inc(1);
            log::info!(
                "{} {size} {name}: methods {measured:.1?}, all pairs {:.1?}, integral {:.1?}",
                scene.name,
                summed - measured,
                start.elapsed() - summed
            );
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

pub fn run_all(
    study: &Study<'_>,
    bench: &mut Bench<'_>,
    methods: &[Method],
) -> Result<Vec<(Method, Run)>, Error> {
    methods.iter().map(|&method| Ok((method, bench.run(method, study.plan.repeats)?))).collect()
}

/// A row for each of `methods` among the runs.
pub fn compare(
    case: &Case<'_>,
    (part, judge): (Part, &Judge),
    runs: &[(Method, Run)],
    methods: &[Method],
    rows: &mut Vec<Row>,
) {
    let asked = runs.iter().filter(|(method, _)| methods.contains(method));
    rows.extend(asked.map(|(method, run)| {
        let figures = judge.compare(&run.exitance);
        Row { figures, ..Row::new(part, case, *method, run) }
    }));
}
