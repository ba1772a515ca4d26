//! Orders of texels in which an implicit 4-ary tree over them has compact nodes.

use super::{Atlas, Texel};
use crate::Mesh;
use std::collections::BTreeMap;

/// Pixels on a side of a block.
const SIDE: u16 = 4;
/// Texels of a block, and of every unit but the last.
const UNIT: usize = 16;
/// Of the texels that have to be in whole blocks: what is left over is ragged.
const LEAST_SHARE: f32 = 0.5;

impl Atlas {
    /// All texels in another order, whose groups of four and sixteen close without gaps as squares do: whole blocks of 4 × 4 pixels, quarter by quarter,
    /// and what is left at the edges of charts in groups of sixteen, in kd order as [`texels`](Self::texels) are, which `mesh` must be that of.
    /// The same as theirs where less than half of them are in whole blocks.
    #[must_use]
    pub fn block_order(&self, mesh: &Mesh) -> Vec<u32> {
        let place = |texel: &Texel| texel.interpolate(mesh.corners(texel.triangle as usize));
        block_order(&self.texels, &self.texels.iter().map(place).collect::<Vec<_>>())
    }
}

fn block_order(texels: &[Texel], points: &[[f32; 3]]) -> Vec<u32> {
    let mut blocks: BTreeMap<_, Vec<u32>> = BTreeMap::new();
    for (index, texel) in texels.iter().enumerate() {
        blocks.entry(texel.pixel.map(|x| x / SIDE)).or_default().push(index as u32);
    }
    let (mut units, mut left) = (Vec::new(), Vec::new());
    for mut block in blocks.into_values() {
        let is_whole = block.len() == UNIT && block.iter().all(|&k| texels[k as usize].area > 0.0);
        if is_whole {
            block.sort_by_key(|&k| texels[k as usize].pixel.map(|x| x % SIDE / 2));
            units.push(block);
        } else {
            left.extend(block);
        }
    }
    if ((UNIT * units.len()) as f32) < LEAST_SHARE * texels.len() as f32 {
        return (0..texels.len() as u32).collect();
    }
    // Ties go to the smaller index.
    left.sort_unstable();
    let places: Vec<_> = left.iter().map(|&k| points[k as usize]).collect();
    let grouped: Vec<u32> = kd_order(&places).into_iter().map(|k| left[k as usize]).collect();
    let groups = grouped.chunks_exact(UNIT);
    let last = groups.remainder().to_vec();
    units.extend(groups.map(<[u32]>::to_vec));
    let middles: Vec<_> = units.iter().map(|unit| middle(unit, points)).collect();
    let mut order: Vec<u32> =
        kd_order(&middles).into_iter().flat_map(|k| units[k as usize].iter().copied()).collect();
    order.extend(last);
    order
}

fn middle(unit: &[u32], points: &[[f32; 3]]) -> [f32; 3] {
    std::array::from_fn(|axis| {
        unit.iter().map(|&k| points[k as usize][axis]).sum::<f32>() / unit.len() as f32
    })
}

/// The order of `points` by recursive median split along the longest side of the bounding box. The left part of every
/// split is the largest power of two below the whole, so any aligned run of 4^l entries is one subtree. Ties go to the
/// smaller index: the order is unique.
pub(super) fn kd_order(points: &[[f32; 3]]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    split(&mut order, points);
    order
}

fn split(order: &mut [u32], points: &[[f32; 3]]) {
    if order.len() < 2 {
        return;
    }
    let axis = longest_axis(order, points);
    let left = order.len().next_power_of_two() / 2;
    order.select_nth_unstable_by(left, |&a, &b| {
        points[a as usize][axis].total_cmp(&points[b as usize][axis]).then(a.cmp(&b))
    });
    let (left, right) = order.split_at_mut(left);
    split(left, points);
    split(right, points);
}

fn longest_axis(order: &[u32], points: &[[f32; 3]]) -> usize {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for &index in order {
        for (axis, &x) in points[index as usize].iter().enumerate() {
            low[axis] = low[axis].min(x);
            high[axis] = high[axis].max(x);
        }
    }
    let side = |axis: usize| high[axis] - low[axis];
    (1..3).fold(0, |longest, axis| if side(axis) > side(longest) { axis } else { longest })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 21 × 13 pixels, those of one column on the rim of a chart.
    fn texels() -> Vec<Texel> {
        let texel = |x, y| {
            let area = if x == 9 { 0.0 } else { 1.0 };
            Texel { pixel: [x, y], triangle: 0, barycentric: [0.0; 2], area }
        };
        (0..13).flat_map(|y| (0..21).map(move |x| texel(x, y))).collect()
    }

    #[test]
    fn whole_blocks_are_units() {
        let texels = texels();
        let points: Vec<_> =
            texels.iter().map(|t| [f32::from(t.pixel[0]), 0.5 * f32::from(t.pixel[1]), 0.0]).collect();
        let order = block_order(&texels, &points);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().copied().eq(0..texels.len() as u32), "every texel once");

        let span = |unit: &[u32]| {
            let pixels = || unit.iter().map(|&k| texels[k as usize].pixel);
            let side = |axis: usize| {
                let along = || pixels().map(|pixel| pixel[axis]);
                1 + along().max().unwrap_or(0) - along().min().unwrap_or(0)
            };
            (side(0), side(1))
        };
        let whole = order.chunks(UNIT).filter(|unit| unit.len() == UNIT && span(unit) == (4, 4));
        // Columns 0 to 7 and 12 to 19, rows 0 to 11.
        assert_eq!(whole.clone().count(), 3 * (2 + 2));
        for unit in whole {
            assert!(unit.chunks(4).all(|quarter| span(quarter) == (2, 2)));
        }
    }
}
