//! The suite `gather`: irradiance of every texel in every kind of light, its error beside its cost.

use super::bench::{Bench, Repeats};
use super::subject::{self, Subject};
use super::table::{Header, Row};
use super::trials::{self, Trial, Truth};
use super::twin::{Reference, Twin};
use super::{flicker, plot, prepare_folder, table, write};
use crate::cli::Report;
use crate::error::Error;
use crate::gpu::Gpu;
use crate::progress;
use crate::render::check_atlas;
use indicatif::ProgressBar;
use std::path::Path;
use std::time::Instant;
use translume::{Config, Translume};

pub fn run(arguments: &Report) -> Result<(), Error> {
    prepare_folder(&arguments.output)?;
    let gpu = Gpu::new()?;
    check_atlas(arguments.atlas, &gpu)?;
    let translume = Translume::new(&gpu.device, &Config::default())?;
    let every = arguments.every.unwrap_or(if arguments.quick { 31 } else { 7 });
    let (warm_up, timed) = if arguments.quick { (1, 1) } else { (2, 5) };
    let header = Header { adapter: &gpu.adapter, atlas: arguments.atlas, every, timed };
    let mut rows = Vec::new();
    for name in subject::names(arguments) {
        let subject = Subject::open(&name, arguments.atlas)?;
        let bench = Bench::new(&gpu, &translume, &subject, Repeats { warm_up, timed })?;
        let twin = Twin::new(&subject, every as usize);
        let bar = progress::bar(&subject.name);
        Study { subject: &subject, bench, twin, rows: &mut rows, bar }.run(arguments.quick)?;
        write_all(&arguments.output, &rows, &header)?;
    }
    progress::tell(&format!("{}: {} rows, on {}", arguments.output.display(), rows.len(), gpu.adapter));
    Ok(())
}

fn write_all(folder: &Path, rows: &[Row], header: &Header<'_>) -> Result<(), Error> {
    write(folder, "gather.csv", &table::csv(rows, header))?;
    write(folder, "gather.md", &table::markdown(rows, header))?;
    let drawn = plot::svg(rows).map_err(|problem| Error::Output {
        path: folder.join("gather.svg"),
        problem: format!("cannot be drawn: {problem}"),
    })?;
    write(folder, "gather.svg", &drawn)
}

/// One subject on its way through all trials.
struct Study<'a> {
    subject: &'a Subject,
    bench: Bench<'a>,
    twin: Twin,
    rows: &'a mut Vec<Row>,
    bar: ProgressBar,
}

impl Study<'_> {
    fn run(mut self, quick: bool) -> Result<(), Error> {
        let trials = trials::trials(self.subject, &self.twin, quick)?;
        self.bar.set_length(trials.iter().map(|trial| 1 + trial.settings.len() as u64).sum());
        let mut reference = None;
        for trial in &trials {
            self.bar.set_message(trial.name);
            let start = Instant::now();
            reference = self.reference(&trial.truth, reference);
            let cast = start.elapsed().as_secs_f32();
            self.bar.inc(1);
            self.try_all(trial, reference.as_ref())?;
            let all = start.elapsed().as_secs_f32();
            log::info!("{}: reference {cast:.1} s, measurements {:.1} s", trial.name, all - cast);
        }
        if !self.subject.model.mesh.targets.is_empty() {
            self.bar.set_message("flicker");
            self.rows.extend(flicker::rows(&mut self.bench, self.subject, quick)?);
        }
        self.bar.finish_and_clear();
        Ok(())
    }

    fn try_all(&mut self, trial: &Trial, reference: Option<&Reference>) -> Result<(), Error> {
        for setting in &trial.settings {
            self.bench.set_shadows(setting.options)?;
            let dark = trial.lights.is_empty();
            let time = if dark { self.bench.dark_cost() } else { self.bench.cost(&trial.lights) }?;
            let found = self.bench.irradiance()?;
            self.rows.push(Row {
                scene: self.subject.name.clone(),
                light: trial.name.to_owned(),
                shadow: setting.shadow.clone(),
                figures: reference.and_then(|reference| reference.compare(&found)),
                time_ms: time,
                sweeps: setting.sweeps,
            });
            self.bar.inc(1);
        }
        Ok(())
    }

    fn reference(&self, truth: &Truth, before: Option<Reference>) -> Option<Reference> {
        match truth {
            Truth::None => None,
            Truth::Same => before,
            Truth::Rays { lights, samples, rays } => Some(self.twin.cast(lights, *samples, *rays)),
            Truth::Quadrature(map) => Some(self.twin.integrate(map)),
        }
    }
}
