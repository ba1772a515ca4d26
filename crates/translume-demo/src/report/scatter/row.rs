//! One measurement, and all of them as CSV.

use super::bench::Run;
use crate::report::csv::quoted;
use crate::report::method;
use translume::{Method, Profile};
use translume_reference::metrics::Metrics;

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Against all pairs of the same texels.
    AllPairs,
    /// Against the converged integral.
    Converged,
    /// Light that came through, against the converged integral.
    Transmitted,
    /// The clock alone.
    Times,
}

#[derive(Clone)]
pub struct Row {
    pub part: Part,
    pub scene: String,
    pub atlas: u32,
    pub texels: usize,
    pub medium: &'static str,
    pub profile: Profile,
    pub method: Method,
    /// Kernel evaluations per texel, where they are known.
    pub pairs: Option<f64>,
    pub figures: Option<Metrics>,
    pub time_ms: f64,
    /// Groups of receivers without room for their lists, where there are lists.
    pub overflow: Option<u32>,
    pub speed: Speed,
}

/// Times over other times.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Speed {
    /// The time follows from a smaller atlas.
    pub extrapolated: bool,
    /// For four times as many texels.
    pub growth: Option<f64>,
    /// The time of all pairs over this.
    pub gain: Option<f64>,
}

impl Row {
    /// What is left for the part to say: the figures.
    pub fn new(part: Part, case: &Case<'_>, method: Method, run: &Run) -> Self {
        let texels = run.exitance.len();
        let counted = run.exitance.iter().map(|b| f64::from(b[3])).sum::<f64>() / texels as f64;
        let pairs = match method {
            Method::AllPairs => Some(texels as f64),
            _ => method::counts(method).then_some(counted),
        };
        Self {
            part,
            scene: case.scene.to_owned(),
            atlas: case.atlas,
            texels,
            medium: case.medium,
            profile: case.profile.clone(),
            method,
            pairs,
            figures: None,
            time_ms: run.time_ms,
            overflow: run.overflow,
            speed: Speed::default(),
        }
    }

    /// For tests: no figures, no time.
    #[cfg(test)]
    pub fn example(part: Part, method: Method) -> Self {
        let case = Case { scene: "egg, raw", atlas: 512, medium: "wax", profile: Profile::DipoleNormalised };
        let run = Run { exitance: vec![[1.0, 1.0, 1.0, 30.0]; 2], time_ms: 1.0, overflow: None };
        Self::new(part, &case, method, &run)
    }

    /// The scene, and what it is measured against where that is not all pairs.
    fn title(&self) -> String {
        let more = match self.part {
            Part::AllPairs => "",
            Part::Converged => " against converged",
            Part::Transmitted => " transmitted",
            Part::Times => " times",
        };
        format!("{}{more}", self.scene)
    }
}

/// What rows of one body in one medium share.
#[derive(Clone)]
pub struct Case<'a> {
    pub scene: &'a str,
    pub atlas: u32,
    pub medium: &'static str,
    pub profile: Profile,
}

const HEADER: &str = "scene,atlas,medium,profile,method,tolerance,pairs_per_texel,rel_rmse,bias,p99,time_ms,overflow,adapter\n";

/// Fields without a figure are empty.
pub fn csv(rows: &[Row], adapter: &str) -> String {
    let optional = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.6}"));
    let mut text = HEADER.to_owned();
    for row in rows {
        let figure = |of: fn(&Metrics) -> f64| optional(row.figures.as_ref().map(of));
        let profile = Profile::NAMES.iter().find(|(_, profile)| *profile == row.profile);
        let fields = [
            quoted(&row.title()),
            row.atlas.to_string(),
            row.medium.to_owned(),
            profile.map_or(String::new(), |(name, _)| (*name).to_owned()),
            method::words(row.method),
            method::tolerance(row.method).map_or(String::new(), |value| value.to_string()),
            row.pairs.map_or(String::new(), |pairs| format!("{pairs:.2}")),
            figure(|f| f.relative_rmse),
            figure(|f| f.bias),
            figure(|f| f.relative_p99),
            format!("{:.4}", row.time_ms),
            row.overflow.map_or(String::new(), |overflow| overflow.to_string()),
            quoted(adapter),
        ];
        text += &fields.join(",");
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_empty() {
        let rows =
            [Row::example(Part::AllPairs, Method::default()), Row::example(Part::Times, Method::AllPairs)];
        let text = csv(&rows, "soft");
        let lines: Vec<&str> = text.lines().skip(1).collect();
        let profile = "wax,dipole-normalised";
        assert_eq!(lines[0], format!("\"egg, raw\",512,{profile},dual 1 %,0.01,30.00,,,,1.0000,,soft"));
        assert_eq!(lines[1], format!("\"egg, raw times\",512,{profile},all pairs,,2.00,,,,1.0000,,soft"));
    }
}
