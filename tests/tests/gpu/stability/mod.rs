//! Stability: every hard case by every way, and what must hold of it.
//!
//! A row is a scene; its columns are the ways to compute it. Of every row every way must return numbers that are finite and not negative and
//! keep the bound of energy: nothing gives back more than its total reflectance of the largest irradiance. Beyond that each row says what
//! limit, order or darkness it must have. `-- --nocapture stability` prints the figures as the tables of docs/accuracy.md.

#![allow(clippy::print_stderr, reason = "measured figures, for `--nocapture`")]

mod breaking;
mod demand;
mod frames;
mod inputs;
mod lights;
mod media;
mod scene;
mod shapes;
mod way;

use demand::{Demand, Figure, brightest, excess, excess_in_all, unsound};
use scene::Scene;
use translume_tests::{Check, gpu, holds};
use way::{Bodies, Column, Way, ceiling};

/// A hard case.
struct Row {
    name: &'static str,
    scene: Scene,
    /// How far single texels may exceed the bound of energy, by all pairs; the comment of a row says why if it is not [`ROUNDING`].
    excess: f64,
    demands: Vec<Demand>,
    /// The ways that are not taken, with the reason in the row's comment.
    without: &'static [&'static str],
    /// The ways whose figures have no bound here, with the reason in the row's comment: printed, finite and not negative, no more.
    unbounded: &'static [&'static str],
}

/// On a sphere of texels of 0.7 mean free paths: discs of two charts overlap along seams. Measured 9 %.
const SEAMS: f64 = 0.1;

/// Where texels are far wider than light wanders, the corner of three charts holds four discs at most. Measured 2.1.
const CORNERS: f64 = 2.5;

/// Interpolation in the kernel table: test `closure` measured 0.11 %.
const ROUNDING: f64 = 2e-3;

fn row(name: &'static str, scene: Scene, demands: Vec<Demand>) -> Row {
    Row { name, scene, excess: ROUNDING, demands, without: &[], unbounded: &[] }
}

impl Row {
    fn excess(mut self, share: f64) -> Self {
        self.excess = share;
        self
    }

    fn without(mut self, ways: &'static [&'static str]) -> Self {
        self.without = ways;
        self
    }

    fn unbounded(mut self, ways: &'static [&'static str]) -> Self {
        self.unbounded = ways;
        self
    }

    fn figures(&self, way: &Way, bodies: &mut Bodies) -> Vec<Figure> {
        let glow = way.glow(&self.scene, bodies);
        let loose = self.unbounded.contains(&way.name());
        let bounded = |[measured, bound]: [f64; 2]| [measured, if loose { f64::INFINITY } else { bound }];
        let figure = |demand, [measured, bound]: [f64; 2]| Figure {
            row: self.name,
            demand,
            way: way.name(),
            column: way.column(),
            measured,
            bound,
        };
        let mut figures = vec![figure("values not finite or negative", [unsound(&glow), 0.0])];
        if !self.demands.iter().any(|demand| matches!(demand, Demand::Dark)) {
            let totals = ceiling(way, &self.scene.medium);
            let measured = excess(&glow, totals, self.scene.faces);
            figures.push(figure(
                "brightest, above the bound of energy",
                bounded([measured, self.allowance(way)]),
            ));
            // Two faces light each other.
            if let Some(measured) = excess_in_all(&glow, totals.map(|total| self.scene.faces * total)) {
                figures.push(figure(
                    "in all, above the bound of energy",
                    bounded([measured, self.allowance_in_all(way)]),
                ));
            }
            let dark = f64::from(u8::from(brightest(&glow) == 0.0));
            figures.push(figure("light to judge is missing", bounded([dark, 0.0])));
        }
        for demand in self.demands.iter().filter(|demand| demand.applies(way)) {
            figures.push(figure(demand.name(), bounded(demand.measure(way, &self.scene, &glow, bodies))));
        }
        figures
    }

    /// How far above the bound of energy the brightest receiver may be.
    fn allowance(&self, way: &Way) -> f64 {
        match way {
            Way::Method("all pairs", _) | Way::Pairs | Way::Converged => self.excess,
            // Samples of one weight, wherever they land in space; and sources that land on other parts of the surface: neither has a bound.
            _ if way.is_pattern() || way.is_oriented() => f64::INFINITY,
            // At seams the middles of two discs may be in one place. Measured 0.78.
            _ if way.is_peaked() && self.excess > ROUNDING => self.excess + 1.0,
            _ => self.excess + 0.05,
        }
    }

    /// The same of all that leaves.
    fn allowance_in_all(&self, way: &Way) -> f64 {
        // Wide texels measured 10 %, and 20 % where the body has but 17. Overlapping discs along seams weigh more where the profile is a peak, and totals of half-spaces are known to 1.5 %. Measured 14 % at
        // η = 2.4.
        let peak = if way.is_peaked() { 0.05 } else { 0.0 };
        if way.is_pattern() || way.is_oriented() { f64::INFINITY } else { self.excess.min(0.2) + 0.02 + peak }
    }
}

/// Runs every row by every way; says of which figures there are too many.
fn judge(title: &str, rows: &[Row], ways: &[Way]) -> Check {
    let mut figures = Vec::new();
    for row in rows {
        let mut bodies = Bodies::default();
        let taken = ways.iter().filter(|way| !row.without.contains(&way.name()) && way.knows(&row.scene));
        figures.extend(taken.flat_map(|way| row.figures(way, &mut bodies)));
    }
    print(title, &figures);
    let problems: Vec<String> = figures.iter().filter_map(|figure| figure.check().err()).collect();
    if problems.is_empty() { Ok(()) } else { Err(problems.join("\n")) }
}

/// What has a line only where it happens.
const NEVER: [&str; 2] = ["values not finite or negative", "light to judge is missing"];

/// A line per row and demand; in each column what comes closest to its bound.
fn print(title: &str, figures: &[Figure]) {
    let mut lines = format!("| {title} | what must hold | methods | profiles | points | CPU |\n");
    lines += "| --- | --- | --- | --- | --- | --- |\n";
    let mut rest = figures.to_vec();
    // What never happens needs no line.
    rest.retain(|figure| !NEVER.contains(&figure.demand) || figure.check().is_err());
    while let Some(Figure { row, demand, .. }) = rest.first().cloned() {
        let (line, others): (Vec<_>, Vec<_>) =
            rest.into_iter().partition(|figure| (figure.row, figure.demand) == (row, demand));
        rest = others;
        let cells = Column::ALL.map(|column| cell(line.iter().filter(|figure| figure.column == column)));
        lines += &format!("| {row} | {demand} | {} |\n", cells.join(" | "));
    }
    eprintln!("\n{}\n\n{lines}", gpu().adapter_name);
}

fn cell<'a>(figures: impl Iterator<Item = &'a Figure>) -> String {
    // NaN comes closest of all.
    let over = |figure: &&Figure| figure.measured - figure.bound;
    let (bounded, free): (Vec<_>, Vec<_>) = figures.partition(|figure| figure.bound.is_finite());
    let worst = bounded.into_iter().max_by(|a, b| over(a).total_cmp(&over(b)));
    let worst = worst.map(|f| format!("{} (≤ {}) {}", share(f.measured), share(f.bound), f.way));
    let free = free.into_iter().map(|f| format!("{} (no bound) {}", share(f.measured), f.way));
    let cell = worst.into_iter().chain(free).collect::<Vec<_>>().join("; ");
    if cell.is_empty() { "–".to_owned() } else { cell }
}

/// In per cent where that is readable.
fn share(value: f64) -> String {
    match value.abs() {
        x if (1e-5..10.0).contains(&x) => format!("{:.2} %", 100.0 * value),
        0.0 => "0".to_owned(),
        _ => format!("{value:.0e}"),
    }
}

#[test]
fn media_hold() {
    holds(judge("medium", &media::rows(), &Way::all()));
}

#[test]
fn lights_hold() {
    holds(judge("light", &lights::rows(), &Way::few()));
}

#[test]
fn shapes_hold() {
    holds(judge("shape", &shapes::rows(), &Way::few()));
}
