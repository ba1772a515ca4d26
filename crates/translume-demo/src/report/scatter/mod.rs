//! The suite `scatter`: radiant exitance by every method, its error beside its cost.

mod accuracy;
mod all_pairs;
mod bench;
mod bounds;
mod judge;
mod markdown;
mod plan;
mod plot;
mod row;
mod scene;
mod times;
mod transmission;

use super::{prepare_folder, write};
use crate::cli::Report;
use crate::error::Error;
use crate::gpu::Gpu;
use crate::progress;
use crate::render::check_atlas;
use indicatif::ProgressBar;
use plan::Plan;
use row::Row;
use std::path::Path;
use translume::{Config, Translume};

/// What every part of the suite needs.
struct Study<'a> {
    gpu: &'a Gpu,
    translume: &'a Translume,
    plan: &'a Plan,
    bar: &'a ProgressBar,
}

pub fn run(arguments: &Report) -> Result<(), Error> {
    prepare_folder(&arguments.output)?;
    let gpu = Gpu::new()?;
    let plan = Plan::new(arguments);
    check_atlas(plan.largest(), &gpu)?;
    let translume = Translume::new(&gpu.device, &Config::default())?;
    let bar = progress::bar("scatter");
    bar.set_length(plan.steps());
    let study = Study { gpu: &gpu, translume: &translume, plan: &plan, bar: &bar };
    let mut rows = Vec::new();
    for kind in &plan.scenes {
        accuracy::measure(&study, kind, &mut rows)?;
        write_all(&arguments.output, &rows, &plan, &gpu.adapter)?;
    }
    transmission::measure(&study, &mut rows)?;
    times::measure(&study, &mut rows)?;
    bar.finish_and_clear();
    write_all(&arguments.output, &rows, &plan, &gpu.adapter)?;
    progress::tell(&format!("{}: {} rows, on {}", arguments.output.display(), rows.len(), gpu.adapter));
    Ok(())
}

fn write_all(folder: &Path, rows: &[Row], plan: &Plan, adapter: &str) -> Result<(), Error> {
    write(folder, "scatter.csv", &row::csv(rows, adapter))?;
    write(folder, "scatter.md", &markdown::page(rows, plan, adapter))?;
    let drawn = plot::svg(rows).map_err(|problem| Error::Output {
        path: folder.join("scatter.svg"),
        problem: format!("cannot be drawn: {problem}"),
    })?;
    write(folder, "scatter.svg", &drawn)
}
