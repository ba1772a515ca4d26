//! How far an image is from a reference.

/// Distances of one channel, or of several channels laid out in one slice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metrics {
    /// Root mean square of the difference over the mean of the reference.
    pub relative_rmse: f64,
    /// Mean of the difference over the mean of the reference; negative if the image is too dark.
    pub bias: f64,
    /// 99th percentile of the absolute difference, in the image's unit, interpolated linearly between ranks.
    pub p99: f64,
    /// The same over the mean of the reference.
    pub relative_p99: f64,
    /// How many values were compared.
    pub count: usize,
}

/// Compares the values that `mask` selects, all without one. `None` if that leaves nothing or if lengths differ.
///
/// Relative figures of a reference whose mean is 0 are infinite, or NaN where the difference is 0 too.
#[must_use]
pub fn compare(image: &[f64], reference: &[f64], mask: Option<&[bool]>) -> Option<Metrics> {
    let (differences, mean) = differences(image, reference, mask)?;
    let count = differences.len();
    let sum: f64 = differences.iter().sum();
    let squares: f64 = differences.iter().map(|d| d * d).sum();
    let p99 = percentile(differences.iter().map(|d| d.abs()).collect(), 0.99);
    Some(Metrics {
        relative_rmse: (squares / count as f64).sqrt() / mean,
        bias: sum / count as f64 / mean,
        p99,
        relative_p99: p99 / mean,
        count,
    })
}

/// Peak signal-to-noise ratio, 10 log₁₀(peak² / mean square difference), dB; infinite for equal images. `None` as for
/// [`compare`].
#[must_use]
pub fn psnr(image: &[f64], reference: &[f64], mask: Option<&[bool]>, peak: f64) -> Option<f64> {
    let (differences, _) = differences(image, reference, mask)?;
    let mean_square = differences.iter().map(|d| d * d).sum::<f64>() / differences.len() as f64;
    Some(10.0 * (peak * peak / mean_square).log10())
}

/// One channel of a picture.
#[must_use]
pub fn channel(picture: &[[f32; 3]], channel: usize) -> Vec<f64> {
    picture.iter().map(|pixel| f64::from(pixel[channel])).collect()
}

/// Differences image − reference inside the mask, and the mean of the reference there.
fn differences(image: &[f64], reference: &[f64], mask: Option<&[bool]>) -> Option<(Vec<f64>, f64)> {
    if image.len() != reference.len() || mask.is_some_and(|mask| mask.len() != image.len()) {
        return None;
    }
    let selected = |k: &usize| mask.is_none_or(|mask| mask[*k]);
    let indices: Vec<usize> = (0..image.len()).filter(selected).collect();
    if indices.is_empty() {
        return None;
    }
    let mean = indices.iter().map(|&k| reference[k]).sum::<f64>() / indices.len() as f64;
    Some((indices.iter().map(|&k| image[k] - reference[k]).collect(), mean))
}

/// The value at rank `share · (n − 1)` of at least one value, interpolated.
fn percentile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let rank = share * (values.len() - 1) as f64;
    let below = rank.floor() as usize;
    let above = (below + 1).min(values.len() - 1);
    values[below] + (values[above] - values[below]) * rank.fract()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_computed_by_hand() {
        let reference = [1.0, 2.0, 3.0, 2.0];
        let image = [1.5, 2.0, 2.0, 2.0];
        let metrics = compare(&image, &reference, None).unwrap();
        // Differences .5 0 −1 0: mean −1/8, mean square 5/16; mean of the reference 2.
        assert!((metrics.relative_rmse - (5.0f64 / 16.0).sqrt() / 2.0).abs() < 1e-15);
        assert!((metrics.bias + 1.0 / 16.0).abs() < 1e-15);
        // Sorted 0 0 .5 1, rank 2.97.
        assert!((metrics.p99 - (0.5 + 0.97 * 0.5)).abs() < 1e-12);
        assert!((metrics.relative_p99 - metrics.p99 / 2.0).abs() < 1e-15);
        assert_eq!(metrics.count, 4);
        // 10 log₁₀(9 / (5/16)).
        assert!((psnr(&image, &reference, None, 3.0).unwrap() - 14.593_924_877_592_308).abs() < 1e-9);
    }

    #[test]
    fn mask_leaves_out() {
        let (reference, image) = ([1.0, 2.0, 3.0], [1.0, 2.5, 99.0]);
        let masked = compare(&image, &reference, Some(&[true, true, false])).unwrap();
        assert_eq!(masked.count, 2);
        assert!((masked.bias - 0.25 / 1.5).abs() < 1e-15);
        assert_ne!(compare(&image, &reference, None).unwrap(), masked);
    }

    #[test]
    fn nothing_to_compare() {
        assert_eq!(compare(&[], &[], None), None);
        assert_eq!(compare(&[1.0], &[1.0, 2.0], None), None);
        assert_eq!(compare(&[1.0], &[1.0], Some(&[false])), None);
        assert_eq!(compare(&[1.0], &[1.0], Some(&[])), None);
        assert_eq!(psnr(&[1.0], &[1.0], None, 1.0), Some(f64::INFINITY));
    }

    #[test]
    fn channels_of_a_picture() {
        assert_eq!(channel(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], 1), [2.0, 5.0]);
    }
}
