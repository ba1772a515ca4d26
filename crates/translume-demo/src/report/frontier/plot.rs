//! Error against time, a line for each kind of method: the further down and to the left the better.

use super::entrant::Family;
use super::row::{Row, Truth};
use crate::report::axis::{self, COLOURS, Drawn, chart, legend};
use plotters::coord::Shift;
use plotters::prelude::*;

const PANEL: (u32, u32) = (600, 440);
/// Pixels of the PNG per unit of the SVG.
const SCALE: u32 = 2;

/// Both truths side by side.
const PANELS: [(Truth, &str); 2] = [
    (Truth::Converged, "against the integral of the same profile"),
    (Truth::Traced, "against light followed through the volume"),
];

/// A line's points: ms and relative error.
type Line = (Family, Vec<(f64, f64)>);

/// Of one scene, or of all: then each point is the geometric mean over the scenes where that setting ran.
pub fn svg(rows: &[Row], title: &str) -> Result<String, String> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (2 * PANEL.0, PANEL.1)).into_drawing_area();
        draw(&root, rows, title, 1.0).map_err(|error| error.to_string())?;
        root.present().map_err(|error| error.to_string())?;
    }
    Ok(text)
}

/// The same as pixels: width, and RGB of 8 bits.
pub fn pixels(rows: &[Row], title: &str) -> Result<(u32, Vec<u8>), String> {
    let (width, height) = (2 * PANEL.0 * SCALE, PANEL.1 * SCALE);
    let mut buffer = vec![255; 3 * (width * height) as usize];
    {
        let root = BitMapBackend::with_buffer(&mut buffer, (width, height)).into_drawing_area();
        draw(&root, rows, title, f64::from(SCALE)).map_err(|error| error.to_string())?;
        root.present().map_err(|error| error.to_string())?;
    }
    Ok((width, buffer))
}

fn draw<B: DrawingBackend>(root: &DrawingArea<B, Shift>, rows: &[Row], title: &str, scale: f64) -> Drawn<B> {
    axis::fonts();
    root.fill(&WHITE)?;
    for (panel, (truth, what)) in root.split_evenly((1, PANELS.len())).iter().zip(PANELS) {
        let lines = lines(rows, truth);
        let points: Vec<_> = lines.iter().flat_map(|(_, points)| points).copied().collect();
        let mut chart = chart(panel, &format!("{title} {what}"), "radiance", &points, scale)?;
        for (family, points) in &lines {
            let k = Family::ALL.iter().position(|known| known == family).unwrap_or(0);
            let colour = COLOURS[k % COLOURS.len()];
            let size = (scale * if family.is_dual() { 5.0 } else { 3.5 }) as i32;
            let style = colour.stroke_width((scale * if family.is_dual() { 2.5 } else { 1.2 }) as u32);
            chart.draw_series(LineSeries::new(frontier(points), style))?;
            chart
                .draw_series(points.iter().map(|point| Circle::new(*point, size, colour.filled())))?
                .label(family.name())
                .legend(move |(x, y)| Circle::new((x + 8, y), size, colour.filled()));
        }
        legend(&mut chart, SeriesLabelPosition::UpperRight, scale)?;
    }
    Ok(())
}

/// Points of each family; those of several scenes that stand for one setting become one.
fn lines(rows: &[Row], truth: Truth) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for family in Family::ALL {
        let own: Vec<&Row> = rows.iter().filter(|row| row.family == family && !row.is_model).collect();
        let mut settings: Vec<&str> = own.iter().map(|row| row.setting.as_str()).collect();
        settings.sort_unstable();
        settings.dedup();
        let mean = |setting: &str| {
            let of_setting = own.iter().filter(|row| row.setting == setting);
            let logs: Vec<(f64, f64)> = of_setting
                .filter_map(|row| row.point(truth))
                .map(|(ms, error)| (ms.max(0.01).ln(), error.max(1e-5).ln()))
                .collect();
            let count = logs.len() as f64;
            let (ms, error) = logs.iter().fold((0.0, 0.0), |sum, log| (sum.0 + log.0, sum.1 + log.1));
            (count > 0.0).then(|| ((ms / count).exp(), (error / count).exp()))
        };
        let mut points: Vec<_> = settings.into_iter().filter_map(mean).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        if !points.is_empty() {
            lines.push((family, points));
        }
    }
    lines
}

/// Points than which no other of the line is both faster and better, by time.
fn frontier(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut least = f64::INFINITY;
    let better = |point: &&(f64, f64)| {
        let is_better = point.1 < least;
        least = least.min(point.1);
        is_better
    };
    points.iter().filter(better).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::super::row::example;
    use super::*;

    #[test]
    fn what_is_slower_and_worse_is_off_the_line() {
        let points = [(1.0, 0.2), (2.0, 0.3), (3.0, 0.1), (4.0, 0.1)];
        assert_eq!(frontier(&points), [(1.0, 0.2), (3.0, 0.1)]);
    }

    #[test]
    fn both_kinds_of_file_show_something() {
        let rows = [example(Family::Dual, 10.0, 0.01), example(Family::ScreenSpace, 2.0, 0.3)];
        let text = svg(&rows, "egg").unwrap();
        assert!(
            text.starts_with("<svg") && text.contains("dual tree") && text.contains("screen-space diffusion")
        );
        let (width, buffer) = pixels(&rows, "egg").unwrap();
        assert_eq!(buffer.len() % (3 * width as usize), 0);
        let dark = |buffer: &[u8]| buffer.iter().filter(|c| **c < 128).count();
        assert!(dark(&buffer) > 2000, "letters and lines: {}", dark(&buffer));
        let (_, empty) = pixels(&[], "").unwrap();
        assert!(dark(&empty) < dark(&buffer));
    }
}
