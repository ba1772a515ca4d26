//! Vertices that share a position.

use std::collections::HashMap;

/// For every vertex the first vertex at the same position, bit for bit (0 and −0 are one position).
pub(crate) fn weld(positions: &[[f32; 3]]) -> Vec<u32> {
    let mut first = HashMap::with_capacity(positions.len());
    (0_u32..).zip(positions).map(|(v, p)| *first.entry(p.map(position_bits)).or_insert(v)).collect()
}

fn position_bits(x: f32) -> u32 {
    // −0 + 0 is 0; every other number stays as it is.
    (x + 0.0).to_bits()
}
