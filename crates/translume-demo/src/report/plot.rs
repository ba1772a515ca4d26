//! Error against time.

use super::axis::{COLOURS, decades, range, rounded};
use super::table::Row;
use super::trials::Sweep;
use plotters::coord::Shift;
use plotters::prelude::*;

const PANEL: [u32; 2] = [560, 400];
const SWEEPS: [(Sweep, &str); 3] = [
    (Sweep::Resolution, "width of the map"),
    (Sweep::Filter, "filter"),
    (Sweep::Samples, "points or directions"),
];

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
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

fn draw(
    panel: &Area<'_>,
    title: &str,
    lines: &[Line<'_>],
) -> Result<(), DrawingAreaErrorKind<std::io::Error>> {
    let points = || lines.iter().flat_map(|(_, points)| points);
    let mut chart = ChartBuilder::on(panel)
        .caption(title, ("sans-serif", 18))
        .margin(10)
        .x_label_area_size(40)
        .y_label_area_size(64)
        .build_cartesian_2d(
            decades(range(points().map(|point| point.0))).log_scale(),
            decades(range(points().map(|point| point.1))).log_scale(),
        )?;
    chart
        .configure_mesh()
        .max_light_lines(0)
        .x_labels(6)
        .x_desc("ms")
        .y_desc("RMS error / mean irradiance, %")
        .x_label_formatter(&|ms| format!("{}", rounded(*ms)))
        .y_label_formatter(&|error| format!("{}", rounded(100.0 * error)))
        .draw()?;
    for (k, (light, points)) in lines.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()].filled();
        let series = LineSeries::new(points.iter().copied(), colour.stroke_width(2)).point_size(3);
        chart
            .draw_series(series)?
            .label(*light)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour.stroke_width(2)));
    }
    // Error falls as time grows.
    let corner = SeriesLabelPosition::LowerLeft;
    chart
        .configure_series_labels()
        .position(corner)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK)
        .draw()
}
