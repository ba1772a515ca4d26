//! Colours, logarithmic axes and legend of all plots.

use plotters::coord::Shift;
use plotters::prelude::*;

pub type Area<'a, B = SVGBackend<'a>> = DrawingArea<B, Shift>;
pub type Drawn<B, T = ()> = Result<T, DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;
pub type Chart<'a, B> = ChartContext<'a, B, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;

/// Seven that a colour-blind eye tells apart, and an olive in place of their yellow, which white paper swallows. Source: Okabe and Ito, "Color
/// Universal Design".
pub const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(0, 0, 0),
    RGBColor(170, 160, 30),
];

/// Letters for pictures of pixels; a program that draws them has to bring its own.
pub fn fonts() {
    static ONCE: std::sync::Once = std::sync::Once::new();
    ONCE.call_once(|| {
        let font = epaint_default_fonts::UBUNTU_LIGHT;
        if plotters::style::register_font("sans-serif", FontStyle::Normal, font).is_err() {
            log::warn!("plots have no letters: the font that comes with the program cannot be read");
        }
    });
}

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

/// A panel with room for these points, ms and relative error. `what`: over the mean of which errors are. `scale`: pixels of a unit.
pub fn chart<'a, B: DrawingBackend>(
    panel: &'a DrawingArea<B, Shift>,
    title: &str,
    what: &str,
    points: &[(f64, f64)],
    scale: f64,
) -> Drawn<B, Chart<'a, B>> {
    fonts();
    let mut chart = ChartBuilder::on(panel)
        .caption(title, ("sans-serif", 18.0 * scale))
        .margin(10.0 * scale)
        .x_label_area_size(40.0 * scale)
        .y_label_area_size(64.0 * scale)
        .build_cartesian_2d(
            decades(range(points.iter().map(|point| point.0))).log_scale(),
            decades(range(points.iter().map(|point| point.1))).log_scale(),
        )?;
    chart
        .configure_mesh()
        .max_light_lines(0)
        .x_labels(6)
        .label_style(("sans-serif", 12.0 * scale))
        .x_desc("ms")
        .y_desc(format!("RMS error / mean {what}, %"))
        .x_label_formatter(&|ms| format!("{}", rounded(*ms)))
        .y_label_formatter(&|error| format!("{}", rounded(100.0 * error)))
        .draw()?;
    Ok(chart)
}

/// What the colours stand for, in a corner where lines seldom are: error falls as time grows.
pub fn legend<'a, B: DrawingBackend + 'a>(
    chart: &mut Chart<'a, B>,
    corner: SeriesLabelPosition,
    scale: f64,
) -> Drawn<B> {
    chart
        .configure_series_labels()
        .position(corner)
        .label_font(("sans-serif", 12.0 * scale))
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK)
        .draw()
}
