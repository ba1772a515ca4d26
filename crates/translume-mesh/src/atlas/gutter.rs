//! Fills the pixels of the texture: texels, then gutters that repeat the nearest texel.

use super::texels::neighbours;
use super::{Atlas, Texel};

/// Which texel fills each pixel. Pixels up to `reach` steps away from a texel repeat the nearest one, so that coarser
/// mip levels stay clean; ties go to the smaller index.
pub(super) fn fill(texels: &[Texel], size: u32, reach: u32) -> Vec<u32> {
    let place = |t: &Texel| t.pixel[1] as usize * size as usize + t.pixel[0] as usize;
    let mut front: Vec<usize> = texels.iter().map(place).collect();
    let mut own = vec![Atlas::EMPTY; (size * size) as usize];
    for (index, &pixel) in (0_u32..).zip(&front) {
        own[pixel] = index;
    }
    let mut pixels = own.clone();
    for step in 1..=reach {
        let mut next: Vec<usize> = front
            .iter()
            .flat_map(|&pixel| neighbours(pixel, size))
            .filter(|&pixel| pixels[pixel] == Atlas::EMPTY)
            .collect();
        next.sort_unstable();
        next.dedup();
        for &pixel in &next {
            pixels[pixel] = nearest(pixel, &own, size, step);
        }
        front = next;
    }
    pixels
}

/// The nearest texel of a pixel that lies `steps` king's moves away from one.
fn nearest(pixel: usize, own: &[u32], size: u32, steps: u32) -> u32 {
    let size = size as usize;
    let (row, column) = (pixel / size, pixel % size);
    // A texel straight ahead may be nearer than one on the diagonal, and none beyond √2 steps is.
    let radius = (f64::from(steps) * std::f64::consts::SQRT_2) as usize;
    let around = |x: usize| x.saturating_sub(radius)..=(x + radius).min(size - 1);
    around(row)
        .flat_map(|y| around(column).map(move |x| (x, y)))
        .map(|(x, y)| (x.abs_diff(column).pow(2) + y.abs_diff(row).pow(2), own[y * size + x]))
        .filter(|&(_, index)| index != Atlas::EMPTY)
        .min()
        .map_or(Atlas::EMPTY, |(_, index)| index)
}
