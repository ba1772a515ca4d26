//! A profile from nothing but its R_d(r): splines over the logarithm of r, and quadrature.

use std::f64::consts::{LN_2, PI};

use super::Profile;
use crate::quadrature::integrate;

/// Knots per octave. A cubic spline of ln R_d over ln r then follows a dipole within 1e-7 (see the tests).
const PER_OCTAVE: f64 = 16.0;

/// R_d as a natural cubic spline of its logarithm, continued as a power law times an exponential at both ends.
#[derive(Clone, Debug)]
pub struct Numeric {
    decay: f64,
    core: f64,
    low: f64,
    step: f64,
    /// ln R_d + decay·r at the knots, and second derivatives there over the knot's index.
    values: Vec<f64>,
    curvatures: Vec<f64>,
    enclosed: Vec<f64>,
    beyond: Vec<f64>,
}

impl Numeric {
    /// `reflectance`: R_d(r) in 1/mm², > 0 where it counts. `decay`, `core`: as those of [`Profile`]. `range`: smallest and largest r, mm,
    /// with nothing but power laws and that exponential outside.
    #[must_use]
    pub fn new(reflectance: impl Fn(f64) -> f64, decay: f64, core: f64, range: [f64; 2]) -> Self {
        let low = range[0].ln();
        let count = ((range[1] / range[0]).ln() / LN_2 * PER_OCTAVE).ceil() as usize;
        let step = (range[1].ln() - low) / count as f64;
        let value = |k: usize| {
            let r = (low + step * k as f64).exp();
            reflectance(r).max(1e-300).ln() + decay * r
        };
        let values: Vec<f64> = (0..=count).map(value).collect();
        let curvatures = natural_spline(&values);
        let mut profile =
            Self { decay, core, low, step, values, curvatures, enclosed: vec![], beyond: vec![] };
        profile.sum_up();
        profile
    }

    fn sum_up(&mut self) {
        let count = self.values.len() - 1;
        let cells: Vec<f64> = (0..count).map(|k| self.between(self.knot(k), self.knot(k + 1))).collect();
        let first = self.knot(0);
        let mut sum = 2.0 * PI * first * first * self.reflectance(first) / (2.0 + self.first_slope());
        self.enclosed = vec![sum];
        for cell in &cells {
            sum += cell;
            self.enclosed.push(sum);
        }
        let last = self.knot(count);
        let mut sum =
            2.0 * PI * last * last * self.reflectance(last) / (self.decay * last - self.end_slope() - 2.0);
        self.beyond = vec![sum];
        for cell in cells.iter().rev() {
            sum += cell;
            self.beyond.push(sum);
        }
        self.beyond.reverse();
    }

    fn knot(&self, k: usize) -> f64 {
        (self.low + self.step * k as f64).exp()
    }

    /// Of ln R_d, without the exponential.
    fn first_slope(&self) -> f64 {
        (self.values[1] - self.values[0] - self.decay * (self.knot(1) - self.knot(0))) / self.step
    }

    /// Of ln R_d + decay·r.
    fn end_slope(&self) -> f64 {
        let last = self.values.len() - 1;
        ((self.values[last] - self.values[last - 1]) / self.step).min(-2.01)
    }

    fn place(&self, r: f64) -> (usize, f64) {
        let x = (r.ln() - self.low) / self.step;
        let k = x.floor().clamp(0.0, (self.values.len() - 2) as f64);
        (k as usize, x - k)
    }

    /// ∫ R_d 2πρ dρ between two radii, by quadrature.
    fn between(&self, from: f64, to: f64) -> f64 {
        // With ρ = from·e^v nothing cancels in a thin ring.
        let width = ((to - from) / from).ln_1p();
        let ring = |v: f64| {
            let rho = from * v.exp();
            self.reflectance(rho) * 2.0 * PI * rho * rho
        };
        integrate(ring, 0.0, width, 1e-10)
    }

    fn difference(&self, from: f64, to: f64) -> f64 {
        if to < 1.3 * from {
            self.between(from, to)
        } else if self.enclosed(from) < self.beyond(from) {
            self.enclosed(to) - self.enclosed(from)
        } else {
            self.beyond(from) - self.beyond(to)
        }
    }
}

/// Second derivatives of the spline through equidistant values with none at the ends (Thomas's algorithm).
fn natural_spline(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    let (mut upper, mut right) = (vec![0.0; n], vec![0.0; n]);
    for k in 1..n - 1 {
        let bend = 6.0 * (values[k + 1] - 2.0 * values[k] + values[k - 1]);
        let pivot = 4.0 - upper[k - 1];
        upper[k] = 1.0 / pivot;
        right[k] = (bend - right[k - 1]) / pivot;
    }
    let mut curvatures = vec![0.0; n];
    for k in (1..n - 1).rev() {
        curvatures[k] = right[k] - upper[k] * curvatures[k + 1];
    }
    curvatures
}

impl Profile for Numeric {
    fn reflectance(&self, r: f64) -> f64 {
        if r == 0.0 {
            return if self.core > 0.0 { self.reflectance(self.knot(0)) } else { f64::INFINITY };
        }
        let (k, t) = self.place(r);
        let y = &self.values;
        let value = if t < 0.0 {
            y[0] + self.first_slope() * self.step * t + self.decay * (r - self.knot(0))
        } else if t > 1.0 {
            y[k + 1] + self.end_slope() * self.step * (t - 1.0)
        } else {
            let u = 1.0 - t;
            let bend = (u * u * u - u) * self.curvatures[k] + (t * t * t - t) * self.curvatures[k + 1];
            u * y[k] + t * y[k + 1] + bend / 6.0
        };
        (value - self.decay * r).exp()
    }

    fn enclosed(&self, r: f64) -> f64 {
        if r == 0.0 {
            return 0.0;
        }
        let (k, t) = self.place(r);
        if t < 0.0 {
            self.enclosed[0] * ((2.0 + self.first_slope()) * (r.ln() - self.low)).exp()
        } else if t > 1.0 {
            self.total() - self.beyond(r)
        } else {
            self.enclosed[k] + self.between(self.knot(k), r)
        }
    }

    fn beyond(&self, r: f64) -> f64 {
        if r < self.knot(0) {
            return self.total() - self.enclosed(r);
        }
        let (k, t) = self.place(r);
        if t > 1.0 {
            return 2.0 * PI * r * r * self.reflectance(r) / (self.decay * r - self.end_slope() - 2.0);
        }
        self.beyond[k + 1] + self.between(r, self.knot(k + 1))
    }

    fn ring(&self, r: f64, width: f64) -> f64 {
        let outer = r.hypot(width);
        if r == 0.0 {
            return self.enclosed(outer);
        }
        if width < 1e-3 * r {
            // So thin that the outer radius has lost digits.
            let middle = r + 0.25 * width * width / r;
            return PI * width * width * self.reflectance(middle);
        }
        self.difference(r, outer)
    }

    fn total(&self) -> f64 {
        self.enclosed[0] + self.beyond[0]
    }

    fn decay(&self) -> f64 {
        self.decay
    }

    fn core(&self) -> f64 {
        self.core
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dipole;
    use crate::testing::assert_rel;

    #[test]
    fn a_dipole_by_numbers_is_the_dipole() {
        for (s, a, ior) in [(1.01, 0.48, 1.3), (2.19, 0.0021, 1.5), (20.4, 0.0, 1.3)] {
            let exact = Dipole::new(s, a, ior);
            let z = exact.z[0];
            let numeric = Numeric::new(|r| exact.reflectance(r), exact.sigma_tr, z, [1e-4 * z, 1e4 * z]);
            assert_rel(numeric.total(), exact.total(), 1e-6, "total");
            for r in [1e-6, 1e-3, 0.1, 0.77, 5.0, 40.0].map(|r| r * z) {
                assert_rel(numeric.reflectance(r), exact.reflectance(r), 1e-6, "R_d");
                assert_rel(numeric.enclosed(r), exact.enclosed(r), 1e-6, "enclosed");
                assert_rel(numeric.beyond(r), exact.beyond(r), 1e-6, "beyond");
                for width in [1e-9, 1e-3, 0.3, 2.0, 100.0].map(|w| w * r) {
                    assert_rel(numeric.ring(r, width), exact.ring(r, width), 1e-6, "ring");
                }
                let other = Dipole::new(1.01 * s, a, ior);
                assert!((other.reflectance(r) / numeric.reflectance(r) - 1.0).abs() > 1e-4, "1 % of σ_s'");
            }
        }
    }
}
