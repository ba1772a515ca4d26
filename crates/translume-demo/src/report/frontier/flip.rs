//! What an eye would notice: ꟻLIP between two pictures.
//!
//! Source: Andersson et al. 2020, "ꟻLIP: A Difference Evaluator for Alternating Images".

use crate::picture::Picture;
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool};

/// How noticeable a difference is.
pub struct Flip {
    /// Mean over the pixels, 0..=1.
    pub mean: f64,
    /// 0..=1 per pixel as a colour, black where there is nothing to see.
    pub map: Picture,
}

/// Both as they are shown. `None` where sizes differ.
pub fn compare(reference: &Picture, test: &Picture) -> Option<Flip> {
    if (reference.width, reference.height) != (test.width, test.height) {
        return None;
    }
    let image =
        |picture: &Picture| FlipImageRgb8::with_data(picture.width, picture.height, &picture.to_srgb());
    let error = nv_flip::flip(image(reference), image(test), DEFAULT_PIXELS_PER_DEGREE);
    let map = Picture::from_bytes(test.width, &error.apply_color_lut(&nv_flip::magma_lut()).to_vec());
    Some(Flip { mean: FlipPool::from_image(&error).mean().into(), map })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(level: f32) -> Picture {
        Picture { width: 32, height: 32, pixels: vec![[level; 3]; 32 * 32] }
    }

    #[test]
    fn equal_pictures_differ_by_nothing_and_black_from_white_by_all() {
        // Dithering is the same in both.
        assert_eq!(compare(&grey(0.25), &grey(0.25)).unwrap().mean, 0.0);
        let all = compare(&grey(0.0), &grey(1.0)).unwrap().mean;
        assert!(all > 0.9 && all <= 1.0, "{all}");
        let some = compare(&grey(0.25), &grey(0.3)).unwrap();
        assert!(some.mean > 0.01 && some.mean < all, "{}", some.mean);
        assert!(some.map.pixels[500] != [0.0; 3]);
        let odd = Picture { width: 16, height: 64, ..grey(0.25) };
        assert!(compare(&grey(0.25), &odd).is_none());
    }
}
