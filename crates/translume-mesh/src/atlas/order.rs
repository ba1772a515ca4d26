//! kd order: texels sorted so that an implicit 4-ary tree over them has compact nodes.

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
