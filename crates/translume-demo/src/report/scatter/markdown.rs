//! Rows for people.

use super::row::{Part, Row};
use super::{bounds, plan::Plan};
use crate::report::date;
use crate::report::method;
use translume::Method;
use translume_reference::metrics::Metrics;

/// Tables, and what their figures mean.
pub fn page(rows: &[Row], plan: &Plan, adapter: &str) -> String {
    let command: Vec<_> = std::env::args().skip(1).collect();
    let judged: Vec<_> = rows.iter().filter_map(bounds::broken).collect();
    let kept = judged.iter().filter(|broken| broken.is_empty()).count();
    let mut text = format!(
        "# Scatter against all pairs and against the integral\n\n`translume {}`\n\n{}, {adapter}. {kept} of {} lines with bounds keep them.\n\n",
        command.join(" "),
        date::today(),
        judged.len(),
    );
    text += &legend(plan);
    text += &bounds::legend();
    text += &section(rows, Part::AllPairs, "Against all pairs", ALL_PAIRS, |row| {
        format!(
            "{} | {}² | {} | {} | {} | {} | {} | {} | {:.2} | {} | {}",
            row.scene,
            row.atlas,
            row.medium,
            method::words(row.method),
            row.pairs.map_or("–".to_owned(), |pairs| format!("{pairs:.1}")),
            percent(row, |f| f.relative_rmse),
            percent(row, |f| f.relative_p99),
            percent(row, |f| f.bias),
            row.time_ms,
            row.overflow.map_or("–".to_owned(), |overflow| overflow.to_string()),
            bounds::words(row),
        )
    });
    text += &total(rows);
    text += &section(rows, Part::Transmitted, "Light that comes through", TRANSMITTED, |row| {
        format!(
            "{} | {} | {} | {} | {} | {}",
            row.scene,
            row.medium,
            method::words(row.method),
            percent(row, |f| f.bias),
            percent(row, |f| f.relative_rmse),
            bounds::words(row),
        )
    });
    text += &section(rows, Part::Times, "Times", TIMES, |row| {
        let times = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.2}"));
        format!(
            "{} | {} | {}² | {} | {}{:.2} | {} | {} | {}",
            row.scene,
            method::words(row.method),
            row.atlas,
            row.texels,
            if row.speed.extrapolated { "≈ " } else { "" },
            row.time_ms,
            times(row.speed.growth),
            times(row.speed.gain),
            bounds::words(row),
        )
    });
    text
}

const ALL_PAIRS: &str = "\
| scene | atlas | medium | method | evaluations | error, % | p99, % | bias, % | ms | overflow | bound |
| --- | --- | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | --- |";
const TOTAL: &str = "\
| scene | medium | atlas | dual: error, % | bias, % | pattern: error, % | bias, % |
| --- | --- | --- | ---: | ---: | ---: | ---: |";
const TRANSMITTED: &str = "\
| scene | medium | method | error of the mean, % | error, % | bound |
| --- | --- | --- | ---: | ---: | --- |";
const TIMES: &str = "\
| scene | method | atlas | texels | ms | growth | all pairs over this | bound |
| --- | --- | --- | ---: | ---: | ---: | ---: | --- |";

fn section(rows: &[Row], part: Part, title: &str, head: &str, line: impl Fn(&Row) -> String) -> String {
    let mut text = format!("\n## {title}\n\n{head}\n");
    for row in rows.iter().filter(|row| row.part == part) {
        text += &format!("| {} |\n", line(row));
    }
    text
}

/// Both methods on one line.
fn total(rows: &[Row]) -> String {
    let of = |method| rows.iter().filter(move |row| row.part == Part::Converged && row.method == method);
    let mut text = format!("\n## Against the integral\n\n{TOTAL}\n");
    for (dual, pattern) in of(Method::default()).zip(of(Method::Pattern)) {
        text += &format!(
            "| {} | {} | {}² | {} | {} | {} | {} |\n",
            dual.scene,
            dual.medium,
            dual.atlas,
            percent(dual, |f| f.relative_rmse),
            percent(dual, |f| f.bias),
            percent(pattern, |f| f.relative_rmse),
            percent(pattern, |f| f.bias),
        );
    }
    text
}

fn percent(row: &Row, of: fn(&Metrics) -> f64) -> String {
    row.figures.as_ref().map_or("–".to_owned(), |figures| format!("{:.2}", 100.0 * of(figures)))
}

fn legend(plan: &Plan) -> String {
    let texels = |samples: usize| match plan.every {
        Some(every) => format!("every {every}th texel"),
        None => format!("about {samples} texels, an odd number apart in their order"),
    };
    format!(
        "\
Models are 100 mm from corner to corner, in a directional light from (.4, .7, .6); the sheet is 50 mm wide and 1 mm thick and has a lamp 5.5 mm below its other side too; the
twisted model turns by 90° from foot to top. Nothing casts shadows. Sources are read back from the GPU, so that what is measured is the scatter alone.

- **Against all pairs**: the same sum over all pairs of texels, in double precision with the same profile averaged over discs by quadrature, at {all}.
- **Against the integral**: the dipole integrated over the triangles themselves (`translume_reference::converged`), at the middle of {total}: what the sampling by texels costs is included.
- **error**: RMS of the difference over the mean of the reference, all three channels together. **p99**: what 99 % of the absolute differences stay below, over the same mean.
  **bias**: mean difference over the mean; negative is too dark.
- **evaluations**: of the kernel, per texel; where a group of texels shares one it is shared out. For the pattern: of its 57 samples those that hit the surface.
- **overflow**: groups of texels that found no room in the lists of the dual scatter.
- **Light that comes through**: a slab of 4 mm lit from below and a model lit from behind, at those texels that no light reaches and below which the body is thinnest (the thinnest
  tenth of them), against the integral.
- **ms**: the scatter stage alone, from submission until the device is idle, median of {few}, of {many} under Times, fewer where two seconds have gone by. **growth**: for four times as many texels, from the next smaller atlas.
  All pairs were timed once, up to {measured}²; ≈ follows from that by the square of the number of texels.
- **pattern**: 7 × 7 samples in a square of the atlas and eight squares like that around it (Gong et al. 2008); the square reaches 5 mean free paths to each side, where its error is least.
  Its kernel is the dipole of a point, so it explodes where mean free paths are far below a texel (spectralon).

",
        all = texels(plan.samples),
        total = texels(plan.converged_samples),
        few = plan.repeats.timed,
        many = plan.times_repeats.timed,
        measured = plan.all_pairs_sizes.iter().max().copied().unwrap_or(0),
    )
}
