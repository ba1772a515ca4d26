//! Gauss–Legendre rules.

use std::f64::consts::PI;
use std::sync::LazyLock;

/// Nodes and weights on [0, 1].
pub(crate) type Rule<const N: usize> = LazyLock<[(f64, f64); N]>;

pub(crate) static GAUSS_8: Rule<8> = LazyLock::new(gauss_legendre);
pub(crate) static GAUSS_12: Rule<12> = LazyLock::new(gauss_legendre);
pub(crate) static GAUSS_32: Rule<32> = LazyLock::new(gauss_legendre);
pub(crate) static GAUSS_64: Rule<64> = LazyLock::new(gauss_legendre);

/// ∫ f over [0, 1].
pub(crate) fn integrate(nodes: &[(f64, f64)], f: impl Fn(f64) -> f64) -> f64 {
    nodes.iter().map(|&(x, weight)| weight * f(x)).sum()
}

/// Roots of the Legendre polynomial by Newton's method.
fn gauss_legendre<const N: usize>() -> [(f64, f64); N] {
    std::array::from_fn(|k| {
        let mut x = (PI * (k as f64 + 0.75) / (N as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..50 {
            let (mut previous, mut value) = (1.0, x);
            for n in 2..=N {
                let n = n as f64;
                (previous, value) = (value, ((2.0 * n - 1.0) * x * value - (n - 1.0) * previous) / n);
            }
            slope = N as f64 * (x * value - previous) / (x * x - 1.0);
            x -= value / slope;
        }
        (0.5 + 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_have_their_degree() {
        for (nodes, degree) in
            [(&GAUSS_8[..], 15), (&GAUSS_12[..], 23), (&GAUSS_32[..], 63), (&GAUSS_64[..], 127)]
        {
            let power = |n: i32| integrate(nodes, |x| (2.0 * x - 1.0).powi(n)) * f64::from(n + 1);
            // Rounding.
            assert!((power(degree - 1) - 1.0).abs() < 1e-12, "{degree}");
            let beyond = (power(degree + 1) - 1.0).abs();
            assert!(degree > 23 || beyond > 1e-8, "{degree}: one more must not come out, {beyond:e}");
        }
    }
}
