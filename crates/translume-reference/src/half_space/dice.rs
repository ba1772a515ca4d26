//! Random numbers and directions.

use std::f64::consts::TAU;

/// Splitmix64 (Steele, Lea, Flood 2014).
pub(super) struct Dice(u64);

impl Dice {
    /// Streams of one seed start far apart.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut dice = Self(seed);
        let start = dice.bits();
        Self(start ^ Self(stream ^ 0x6a09_e667_f3bc_c908).bits())
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    /// 0..1.
    pub fn roll(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A free path, in means.
    pub fn flight(&mut self) -> f64 {
        -(1.0 - self.roll()).ln()
    }

    /// A direction after scattering: `g` is the mean cosine to `from`, a unit vector. Henyey, Greenstein 1941.
    pub fn scatter(&mut self, from: [f64; 3], g: f64) -> [f64; 3] {
        let (u, turn) = (self.roll(), TAU * self.roll());
        if g == 0.0 {
            return around([0.0, 0.0, 1.0], 2.0 * u - 1.0, turn);
        }
        let part = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
        around(from, ((1.0 + g * g - part * part) / (2.0 * g)).clamp(-1.0, 1.0), turn)
    }
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
