//! A table: straight lines in ln R_d over ln r.

use super::Numeric;

/// Constant before the first radius, an exponential beyond the last. Radii in mm, ascending; values in 1/mm², > 0.
#[must_use]
pub fn table(radii: &[f64], values: &[f64]) -> Numeric {
    let last = radii.len() - 1;
    let rate = (values[last - 1] / values[last]).ln() / (radii[last] - radii[last - 1]);
    let reflectance = |r: f64| match radii.iter().rposition(|&knot| knot <= r) {
        None => values[0],
        Some(k) if k == last => values[k] * (-rate * (r - radii[k])).exp(),
        Some(k) => {
            let share = (r / radii[k]).ln() / (radii[k + 1] / radii[k]).ln();
            values[k].powf(1.0 - share) * values[k + 1].powf(share)
        }
    };
    Numeric::new(reflectance, 0.0, radii[0], [0.1 * radii[0], radii[last] + 40.0 / rate])
}
