//! Colours, logarithmic axes and legend of all plots.

use plotters::coord::Shift;
use plotters::prelude::*;

pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub type Drawn<T = ()> = Result<T, DrawingAreaErrorKind<std::io::Error>>;
pub type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;

/// Four that a colour-blind eye tells apart. Source: Okabe and Ito, "Color Universal Design".
pub const COLOURS: [RGBColor; 4] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(204, 121, 167)];

/// Around all values, with some room.
fn range(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    if low > high { 0.1..10.0 } else { 0.7 * low..1.4 * high }
}

/// Powers of ten around a range: without one an axis would have no figures.
fn decades(range: std::ops::Range<f64>) -> std::ops::Range<f64> {
    10.0_f64.powf(range.start.log10().floor())..10.0_f64.powf(range.end.log10().ceil())
}

/// To three digits.
fn rounded(value: f64) -> f64 {
    let unit = 10.0_f64.powf(value.abs().max(1e-9).log10().floor() - 2.0);
    ((value / unit).round() * unit * 1e6).round() / 1e6
}

/// A panel with room for these points, ms and relative error. `what`: over the mean of which errors are.
pub fn chart<'a, 'b>(
    panel: &'a Area<'b>,
    title: &str,
    what: &str,
    points: &[(f64, f64)],
) -> Drawn<Chart<'a, 'b>> {
    let mut chart = ChartBuilder::on(panel)
        .caption(title, ("sans-serif", 18))
        .margin(10)
        .x_label_area_size(40)
        .y_label_area_size(64)
        .build_cartesian_2d(
            decades(range(points.iter().map(|point| point.0))).log_scale(),
            decades(range(points.iter().map(|point| point.1))).log_scale(),
        )?;
    chart
        .configure_mesh()
        .max_light_lines(0)
        .x_labels(6)
        .x_desc("ms")
        .y_desc(format!("RMS error / mean {what}, %"))
        .x_label_formatter(&|ms| format!("{}", rounded(*ms)))
        .y_label_formatter(&|error| format!("{}", rounded(100.0 * error)))
        .draw()?;
    Ok(chart)
}

/// What the colours stand for, where lines seldom are: error falls as time grows.
pub fn legend<'a, 'b: 'a>(chart: &mut Chart<'a, 'b>) -> Drawn {
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK)
        .draw()
}
