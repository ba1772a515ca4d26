//! Directions of a walk.

use std::f64::consts::TAU;

use crate::dice::Dice;

/// A direction after scattering: `g` is the mean cosine to `from`, a unit vector. Henyey, Greenstein 1941.
pub(super) fn scatter(dice: &mut Dice, from: [f64; 3], g: f64) -> [f64; 3] {
    let (u, turn) = (dice.roll(), TAU * dice.roll());
    if g == 0.0 {
        return around([0.0, 0.0, 1.0], 2.0 * u - 1.0, turn);
    }
    let part = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
    around(from, ((1.0 + g * g - part * part) / (2.0 * g)).clamp(-1.0, 1.0), turn)
}

/// The unit vector at a cosine to `axis`, turned about it.
pub(super) fn around(axis: [f64; 3], cosine: f64, turn: f64) -> [f64; 3] {
    let sine = ((1.0 - cosine) * (1.0 + cosine)).sqrt();
    let (y, x) = turn.sin_cos();
    let (x, y) = (sine * x, sine * y);
    // Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
    let sign = 1.0_f64.copysign(axis[2]);
    let a = -1.0 / (sign + axis[2]);
    let b = axis[0] * axis[1] * a;
    let first = [1.0 + sign * axis[0] * axis[0] * a, sign * b, -sign * axis[0]];
    let second = [b, sign + axis[1] * axis[1] * a, -axis[1]];
    [0, 1, 2].map(|k| x * first[k] + y * second[k] + cosine * axis[k])
}
