//! What the library promises, and which lines keep it.

use super::row::{Part, Row};
use translume::Method;
use translume_reference::metrics::Metrics;

/// Against all pairs, over their mean.
const ERROR: f64 = 0.01;
const P99: f64 = 0.03;
const BIAS: f64 = 0.003;
/// Kernels per texel.
const EVALUATIONS: f64 = 40.0;
/// Mean of the light that came through.
const TRANSMITTED: f64 = 0.03;
/// For four times as many texels.
const GROWTH: f64 = 5.0;
/// Times that all pairs are slower, on an atlas of this width or more.
const GAIN: f64 = 200.0;
const GAIN_ATLAS: u32 = 512;

/// What a line breaks, in words: nothing where it keeps its bounds. `None` where it has none: only the default method promises.
pub fn broken(row: &Row) -> Option<Vec<String>> {
    if row.method != Method::default() || row.part == Part::Converged {
        return None;
    }
    let figure = |of: fn(&Metrics) -> f64| row.figures.as_ref().map(of);
    let overflow = ("overflow", row.overflow.map(f64::from), 0.0);
    let checks = match row.part {
        Part::AllPairs => vec![
            ("error", figure(|f| f.relative_rmse), ERROR),
            ("p99", figure(|f| f.relative_p99), P99),
            ("bias", figure(|f| f.bias.abs()), BIAS),
            ("evaluations", row.pairs, EVALUATIONS),
            overflow,
        ],
        Part::Transmitted => vec![("mean", figure(|f| f.bias.abs()), TRANSMITTED), overflow],
        _ => vec![("growth", row.speed.growth, GROWTH), overflow],
    };
    // NaN breaks a bound.
    let fails =
        |(_, value, most): &(&str, Option<f64>, f64)| value.is_some_and(|value| !(..=*most).contains(&value));
    let mut broken: Vec<String> =
        checks.into_iter().filter(fails).map(|(what, ..)| what.to_owned()).collect();
    if row.atlas >= GAIN_ATLAS && row.speed.gain.is_some_and(|gain| !(GAIN..).contains(&gain)) {
        broken.push("speed".to_owned());
    }
    Some(broken)
}

/// As a table says it.
pub fn words(row: &Row) -> String {
    match broken(row) {
        None => "–".to_owned(),
        Some(broken) if broken.is_empty() => "yes".to_owned(),
        Some(broken) => format!("no: {}", broken.join(", ")),
    }
}

pub fn legend() -> String {
    format!(
        "\
**bound** says what the default method has to keep, on every line: error at most {} %, p99 at most {} %, bias within {} %, at most {EVALUATIONS} evaluations a
texel; the mean of light that came through within {} %; time at most {GROWTH} times as long for four times as many texels; all pairs at least {GAIN} times as slow
from atlas {GAIN_ATLAS}² on; no overflow. Other lines have no bound (–).
",
        100.0 * ERROR,
        100.0 * P99,
        100.0 * BIAS,
        100.0 * TRANSMITTED,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::scatter::row::Speed;

    fn row(part: Part, relative_rmse: f64, bias: f64) -> Row {
        let figures = Metrics { relative_rmse, bias, p99: 0.0, relative_p99: 0.02, count: 9 };
        Row { figures: Some(figures), overflow: Some(0), ..Row::example(part, Method::default()) }
    }

    #[test]
    fn what_breaks_a_bound_is_named() {
        assert_eq!(words(&row(Part::AllPairs, 0.009, -0.002)), "yes");
        assert_eq!(words(&row(Part::AllPairs, 0.011, -0.004)), "no: error, bias");
        assert_eq!(words(&row(Part::AllPairs, f64::NAN, 0.0)), "no: error");
        let full = Row { overflow: Some(3), pairs: Some(41.0), ..row(Part::AllPairs, 0.0, 0.0) };
        assert_eq!(words(&full), "no: evaluations, overflow");
        assert_eq!(words(&row(Part::Transmitted, 9.0, -0.029)), "yes");
        assert_eq!(words(&row(Part::Transmitted, 0.0, -0.031)), "no: mean");
    }

    #[test]
    fn slow_growth_and_large_gains_are_promised() {
        let times = |growth, gain, atlas| {
            let speed = Speed { growth: Some(growth), gain: Some(gain), extrapolated: false };
            words(&Row { atlas, speed, ..Row::example(Part::Times, Method::default()) })
        };
        assert_eq!(times(4.9, 201.0, 512), "yes");
        assert_eq!(times(5.1, 199.0, 512), "no: growth, speed");
        assert_eq!(times(4.9, 20.0, 256), "yes");
    }

    #[test]
    fn other_methods_promise_nothing() {
        let dark = Row { method: Method::Pattern, ..row(Part::AllPairs, 1.0, -1.0) };
        assert_eq!(words(&dark), "–");
        assert_eq!(words(&row(Part::Converged, 1.0, -1.0)), "–");
    }
}
