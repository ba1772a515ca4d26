//! How far a picture is from both truths.

use super::flip;
use super::truth::{Shown, Truths};
use translume_reference::metrics;

/// Distances from one truth, all channels together, over the pixels that the body fills.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Against {
    /// Root mean square of the difference over the mean of the truth; what the truth's own noise adds is taken off.
    pub relative_rmse: f64,
    pub bias: f64,
    /// 99th percentile of the absolute difference over that mean.
    pub relative_p99: f64,
}

#[derive(Clone, Debug, Default)]
pub struct Verdict {
    /// Against the converged integral of the same profile.
    pub quadrature: Option<Against>,
    /// Against traced paths.
    pub total: Option<Against>,
    /// dB below the brightest pixel of the traced picture.
    pub psnr: Option<f64>,
    pub flip: Option<f64>,
    /// Standard error of the traced picture, root mean square over its mean.
    pub noise: Option<f64>,
}

/// `picture`: radiance row by row.
pub fn judge(truths: &Truths, profile: &str, picture: &[[f32; 3]]) -> Verdict {
    let quadrature =
        truths.converged(profile).and_then(|truth| against(&truths.sampled(picture), truth, None));
    let Some(traced) = &truths.traced else {
        return Verdict { quadrature, ..Verdict::default() };
    };
    let inside = |picture: &[[f64; 3]]| masked(picture, &truths.mask);
    let (found, wanted, error) =
        (masked(picture, &truths.mask), inside(&traced.radiance), inside(&traced.error));
    let shown = truths.shown(&traced.radiance).zip(truths.shown(picture));
    Verdict {
        quadrature,
        total: against(&found, &wanted, Some(&error)),
        psnr: psnr(&found, &wanted),
        flip: shown.and_then(|(reference, test)| flip::compare(&reference, &test)).map(|flip| flip.mean),
        noise: noise(&wanted, &error),
    }
}

/// Pixels that the body fills.
fn masked<T: Copy>(picture: &[T], mask: &[bool]) -> Vec<T> {
    picture.iter().zip(mask).filter(|(_, inside)| **inside).map(|(pixel, _)| *pixel).collect()
}

fn flat<T: Shown>(picture: &[T]) -> Vec<f64> {
    picture.iter().flat_map(Shown::rgb).collect()
}

/// Of pixel and pixel. `error`: standard errors of the truth. `None` where nothing is to be compared, the truth is dark, or
/// either is no number.
pub fn against<A: Shown, B: Shown>(
    picture: &[A],
    truth: &[B],
    error: Option<&[[f64; 3]]>,
) -> Option<Against> {
    let (found, wanted) = (flat(picture), flat(truth));
    let figures = metrics::compare(&found, &wanted, None)?;
    let mean = mean(&wanted);
    if !mean.is_finite() || mean <= 0.0 || !figures.relative_rmse.is_finite() {
        return None;
    }
    let own = error.map_or(0.0, |error| mean_square(&flat(error)) / (mean * mean));
    Some(Against {
        relative_rmse: (figures.relative_rmse.powi(2) - own).max(0.0).sqrt(),
        bias: figures.bias,
        relative_p99: figures.relative_p99,
    })
}

fn psnr(picture: &[[f32; 3]], truth: &[[f64; 3]]) -> Option<f64> {
    let (found, wanted) = (flat(picture), flat(truth));
    let peak = wanted.iter().copied().fold(0.0, f64::max);
    metrics::psnr(&found, &wanted, None, peak).filter(|psnr| psnr.is_finite())
}

fn noise(truth: &[[f64; 3]], error: &[[f64; 3]]) -> Option<f64> {
    let mean = mean(&flat(truth));
    (mean > 0.0).then(|| mean_square(&flat(error)).sqrt() / mean)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_of_the_truth_is_taken_off() {
        let (picture, truth) = ([[1.1_f32; 3]; 3], [[1.0_f64; 3]; 3]);
        let plain = against(&picture, &truth, None).unwrap();
        // f32 holds 1.1 to 2e-8.
        assert!((plain.relative_rmse - 0.1).abs() < 1e-6 && (plain.bias - 0.1).abs() < 1e-6);
        let error = [[0.06; 3]; 3];
        let less = against(&picture, &truth, Some(&error)).unwrap();
        assert!((less.relative_rmse - 0.08).abs() < 1e-6, "√(.1² − .06²): {less:?}");
        assert!((noise(&truth, &error).unwrap() - 0.06).abs() < 1e-12);
        assert_eq!(against(&picture, &[[0.0_f64; 3]; 3], None), None);
        assert_eq!(against::<[f32; 3], [f64; 3]>(&[], &[], None), None);
        assert_eq!(against(&[[f32::NAN; 3]; 3], &truth, Some(&error)), None, "no number is no success");
        assert_eq!(masked(&[1, 2, 3], &[true, false, true]), [1, 3]);
    }
}
