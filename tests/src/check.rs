//! Comparisons that can be told to hold and told to fail.

use crate::gpu;
use translume_reference::gather::Source;

/// What a comparison found: nothing, or what is wrong with the figures.
pub type Check = Result<(), String>;

/// A figure and the most it may be. NaN is too much.
///
/// # Errors
/// The figure and its bound, in words.
pub fn at_most(what: &str, measured: f64, bound: f64) -> Check {
    eprintln!("{what}: {measured:.3e} (at most {bound:.1e})");
    if measured <= bound {
        Ok(())
    } else {
        Err(format!("{what} is {measured:e}, but may be {bound:e} at most"))
    }
}

/// A figure and the least it may be. NaN is too little.
///
/// # Errors
/// The figure and its bound, in words.
pub fn at_least(what: &str, measured: f64, bound: f64) -> Check {
    eprintln!("{what}: {measured:.3e} (at least {bound:.1e})");
    if measured >= bound {
        Ok(())
    } else {
        Err(format!("{what} is {measured:e}, but must be {bound:e} at least"))
    }
}

/// The check holds, or the test fails and names the adapter.
///
/// # Panics
/// If it does not hold.
#[track_caller]
pub fn holds(check: Check) {
    if let Err(problem) = check {
        panic!("[{}] {problem}", gpu().adapter_name);
    }
}

/// The check finds something wrong, as it must with broken input.
///
/// # Panics
/// If it found nothing.
#[allow(clippy::needless_pass_by_value, reason = "reads like `holds`")]
#[track_caller]
pub fn notices(check: Check) {
    if let Ok(()) = check {
        panic!("[{}] broken input passed the check", gpu().adapter_name);
    }
}

/// Root mean square of the difference over the root mean square of the reference.
///
/// # Panics
/// If the lengths differ.
#[must_use]
pub fn relative_rmse(measured: &[[f64; 3]], reference: &[[f64; 3]]) -> f64 {
    assert_eq!(measured.len(), reference.len(), "[{}] lengths differ", gpu().adapter_name);
    let squares = |pick: &dyn Fn(usize, usize) -> f64| -> f64 {
        (0..measured.len()).flat_map(|i| [0, 1, 2].map(|k| pick(i, k).powi(2))).sum()
    };
    (squares(&|i, k| measured[i][k] - reference[i][k]) / squares(&|i, k| reference[i][k])).sqrt()
}

/// As [`relative_rmse`], each texel by its area: texels on the rim of a chart, which only the picture interpolates from, have none.
///
/// # Panics
/// If the lengths differ.
#[must_use]
pub fn rmse_by_area(measured: &[[f64; 3]], reference: &[Source]) -> f64 {
    assert_eq!(measured.len(), reference.len(), "[{}] lengths differ", gpu().adapter_name);
    let weighted = |value: &[f64; 3], source: &Source| value.map(|x| x * source.area.sqrt());
    let measured: Vec<_> =
        measured.iter().zip(reference).map(|(value, source)| weighted(value, source)).collect();
    let reference: Vec<_> = reference.iter().map(|source| weighted(&source.irradiance, source)).collect();
    relative_rmse(&measured, &reference)
}
