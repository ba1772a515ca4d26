//! Pictures compared by blocks of pixels: paths are noisy, and a model is wrong over more than a pixel.

/// Side of a block, pixels.
const SIDE: usize = 4;

/// How far a picture is from paths, channel by channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Root mean square of the difference of blocks over the mean of the truth, without what the truth's noise adds.
    pub relative_rmse: [f64; 3],
    /// Mean of the difference over that mean.
    pub bias: [f64; 3],
}

/// A picture of which every pixel is known, row by row.
#[derive(Clone, Copy)]
pub struct Truth<'a> {
    pub width: usize,
    pub radiance: &'a [[f64; 3]],
    /// One standard error.
    pub error: &'a [[f64; 3]],
    /// Pixels that count; a block does where all of its pixels do.
    pub mask: &'a [bool],
}

/// `None` where no block counts, or the truth is dark.
pub fn compare(picture: &[[f32; 3]], truth: &Truth<'_>) -> Option<Figures> {
    let (mut square, mut noise, mut sum, mut mean) = ([0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]);
    let mut count = 0.0;
    for block in blocks(truth) {
        count += 1.0;
        let pixels = block.len() as f64;
        for k in 0..3 {
            let wanted = block.iter().map(|&pixel| truth.radiance[pixel][k]).sum::<f64>() / pixels;
            let found = block.iter().map(|&pixel| f64::from(picture[pixel][k])).sum::<f64>() / pixels;
            square[k] += (found - wanted).powi(2);
            noise[k] +=
                block.iter().map(|&pixel| truth.error[pixel][k].powi(2)).sum::<f64>() / (pixels * pixels);
            sum[k] += found - wanted;
            mean[k] += wanted;
        }
    }
    let figures = Figures {
        relative_rmse: [0, 1, 2].map(|k| (count * (square[k] - noise[k]).max(0.0)).sqrt() / mean[k]),
        bias: [0, 1, 2].map(|k| sum[k] / mean[k]),
    };
    (count > 0.0 && mean.iter().all(|mean| *mean > 0.0)).then_some(figures)
}

fn blocks<'a>(truth: &'a Truth<'_>) -> impl Iterator<Item = Vec<usize>> + 'a {
    let (width, height) = (truth.width, truth.mask.len() / truth.width);
    let corners = (0..height / SIDE).flat_map(move |row| (0..width / SIDE).map(move |column| (row, column)));
    let pixels = move |(row, column): (usize, usize)| -> Vec<usize> {
        let pixel = |k: usize| (row * SIDE + k / SIDE) * width + column * SIDE + k % SIDE;
        (0..SIDE * SIDE).map(pixel).collect()
    };
    corners.map(pixels).filter(|block| block.iter().all(|&pixel| truth.mask[pixel]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_taken_off_and_error_is_not() {
        let mask = [true; 128];
        // Every second pixel is off by ± .2: in blocks that cancels, and is as much as the error says or less.
        let noisy: Vec<[f64; 3]> =
            (0..128).map(|k| [1.0 + 0.2 * f64::from(1 - 2 * (k % 2))]).map(|[x]| [x; 3]).collect();
        let truth = Truth { width: 16, radiance: &noisy, error: &[[0.2; 3]; 128], mask: &mask };
        let even = compare(&[[1.0; 3]; 128], &truth).unwrap();
        assert_eq!(even.relative_rmse, [0.0; 3]);
        assert!(even.bias.iter().all(|bias| bias.abs() < 1e-12));
        let bright = compare(&[[1.5; 3]; 128], &truth).unwrap();
        // √(.5² − .2²/16).
        assert!((bright.relative_rmse[0] - 0.24750f64.sqrt()).abs() < 1e-6, "{bright:?}");
        assert!((bright.bias[0] - 0.5).abs() < 1e-6);
    }

    #[test]
    fn blocks_that_the_body_does_not_fill_do_not_count() {
        let mut mask = [true; 32];
        mask[0] = false;
        let mut radiance = [[1.0; 3]; 32];
        radiance[1] = [100.0; 3];
        let truth = Truth { width: 8, radiance: &radiance, error: &[[0.0; 3]; 32], mask: &mask };
        assert_eq!(compare(&[[1.0; 3]; 32], &truth).unwrap().relative_rmse, [0.0; 3]);
        let nothing = Truth { mask: &[false; 32], ..truth };
        assert!(compare(&[[1.0; 3]; 32], &nothing).is_none());
    }
}
