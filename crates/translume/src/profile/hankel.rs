//! From spatial frequencies to radii: f(r) = 1/2π · ∫ F(k) J₀(kr) k dk.

use crate::quadrature::{GAUSS_12, integrate};
use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

/// Step of Ogata's rule. Its first nodes lie at three times this over r: at 0.005 it also sees layers that are 60 times as thick as r.
const STEP: f64 = 0.005;
const NODES: usize = 600;
/// Up to this many radians of J₀ over the whole spectrum plain quadrature is best, from there on Ogata's.
const FEW_WAVES: f64 = 240.0;

/// The inverse at one radius. `band`: frequencies, 1/mm, below which F no longer changes and above which nothing is left of it.
pub(crate) fn inverse(spectrum: impl Fn(f64) -> f64, band: [f64; 2], r: f64) -> f64 {
    let integral = if r * band[1] < FEW_WAVES {
        direct(spectrum, band, r)
    } else {
        OGATA.iter().map(|[x, weight]| weight * spectrum(x / r)).sum::<f64>() / (r * r)
    };
    integral / TAU
}

/// Gauss's rule in octaves of k, none wider than a wave.
fn direct(spectrum: impl Fn(f64) -> f64, [low, high]: [f64; 2], r: f64) -> f64 {
    let panel = |from: f64, to: f64| {
        let width = to - from;
        width
            * integrate(&*GAUSS_12, |x| {
                let k = from + width * x;
                spectrum(k) * libm::j0(k * r) * k
            })
    };
    let (mut from, mut to, mut sum) = (0.0, low, 0.0);
    while from < high {
        sum += panel(from, to);
        (from, to) = (to, to + to.min(6.0 / r).min(high / 8.0));
    }
    sum
}

/// Places x and weights with ∫ f(x) J₀(x) x dx = Σ weight·f(x): a double exponential that meets the zeros of J₀. Ogata 2005, "A
/// Numerical Integration Formula Based on the Bessel Functions", eq. 5.2.
static OGATA: LazyLock<Vec<[f64; 2]>> = LazyLock::new(|| {
    let node = |k: usize| {
        let zero = zero_of_j0(k);
        let t = STEP * zero / PI;
        let x = PI / STEP * t * (0.5 * PI * t.sinh()).tanh();
        let cosh = (0.5 * PI * t.sinh()).cosh();
        let slope = (0.5 * PI * t.sinh()).tanh() + 0.5 * PI * t * t.cosh() / (cosh * cosh);
        let share = 2.0 / (zero * libm::j1(zero).powi(2));
        [x, share * x * libm::j0(x) * slope]
    };
    (0..NODES).map(node).filter(|[_, weight]| weight.is_finite()).collect()
});

/// McMahon's first terms, then Newton.
fn zero_of_j0(k: usize) -> f64 {
    let beta = (k as f64 + 0.75) * PI;
    let mut x = beta + 1.0 / (8.0 * beta);
    for _ in 0..4 {
        x += libm::j0(x) / libm::j1(x);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// z/2π(r² + z²)^(3/2) is the inverse of e^(−kz).
    fn error(r: f64, z: f64, wrong: f64) -> f64 {
        let exact = z / (TAU * r.hypot(z).powi(3));
        inverse(|k| (-k * z * wrong).exp(), [1e-3 / z, 40.0 / z], r) / exact - 1.0
    }

    #[test]
    fn a_dipole_comes_back() {
        for z in [1e-3, 1.0, 50.0] {
            for r in [1e-3, 0.1, 1.0, 3.0, 5.99, 6.01, 10.0, 100.0, 1000.0] {
                assert!(error(r * z, z, 1.0).abs() < 1e-6, "r {r} z {z}: {}", error(r * z, z, 1.0));
                assert!(error(r * z, z, 1.01).abs() > 1e-4, "r {r} z {z}: 1 % of depth must be noticed");
            }
        }
    }
}
