//! Random numbers.

use crate::lights::strata::{mix, unit};

/// A stream of independent numbers: SplitMix64 (Steele, Lea and Flood 2014).
pub(crate) struct Dice(u64);

impl Dice {
    /// A stream of its own for every list of numbers.
    pub fn new(words: [u64; 4]) -> Self {
        Self(words.into_iter().fold(0, |state, word| mix(state ^ word)))
    }

    /// Streams of one seed start far apart.
    pub fn stream(seed: u64, stream: u64) -> Self {
        Self(mix(seed) ^ mix(stream ^ 0x6a09_e667_f3bc_c908))
    }

    /// 0 ≤ u < 1.
    pub fn roll(&mut self) -> f64 {
        let bits = mix(self.0);
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        unit(bits)
    }

    pub fn pair(&mut self) -> [f64; 2] {
        [self.roll(), self.roll()]
    }

    /// Exponentially distributed with mean 1, ≥ 0.
    pub fn exponential(&mut self) -> f64 {
        -(1.0 - self.roll()).ln()
    }
}
