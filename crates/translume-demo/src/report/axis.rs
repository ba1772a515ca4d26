//! Colours and logarithmic axes of all plots.

use plotters::style::RGBColor;

/// Four that a colour-blind eye tells apart. Source: Okabe and Ito, "Color Universal Design".
pub const COLOURS: [RGBColor; 4] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(204, 121, 167)];

/// Around all values, with some room.
pub fn range(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    if low > high { 0.1..10.0 } else { 0.7 * low..1.4 * high }
}

/// Powers of ten around a range: without one an axis would have no figures.
pub fn decades(range: std::ops::Range<f64>) -> std::ops::Range<f64> {
    10.0_f64.powf(range.start.log10().floor())..10.0_f64.powf(range.end.log10().ceil())
}

/// To three digits.
pub fn rounded(value: f64) -> f64 {
    let unit = 10.0_f64.powf(value.abs().max(1e-9).log10().floor() - 2.0);
    ((value / unit).round() * unit * 1e6).round() / 1e6
}
