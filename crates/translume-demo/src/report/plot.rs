//! Error against time.

use super::axis::{Area, COLOURS, Drawn, chart, legend};
use super::table::Row;
use super::trials::Sweep;
use plotters::prelude::*;

const PANEL: [u32; 2] = [560, 400];
const SWEEPS: [(Sweep, &str); 3] = [
    (Sweep::Resolution, "width of the map"),
    (Sweep::Filter, "filter"),
    (Sweep::Samples, "points or directions"),
];

/// One light with ever finer settings: ms and relative error.
type Line<'a> = (&'a str, Vec<(f64, f64)>);

/// A row of panels for each scene: in each panel one setting changes along the lines, a line for each kind of light.
pub fn svg(rows: &[Row]) -> Result<String, String> {
    let mut scenes: Vec<&str> = rows.iter().map(|row| row.scene.as_str()).collect();
    scenes.dedup();
    let mut text = String::new();
    let size = (PANEL[0] * SWEEPS.len() as u32, PANEL[1] * scenes.len().max(1) as u32);
    let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
    root.fill(&WHITE).map_err(|error| error.to_string())?;
    let panels = root.split_evenly((scenes.len().max(1), SWEEPS.len()));
    for (k, panel) in panels.iter().enumerate() {
        let (scene, (sweep, what)) = (scenes.get(k / SWEEPS.len()), SWEEPS[k % SWEEPS.len()]);
        let lines = scene.map(|scene| lines(rows, scene, sweep)).unwrap_or_default();
        let title = format!("{}: {what}", scene.unwrap_or(&""));
        draw(panel, &title, &lines).map_err(|error| error.to_string())?;
    }
    root.present().map_err(|error| error.to_string())?;
    drop(panels);
    drop(root);
    Ok(text)
}

fn lines<'a>(rows: &'a [Row], scene: &str, sweep: Sweep) -> Vec<Line<'a>> {
    let mut lines: Vec<Line<'a>> = Vec::new();
    for row in rows.iter().filter(|row| row.scene == scene && row.sweeps.contains(&sweep)) {
        let Some(figures) = &row.figures else { continue };
        // A logarithmic axis has no place for what is lost in the noise of the clock.
        let point = (row.time_ms.max(0.01), figures.relative_rmse.max(1e-4));
        match lines.iter_mut().find(|(light, _)| *light == row.light) {
            Some((_, points)) => points.push(point),
            None => lines.push((&row.light, vec![point])),
        }
    }
    lines
}

fn draw<'a>(panel: &Area<'a>, title: &str, lines: &[Line<'_>]) -> Drawn<SVGBackend<'a>> {
    let points: Vec<_> = lines.iter().flat_map(|(_, points)| points).copied().collect();
    let mut chart = chart(panel, title, "irradiance", &points, 1.0)?;
    for (k, (light, points)) in lines.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()].filled();
        let series = LineSeries::new(points.iter().copied(), colour.stroke_width(2)).point_size(3);
        chart
            .draw_series(series)?
            .label(*light)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour.stroke_width(2)));
    }
    legend(&mut chart, SeriesLabelPosition::LowerLeft, 1.0)
}
