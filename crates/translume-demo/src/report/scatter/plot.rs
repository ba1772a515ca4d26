//! Error against time.

use super::row::{Part, Row};
use crate::report::axis::{Area, COLOURS, Drawn, chart, legend};
use plotters::prelude::*;
use translume::Method;

const PANEL: (u32, u32) = (560, 400);

/// Methods of one kind, drawn alike.
const FAMILIES: [&str; 3] = ["dual", "tree", "pattern"];

fn family(method: Method) -> Option<usize> {
    match method {
        Method::Tree { .. } => Some(1),
        Method::Pattern => Some(2),
        Method::AllPairs => None,
        _ => Some(0),
    }
}

/// A panel for each scene and atlas: ms and relative error against all pairs, a line for each medium and kind of method.
pub fn svg(rows: &[Row]) -> Result<String, String> {
    let rows: Vec<&Row> = rows.iter().filter(|row| row.part == Part::AllPairs).collect();
    let mut cases: Vec<(&str, u32)> = rows.iter().map(|row| (row.scene.as_str(), row.atlas)).collect();
    cases.dedup();
    let columns = cases.len().clamp(1, 2);
    let lines = cases.len().div_ceil(columns).max(1);
    let mut text = String::new();
    let size = (PANEL.0 * columns as u32, PANEL.1 * lines as u32);
    let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
    root.fill(&WHITE).map_err(|error| error.to_string())?;
    let panels = root.split_evenly((lines, columns));
    for (panel, &(scene, atlas)) in panels.iter().zip(&cases) {
        let own: Vec<&Row> =
            rows.iter().filter(|row| (row.scene.as_str(), row.atlas) == (scene, atlas)).copied().collect();
        draw(panel, &format!("{scene}, {atlas}²"), &own).map_err(|error| error.to_string())?;
    }
    root.present().map_err(|error| error.to_string())?;
    drop(panels);
    drop(root);
    Ok(text)
}

/// A logarithmic axis has no place for 0.
fn point(row: &Row) -> Option<(f64, f64)> {
    row.figures.as_ref().map(|figures| (row.time_ms.max(0.01), figures.relative_rmse.max(1e-4)))
}

fn draw<'a>(panel: &Area<'a>, title: &str, rows: &[&Row]) -> Drawn<SVGBackend<'a>> {
    let points: Vec<_> = rows.iter().filter_map(|row| point(row)).collect();
    let mut chart = chart(panel, title, "exitance", &points, 1.0)?;
    for (k, name) in FAMILIES.into_iter().enumerate() {
        let colour = COLOURS[k].filled();
        let mut media: Vec<&str> = rows.iter().map(|row| row.medium).collect();
        media.dedup();
        for (n, medium) in media.into_iter().enumerate() {
            let own = rows.iter().filter(|row| row.medium == medium && family(row.method) == Some(k));
            let line = own.filter_map(|row| point(row));
            let series = LineSeries::new(line, colour.stroke_width(1)).point_size(3);
            let series = chart.draw_series(series)?;
            if n == 0 {
                series
                    .label(name)
                    .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour.stroke_width(2)));
            }
        }
    }
    legend(&mut chart, SeriesLabelPosition::LowerLeft, 1.0)
}
