//! The rotation that brings directions closest to others.

use glam::{DMat3, DMat4, DQuat, DVec3, DVec4};

/// Squarings of a matrix: what is not its largest eigenvector fades like the ratio of the eigenvalues to the power 2²⁰.
const SQUARINGS: usize = 20;

/// The rotation that maximises the sum of `to · rotation(from)` over pairs of unit vectors.
///
/// Source: Horn 1987, "Closed-form solution of absolute orientation using unit quaternions", section 4.
pub fn rotation(pairs: impl Iterator<Item = (DVec3, DVec3)>) -> DQuat {
    let mut products = DMat3::ZERO;
    let mut count = 0.0_f64;
    for (from, to) in pairs {
        products += DMat3::from_cols(from * to.x, from * to.y, from * to.z);
        count += 1.0;
    }
    // Every eigenvalue lies between ±count; the shift makes the largest also the one of largest size.
    let mut power = horn(&products) * (1.0 / count.max(1.0)) + DMat4::IDENTITY * 2.0;
    for _ in 0..SQUARINGS {
        power = power * power;
        power *= 1.0 / (0..4).map(|k| power.col(k)[k]).sum::<f64>();
    }
    let largest =
        (0..4).map(|k| power.col(k)).max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
    largest.map_or(DQuat::IDENTITY, |q| DQuat::from_vec4(q.normalize()))
}

/// The symmetric matrix whose largest eigenvector is the quaternion (x, y, z, w).
fn horn(products: &DMat3) -> DMat4 {
    // s(i, j) sums from_i · to_j.
    let s = |i: usize, j: usize| products.col(j)[i];
    let w = DVec3::new(s(1, 2) - s(2, 1), s(2, 0) - s(0, 2), s(0, 1) - s(1, 0));
    let trace = s(0, 0) + s(1, 1) + s(2, 2);
    let row = |k: usize| {
        let symmetric = DVec3::from_array(std::array::from_fn(|j| s(k, j) + s(j, k)));
        let diagonal = DVec3::AXES[k] * trace;
        (symmetric - diagonal).extend(w[k])
    };
    DMat4::from_cols(row(0), row(1), row(2), DVec4::new(w.x, w.y, w.z, trace))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_turn_that_was_made() {
        let sources = [DVec3::X, DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.0, 0.6, -0.8)];
        for angle in [0.0, 0.4, 3.0, std::f64::consts::PI] {
            let turn = DQuat::from_axis_angle(DVec3::new(2.0, -1.0, 2.0) / 3.0, angle);
            for count in [2, 3] {
                let found = rotation(sources[..count].iter().map(|&d| (d, turn * d)));
                // Products of 2²⁰ roundings of 1e-16.
                let off = |q: DQuat| sources.iter().map(|&d| (q * d).distance(turn * d)).fold(0.0, f64::max);
                assert!(off(found) < 1e-9, "{angle}: {}", off(found));
                assert!(off(found * DQuat::from_rotation_y(0.1)) > 0.01);
            }
        }
    }

    #[test]
    fn any_turn_will_do_for_nothing() {
        assert!(rotation(std::iter::empty()).is_normalized());
    }
}
