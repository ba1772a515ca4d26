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
        truths.converged(profile).and_then(|truth| against(picture, truth, None, &truths.mask));
    let Some(traced) = &truths.traced else {
        return Verdict { quadrature, ..Verdict::default() };
    };
    let error = Some(traced.error.as_slice());
    let shown = truths.shown(&traced.radiance).zip(truths.shown(picture));
    Verdict {
        quadrature,
        total: against(picture, &traced.radiance, error, &truths.mask),
        psnr: psnr(picture, &traced.radiance, &truths.mask),
        flip: shown.and_then(|(reference, test)| flip::compare(&reference, &test)).map(|flip| flip.mean),
        noise: noise(&traced.radiance, &traced.error, &truths.mask),
    }
}

fn flat<T: Shown>(picture: &[T], mask: &[bool]) -> Vec<f64> {
    let inside = picture.iter().zip(mask).filter(|(_, inside)| **inside);
    inside.flat_map(|(pixel, _)| pixel.rgb()).collect()
}

/// `None` where nothing is to be compared, or the truth is dark.
pub fn against<A: Shown, B: Shown>(
    picture: &[A],
    truth: &[B],
    error: Option<&[[f64; 3]]>,
    mask: &[bool],
) -> Option<Against> {
    let (found, wanted) = (flat(picture, mask), flat(truth, mask));
    let figures = metrics::compare(&found, &wanted, None)?;
    let mean = wanted.iter().sum::<f64>() / wanted.len() as f64;
    if !(mean > 0.0) {
        return None;
    }
    let own = error.map_or(0.0, |error| mean_square(&flat(error, mask)) / (mean * mean));
    Some(Against {
        relative_rmse: (figures.relative_rmse.powi(2) - own).max(0.0).sqrt(),
        bias: figures.bias,
        relative_p99: figures.relative_p99,
    })
}

fn psnr(picture: &[[f32; 3]], truth: &[[f64; 3]], mask: &[bool]) -> Option<f64> {
    let (found, wanted) = (flat(picture, mask), flat(truth, mask));
    let peak = wanted.iter().copied().fold(0.0, f64::max);
    metrics::psnr(&found, &wanted, None, peak).filter(|psnr| psnr.is_finite())
}

fn noise(truth: &[[f64; 3]], error: &[[f64; 3]], mask: &[bool]) -> Option<f64> {
    let wanted = flat(truth, mask);
    let mean = wanted.iter().sum::<f64>() / wanted.len().max(1) as f64;
    (mean > 0.0).then(|| mean_square(&flat(error, mask)).sqrt() / mean)
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_of_the_truth_is_taken_off() {
        let (picture, truth) = ([[1.1_f32; 3]; 4], [[1.0_f64; 3]; 4]);
        let mask = [true, true, true, false];
        let plain = against(&picture, &truth, None, &mask).unwrap();
        // f32 holds 1.1 to 2e-8.
        assert!((plain.relative_rmse - 0.1).abs() < 1e-6 && (plain.bias - 0.1).abs() < 1e-6);
        let error = [[0.06; 3], [0.06; 3], [0.06; 3], [9.0; 3]];
        let less = against(&picture, &truth, Some(&error), &mask).unwrap();
        assert!((less.relative_rmse - 0.08).abs() < 1e-6, "√(.1² − .06²): {less:?}");
        assert!((noise(&truth, &error, &mask).unwrap() - 0.06).abs() < 1e-12);
        assert_eq!(against(&picture, &[[0.0_f64; 3]; 4], None, &mask), None);
        assert_eq!(against(&picture, &truth, None, &[false; 4]), None);
    }
}
