//! Methods in words.

use translume::Method;

/// As in the tables.
pub fn words(method: Method) -> String {
    match method {
        Method::AllPairs => "all pairs".to_owned(),
        Method::Tree { theta } => format!("tree {theta}"),
        Method::Dual { theta } => format!("dual, θ {theta}"),
        Method::Within { tolerance } => format!("dual {} %", (1e4 * tolerance).round() / 100.0),
        Method::Pattern => "pattern".to_owned(),
        other => format!("{other:?}"),
    }
}

/// The error a method aims at, for methods that aim at one.
pub fn tolerance(method: Method) -> Option<f32> {
    match method {
        Method::Within { tolerance } => Some(tolerance),
        _ => None,
    }
}

/// Whether the fourth number of an exitance says how many kernels were evaluated for it.
pub fn counts(method: Method) -> bool {
    !matches!(method, Method::AllPairs | Method::Tree { .. })
}

/// Whether open sources wait in lists, which may overflow.
pub fn has_lists(method: Method) -> bool {
    counts(method) && method != Method::Pattern
}
