//! Albedo of an index-matched half-space that scatters isotropically, exact: Chandrasekhar 1950, "Radiative Transfer", ch. V.

use super::half_space::Entry;
use crate::quadrature::GAUSS_32;

/// Share of light that leaves again, 0..=1, for a single-scattering albedo of 0..=1: 1 − √(1 − α)·H(1), or the same with the mean
/// 2·∫ H(μ) μ dμ.
pub(crate) fn albedo(single: f64, entry: Entry) -> f64 {
    let single = single.clamp(0.0, 1.0);
    let root = (1.0 - single).sqrt();
    let h = h_function(single, root);
    let mean = match entry {
        Entry::Normal => equation(&h, single, root, 1.0),
        Entry::Diffuse => GAUSS_32.iter().zip(&h).map(|((mu, weight), h)| 2.0 * weight * mu * h).sum(),
    };
    (1.0 - root * mean).clamp(0.0, 1.0)
}

/// H at the Gauss nodes: the fixed point of 1/H(μ) = √(1 − α) + α/2·∫ μ' H(μ')/(μ + μ') dμ'.
fn h_function(single: f64, root: f64) -> [f64; 32] {
    let mut h = [1.0; 32];
    // Each round about halves the error or better; the average of old and new keeps it from swinging.
    for _ in 0..60 {
        let next: [f64; 32] = std::array::from_fn(|k| equation(&h, single, root, GAUSS_32[k].0));
        let moved = h.iter().zip(&next).map(|(old, new)| (old - new).abs()).fold(0.0, f64::max);
        h = std::array::from_fn(|k| 0.5 * (h[k] + next[k]));
        if moved < 1e-9 {
            break;
        }
    }
    h
}

fn equation(h: &[f64; 32], single: f64, root: f64, mu: f64) -> f64 {
    let nodes = GAUSS_32.iter().zip(h);
    let integral: f64 = nodes.map(|((other, weight), h)| weight * other * h / (mu + other)).sum();
    1.0 / (root + 0.5 * single * integral)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// H(1) of isotropic scattering: Chandrasekhar's table XI gives 2.9078 without absorption and 1.8 to 2 in between.
    #[test]
    fn h_follows_the_published_table() {
        let at_one = |single: f64| {
            let root = (1.0 - single).sqrt();
            equation(&h_function(single, root), single, root, 1.0)
        };
        // Four digits are printed.
        assert!((at_one(1.0) - 2.9078).abs() < 1e-4, "{}", at_one(1.0));
        assert!((at_one(0.99) - 2.9078).abs() > 0.1, "a little absorption must be noticed");
    }

    #[test]
    fn limits() {
        for entry in [Entry::Normal, Entry::Diffuse] {
            assert_eq!(albedo(0.0, entry), 0.0);
            assert_eq!(albedo(1.0, entry), 1.0);
            // To first order what leaves was scattered once: α/2·∫ μ/(1 + μ) dμ = α/2·(1 − ln 2) along the normal.
            let mut before = 0.0;
            for single in [1e-3, 0.1, 0.5, 0.9, 0.99, 0.9999] {
                let now = albedo(single, entry);
                assert!(now > before && now < single);
                before = now;
            }
        }
        let once = 0.5e-4 * (1.0 - 2.0_f64.ln());
        // The second scattering is 1e-4 of the first; the Gauss rule adds as little.
        assert!((albedo(1e-4, Entry::Normal) / once - 1.0).abs() < 1e-3);
    }
}
