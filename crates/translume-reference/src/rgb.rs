//! Linear RGB triples.

/// Adds `colour · factor` to `sum`.
pub(crate) fn accumulate(sum: &mut [f64; 3], colour: [f64; 3], factor: f64) {
    for (total, value) in sum.iter_mut().zip(colour) {
        *total += value * factor;
    }
}

pub(crate) fn scale(colour: [f64; 3], factor: f64) -> [f64; 3] {
    colour.map(|value| value * factor)
}

pub(crate) fn product(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] * b[k])
}

pub(crate) fn mean(colour: [f64; 3]) -> f64 {
    colour.iter().sum::<f64>() / 3.0
}
