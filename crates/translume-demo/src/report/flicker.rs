//! How unsteady light is on a body that moves slowly.

use super::bench::{Bench, median};
use super::scenes;
use super::subject::Subject;
use super::table::Row;
use super::trials::{map_words, sky_options, sky_words};
use super::twin::Figures;
use crate::error::Error;
use translume::{Deformation, Light, ShadowOptions};

/// Weights of the first morph target.
const FIRST: f32 = 0.30;
const STEP: f32 = 0.0025;
const STEPS: i32 = 12;
/// Frames before the first, in which whatever is renewed bit by bit gets into its stride.
const LEAD: i32 = 4;

/// A row for each light and setting.
pub fn rows(bench: &mut Bench<'_>, subject: &Subject, quick: bool) -> Result<Vec<Row>, Error> {
    let dark = Walk::new(bench, subject, &[])?;
    let sky = [Light::Ambient(scenes::constant_sky(true))];
    let sun = [Light::Directional(scenes::sun())];
    let options = |directions| sky_options(directions, 256);
    let little = ShadowOptions { directions_per_frame: 16, ..options(64) };
    let lamp = ShadowOptions { resolution: 2048, ..Default::default() };
    let mut trials = vec![
        ("constant sky flicker", &sky, options(64), sky_words(&options(64))),
        ("constant sky flicker", &sky, options(128), sky_words(&options(128))),
        ("constant sky flicker", &sky, little, format!("{}, 16 a frame", sky_words(&little))),
        ("directional flicker", &sun, lamp, map_words(&lamp)),
    ];
    if quick {
        trials.drain(1..3);
    }
    let mut rows = Vec::new();
    for (light, lights, shadows, shadow) in trials {
        bench.set_shadows(shadows)?;
        let walk = Walk::new(bench, subject, lights)?;
        rows.push(Row {
            scene: subject.name.clone(),
            light: light.to_owned(),
            shadow,
            figures: walk.figures(),
            time_ms: walk.time_ms - dark.time_ms,
            sweeps: &[],
        });
    }
    Ok(rows)
}

/// All frames of a slow morph.
struct Walk {
    /// Mean of the channels for each texel of each frame.
    irradiance: Vec<Vec<f64>>,
    /// Σ E·A of each frame.
    totals: Vec<f64>,
    /// Median.
    time_ms: f64,
}

impl Walk {
    fn new(bench: &mut Bench<'_>, subject: &Subject, lights: &[Light]) -> Result<Self, Error> {
        let mut weights = subject.pose.weights.clone();
        let (mut irradiance, mut totals, mut times) = (Vec::new(), Vec::new(), Vec::new());
        for k in -LEAD..=STEPS {
            if let Some(first) = weights.first_mut() {
                *first = FIRST + STEP * k as f32;
            }
            let pose = Deformation::Pose { weights: &weights, joints: &subject.pose.joints };
            let time = bench.frame(pose, lights)?;
            if k < 0 {
                continue;
            }
            let found = bench.irradiance()?;
            let light: Vec<f64> = found.iter().map(|rgb| rgb.iter().sum::<f64>() / 3.0).collect();
            totals.push(light.iter().zip(bench.areas()?).map(|(e, area)| e * area).sum());
            irradiance.push(light);
            times.push(time);
        }
        Ok(Self { irradiance, totals, time_ms: median(times) })
    }

    /// Of the worst frame: how far its texels, and its total, are from the middle between the frames before and after.
    fn figures(&self) -> Option<Figures> {
        let deviations = self.irradiance.windows(3).map(|frames| {
            let [before, now, after] = frames else { return [0.0; 2] };
            let off = |k: usize| now[k] - 0.5 * (before[k] + after[k]);
            let count = now.len() as f64;
            let rms = ((0..now.len()).map(|k| off(k).powi(2)).sum::<f64>() / count).sqrt();
            let mean = now.iter().sum::<f64>() / count;
            let mean_square = now.iter().map(|e| e * e).sum::<f64>() / count;
            [rms / mean, rms / mean_square.sqrt()]
        });
        let [relative_rmse, rmse_over_rms] = deviations.max_by(|a, b| a[0].total_cmp(&b[0]))?;
        let steps = self.totals.windows(3).map(|t| (t[1] - 0.5 * (t[0] + t[2])) / t[1]);
        let bias = steps.max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        Some(Figures { relative_rmse, rmse_over_rms, bias })
    }
}

#[cfg(test)]
mod tests {
    use super::Walk;

    fn walk(middle: [f64; 2]) -> Walk {
        let irradiance = vec![vec![1.0, 3.0], middle.to_vec(), vec![3.0, 5.0]];
        let totals = irradiance.iter().map(|frame| frame.iter().sum()).collect();
        Walk { irradiance, totals, time_ms: 0.0 }
    }

    #[test]
    fn a_steady_change_does_not_flicker() {
        let steady = walk([2.0, 4.0]).figures().unwrap();
        assert_eq!([steady.relative_rmse, steady.bias], [0.0; 2]);
        let shaken = walk([2.5, 3.5]).figures().unwrap();
        // Half a unit at either texel, over a mean of 3; their sum stays.
        assert!((shaken.relative_rmse - 0.5 / 3.0).abs() < 1e-12 && shaken.bias == 0.0);
        let jump = walk([2.5, 4.5]).figures().unwrap();
        assert!((jump.bias - 1.0 / 7.0).abs() < 1e-12);
    }
}
