//! Stability: every hard case by every way, and what must hold of it.
//!
//! A row is a scene; its columns are the ways to compute it. Of every row every way must return numbers that are finite and not negative and
//! keep the bound of energy: nothing gives back more than its total reflectance of the largest irradiance. Beyond that each row says what
//! limit, order or darkness it must have. `-- --nocapture stability` prints the figures as the tables of docs/accuracy.md.

mod breaking;
mod demand;
mod lights;
mod media;
mod scene;
mod shapes;
mod way;

use demand::{Demand, Figure, brightest, excess, unsound};
use scene::Scene;
use translume_tests::{Check, gpu, holds};
use way::{Column, Way, totals};

/// A hard case.
struct Row {
    name: &'static str,
    scene: Scene,
    /// How far single texels may exceed the bound of energy, by all pairs; the comment of a row says why if it is not [`ROUNDING`].
    excess: f64,
    demands: Vec<Demand>,
    /// The ways that are not taken, with the reason in the row's comment.
    without: &'static [&'static str],
}

/// Interpolation in the kernel table: test `closure` measured 0.11 %.
const ROUNDING: f64 = 2e-3;

fn row(name: &'static str, scene: Scene, demands: Vec<Demand>) -> Row {
    Row { name, scene, excess: ROUNDING, demands, without: &[] }
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

    fn figures(&self, way: &Way) -> Vec<Figure> {
        let glow = way.glow(&self.scene);
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
            let totals = totals(&way.profile(), &self.scene.medium);
            let measured = excess(&glow, totals, self.scene.faces);
            figures.push(figure("above the bound of energy", [measured, self.allowance(way)]));
            assert!(brightest(&glow) > 0.0 || unsound(&glow) > 0.0, "{}: no light to judge", self.name);
        }
        for demand in self.demands.iter().filter(|demand| demand.applies(way)) {
            figures.push(figure(demand.name(), demand.measure(way, &self.scene, &glow)));
        }
        figures
    }

    fn allowance(&self, way: &Way) -> f64 {
        self.excess + slack(way)
    }
}

/// What a way may add to the bound of energy at single receivers.
fn slack(way: &Way) -> f64 {
    match way {
        Way::Method("all pairs", _) | Way::Pairs | Way::Converged => 0.0,
        _ => 0.05,
    }
}

/// Runs every row by every way; says of which figures there are too many.
fn judge(title: &str, rows: &[Row]) -> Check {
    let ways = Way::all();
    let mut figures = Vec::new();
    for row in rows {
        let start = std::time::Instant::now();
        let taken = ways.iter().filter(|way| !row.without.contains(&way.name()));
        figures.extend(taken.flat_map(|way| row.figures(way)));
        eprintln!("{}: {:.2} s", row.name, start.elapsed().as_secs_f64());
    }
    print(title, &figures);
    let problems: Vec<String> = figures.iter().filter_map(|figure| figure.check().err()).collect();
    if problems.is_empty() { Ok(()) } else { Err(problems.join("\n")) }
}

/// A line per row and demand; in each column what comes closest to its bound.
fn print(title: &str, figures: &[Figure]) {
    let mut lines = format!("| {title} | what must hold | methods | profiles | points | CPU |\n");
    lines += "| --- | --- | --- | --- | --- | --- |\n";
    let mut rest = figures.to_vec();
    while let Some(Figure { row, demand, .. }) = rest.first().cloned() {
        let (line, others): (Vec<_>, Vec<_>) =
            rest.into_iter().partition(|figure| (figure.row, figure.demand) == (row, demand));
        rest = others;
        let cells = Column::ALL.map(|column| cell(line.iter().filter(|figure| figure.column == column)));
        lines += &format!("| {row} | {demand} | {} |\n", cells.join(" | "));
    }
    eprintln!("\n{lines}");
}

fn cell<'a>(figures: impl Iterator<Item = &'a Figure>) -> String {
    // NaN comes closest of all.
    let over = |figure: &Figure| figure.measured - figure.bound;
    let worst = figures.max_by(|a, b| over(a).total_cmp(&over(b)));
    worst.map_or("–".to_owned(), |Figure { measured, bound, way, .. }| format!("{measured:.1e} (≤ {bound:.0e}) {way}"))
}

#[test]
fn media_hold() {
    holds(judge("medium", &media::rows()));
}

#[test]
fn lights_hold() {
    holds(judge("light", &lights::rows()));
}

#[test]
fn shapes_hold() {
    holds(judge("shape", &shapes::rows()));
}

/// The adapter's name for the figures.
#[test]
fn the_adapter_is_named() {
    eprintln!("stability on {}", gpu().adapter_name);
    assert!(!gpu().adapter_name.is_empty());
}
