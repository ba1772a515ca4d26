//! Every method in every scene: time, and the distance from both truths.

mod dominance;
mod entrant;
mod flip;
mod judge;
mod page;
mod plot;
mod row;
pub(super) mod scenes;
pub mod shot;
pub(super) mod stage;
mod summary;
pub(super) mod truth;

use super::bench::Repeats;
use super::{prepare_folder, write};
use crate::cli::Report;
use crate::error::Error;
use crate::gpu::Gpu;
use crate::picture::{Output, Picture};
use crate::progress;
use entrant::{Entrant, Family, default_profile};
use indicatif::ProgressBar;
use page::Section;
use row::Row;
use scenes::Source;
use shot::Shot;
use stage::Stage;
use std::path::Path;
use std::time::Duration;
use summary::Summary;
use translume::{Config, Translume};
use truth::{Patience, Truths};

/// For pictures whose time is of no interest, or so long that nothing is left to warm up.
const ONCE: Repeats = Repeats { warm_up: 0, timed: 1 };

struct Study<'a> {
    gpu: &'a Gpu,
    translume: &'a Translume,
    quick: bool,
    folder: &'a Path,
    bar: &'a ProgressBar,
}

pub fn run(arguments: &Report) -> Result<(), Error> {
    prepare_folder(&arguments.output)?;
    let mut sources: Vec<Source> = arguments.models.iter().map(|name| scenes::named(name)).collect();
    if arguments.suite.is_some() || sources.is_empty() {
        sources.extend(scenes::own(arguments.quick));
    }
    let gpu = Gpu::new()?;
    let translume = Translume::new(&gpu.device, &Config::default())?;
    let bar = progress::bar("report");
    bar.set_length(sources.len() as u64);
    let study = Study {
        gpu: &gpu,
        translume: &translume,
        quick: arguments.quick,
        folder: &arguments.output,
        bar: &bar,
    };
    let (mut sections, mut rows) = (Vec::new(), Vec::new());
    for source in &sources {
        sections.push(study.scene(source, &mut rows)?);
        study.write(&sections, &rows)?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    progress::tell(&format!(
        "{}: {} scenes, {} rows, on {}",
        arguments.output.join("index.html").display(),
        sections.len(),
        rows.len(),
        gpu.adapter
    ));
    Ok(())
}

impl Study<'_> {
    fn scene(&self, source: &Source, rows: &mut Vec<Row>) -> Result<Section, Error> {
        let stage = Stage::open(source)?;
        let told = |what: &str| self.bar.set_message(format!("{}: {what}", stage.name));
        let patience = if self.quick {
            Patience { samples: 60, noise: 0.1, most: Duration::from_secs(3) }
        } else {
            // A pixel's integrals take some ten milliseconds, and so many tell an error to about 5 %.
            Patience { samples: 250, noise: 0.03, most: Duration::from_secs(8) }
        };
        let mut wanted: Vec<&'static str> = Vec::new();
        for Entrant { profile, .. } in entrant::all(self.quick) {
            if !wanted.contains(&profile) {
                wanted.push(profile);
            }
        }
        let truths = Truths::new(&stage, &wanted, patience, &told)?;
        if let Some(traced) = &truths.traced {
            log::info!("{}: {} paths a pixel in {:.1} s", stage.name, traced.samples, traced.seconds);
        }
        let repeats =
            if self.quick { Repeats { warm_up: 1, timed: 1 } } else { Repeats { warm_up: 1, timed: 2 } };
        let mut shot = Shot::new(self.gpu, self.translume, &stage);
        let mut kept = Vec::new();
        let first = rows.len();
        for (entrant, is_model) in self.entrants(&truths) {
            told(&format!("{}, {}", entrant.family.name(), entrant.setting));
            let repeats = if is_model || entrant.is_slow() { ONCE } else { repeats };
            let Some(taken) = shot.take(&entrant, repeats)? else { continue };
            let radiance: Vec<[f32; 3]> = taken.picture.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect();
            let verdict = judge::judge(&truths, entrant.profile, &radiance);
            rows.push(Row::new(&stage.name, &entrant, is_model, &taken, verdict));
            if !is_model {
                kept.retain(|(family, _, _): &(Family, String, Vec<[f32; 3]>)| *family != entrant.family);
                kept.push((entrant.family, entrant.setting, radiance));
            }
        }
        let own = &rows[first..];
        Ok(Section {
            summary: summary(&truths, own),
            pictures: self.pictures(&stage, &truths, &kept)?,
            plot: plot::svg(own, &stage.name).map_err(|problem| self.blame(&problem))?,
            name: stage.name,
            purpose: stage.purpose,
        })
    }

    fn entrants(&self, truths: &Truths) -> Vec<(Entrant, bool)> {
        let models = if truths.traced.is_some() && !self.quick { entrant::profiles() } else { Vec::new() };
        let runners = entrant::all(self.quick).into_iter().map(|entrant| (entrant, false));
        runners.chain(models.into_iter().map(|entrant| (entrant, true))).collect()
    }

    /// The truths, and the best setting of those who look different.
    fn pictures(
        &self,
        stage: &Stage,
        truths: &Truths,
        kept: &[(Family, String, Vec<[f32; 3]>)],
    ) -> Result<Vec<(String, String, Option<String>)>, Error> {
        let folder = self.folder.join(&stage.name);
        prepare_folder(&folder)?;
        let mut all = Vec::new();
        let traced = truths.traced.as_ref().and_then(|traced| truths.shown(&traced.radiance));
        let best = kept.iter().find(|(family, ..)| *family == Family::Dual);
        let reference = traced.clone().or_else(|| truths.shown(&best?.2));
        let mut add = |caption: String, name: &str, picture: &Picture, with_difference: bool| {
            let file = |ending: &str| format!("{name}{ending}.png");
            Output::new(&folder.join(file("")))?.write(std::slice::from_ref(picture))?;
            let difference = reference.as_ref().filter(|_| with_difference);
            let flip = difference.and_then(|reference| flip::compare(reference, picture));
            if let Some(flip) = &flip {
                Output::new(&folder.join(file("-flip")))?.write(std::slice::from_ref(&flip.map))?;
            }
            let path = |ending| format!("{}/{}", stage.name, file(ending));
            all.push((caption, path(""), flip.map(|_| path("-flip"))));
            Ok::<(), Error>(())
        };
        if let Some(picture) = &traced {
            add("paths".to_owned(), "paths", picture, false)?;
        }
        let pictured = [Family::Dual, Family::Pattern, Family::ShadowMap, Family::ScreenSpace];
        for (family, setting, radiance) in kept.iter().filter(|(family, ..)| pictured.contains(family)) {
            if let Some(picture) = truths.shown(radiance) {
                let name = family.name().replace([' ', '\''], "-");
                add(format!("{}, {setting}", family.name()), &name, &picture, true)?;
            }
        }
        Ok(all)
    }

    fn write(&self, sections: &[Section], rows: &[Row]) -> Result<(), Error> {
        let title = "All scenes";
        let overview = plot::svg(rows, title).map_err(|problem| self.blame(&problem))?;
        write(self.folder, "pareto.svg", &overview)?;
        let (width, pixels) = plot::pixels(rows, title).map_err(|problem| self.blame(&problem))?;
        let picture = Picture::from_bytes(width, &pixels);
        Output::new(&self.folder.join("pareto.png"))?.write(&[picture])?;
        write(self.folder, "report.csv", &row::csv(rows, &self.gpu.adapter))?;
        write(self.folder, "index.html", &page::html(sections, rows, &overview, &self.gpu.adapter))
    }

    fn blame(&self, problem: &str) -> Error {
        let problem = format!("cannot be drawn: {problem}");
        Error::Output { path: self.folder.join("pareto.svg"), problem }
    }
}

fn summary(truths: &Truths, rows: &[Row]) -> Summary {
    let (size, tolerance) = (512, "1 %");
    let of_default = |row: &&Row| row.family == Family::Dual && !row.is_model;
    let default = rows
        .iter()
        .filter(of_default)
        .find(|row| row.setting == format!("{size}², {tolerance}"))
        .or_else(|| rows.iter().rfind(of_default));
    let model =
        truths.traced.as_ref().zip(truths.converged(default_profile())).and_then(|(traced, integral)| {
            let [radiance, error] = [&traced.radiance, &traced.error].map(|picture| truths.sampled(picture));
            judge::against(integral, &radiance, Some(&error))
        });
    let verdict = default.map(|row| row.verdict.clone()).unwrap_or_default();
    Summary {
        quadrature: verdict.quadrature,
        model,
        total: verdict.total,
        flip: verdict.flip,
        noise: verdict.noise,
        untraced: truths.untraced.clone(),
    }
}
