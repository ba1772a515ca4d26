//! A profile without a closed form, sampled once over the logarithm of r.

use super::radial::Radial;
use crate::quadrature::{GAUSS_8, GAUSS_12, integrate};
use std::f64::consts::{LN_2, TAU};

/// Knots per octave of r. Cubic interpolation of ln R_d then stays within 1e-5 of photon beams (test
/// `interpolation_follows_the_profile`).
const KNOTS_PER_OCTAVE: f64 = 12.0;
const STEP: f64 = LN_2 / KNOTS_PER_OCTAVE;
/// What to sample, in mean free paths: far below and above what any texel or body needs, for both ends go on as power laws.
pub(crate) const RANGE: [f64; 2] = [1e-5, 1e6];
/// Stands for nothing, and keeps the interpolation finite.
const LEAST: f64 = 1e-290;

/// Knots of ln(R_d·e^(decay·r)) with the integrals up to and beyond each. Nearer and farther a power law goes on.
pub(crate) struct Sampled {
    decay: f64,
    smooth_length: f64,
    /// ln of the first knot's r.
    first: f64,
    logarithms: Vec<f64>,
    /// ∫ R_d 2πρ dρ from 0 to each knot.
    enclosed: Vec<f64>,
    /// e^(decay·r) times the same from each knot on.
    beyond: Vec<f64>,
}

/// What a profile says of itself before it is sampled.
pub(crate) struct Shape {
    /// As [`Radial::decay`].
    pub decay: f64,
    /// As [`Radial::smooth_length`].
    pub smooth_length: f64,
    /// Nearest and farthest r to be sampled, mm.
    pub range: [f64; 2],
}

impl Sampled {
    /// `scaled`: as [`Radial::scaled_reflectance`], ≥ 0.
    pub fn new(shape: &Shape, scaled: impl Fn(f64) -> f64) -> Self {
        let [first, last] = shape.range.map(f64::ln);
        let count = 2 + ((last - first) / STEP).ceil() as usize;
        let logarithms: Vec<f64> =
            (0..count).map(|k| scaled((first + STEP * k as f64).exp()).max(LEAST).ln()).collect();
        let mut sampled = Self {
            decay: shape.decay,
            smooth_length: shape.smooth_length,
            first,
            logarithms,
            enclosed: Vec::new(),
            beyond: Vec::new(),
        };
        sampled.add_up();
        sampled
    }

    fn add_up(&mut self) {
        let last = self.logarithms.len() - 1;
        let cells: Vec<f64> =
            (0..last).map(|k| self.band(self.knot(k), self.knot(k + 1), &*GAUSS_8)).collect();
        let mut enclosed = self.within_first(self.knot(0));
        self.enclosed.push(enclosed);
        for (k, cell) in cells.iter().enumerate() {
            enclosed += cell * (-self.decay * self.knot(k)).exp();
            self.enclosed.push(enclosed);
        }
        self.beyond = vec![self.beyond_last(self.knot(last)); last + 1];
        for k in (0..last).rev() {
            let fall = (-self.decay * (self.knot(k + 1) - self.knot(k))).exp();
            self.beyond[k] = cells[k] + self.beyond[k + 1] * fall;
        }
    }

    fn knot(&self, k: usize) -> f64 {
        (self.first + STEP * k as f64).exp()
    }

    /// The knot at or below r > 0, and how far from it to the next; no cell beyond the ends.
    fn place(&self, r: f64) -> (usize, f64) {
        let at = (r.ln() - self.first) / STEP;
        let cell = at.clamp(0.0, (self.logarithms.len() - 2) as f64).floor();
        (cell as usize, at - cell)
    }

    /// Slope of ln R_d over ln r at the first knots, where R_d must stay integrable.
    fn first_slope(&self) -> f64 {
        let rise = self.logarithms[1] - self.logarithms[0] - self.decay * (self.knot(1) - self.knot(0));
        (rise / STEP).max(-1.9)
    }

    /// Slope of ln(R_d·e^(decay·r)) at the last.
    fn last_slope(&self) -> f64 {
        let last = self.logarithms.len() - 1;
        ((self.logarithms[last] - self.logarithms[last - 1]) / STEP).min(-2.1)
    }

    fn logarithm(&self, r: f64) -> f64 {
        let (k, t) = self.place(r);
        let y = &self.logarithms;
        if t < 0.0 {
            return y[0] + self.first_slope() * STEP * t + self.decay * (r - self.knot(0));
        }
        if t > 1.0 {
            return y[k + 1] + self.last_slope() * STEP * (t - 1.0);
        }
        // Catmull and Rom's cubic.
        let before = if k == 0 { 2.0 * y[0] - y[1] } else { y[k - 1] };
        let after = if k + 2 == y.len() { 2.0 * y[k + 1] - y[k] } else { y[k + 2] };
        let (slope, next_slope) = (0.5 * (y[k + 1] - before), 0.5 * (after - y[k]));
        let rise = y[k + 1] - y[k];
        let cubic = (slope + next_slope - 2.0 * rise) * t + 3.0 * rise - 2.0 * slope - next_slope;
        y[k] + t * (slope + t * cubic)
    }

    /// As `scaled_ring`, by quadrature over ln ρ: for rings that are not wide.
    fn band(&self, inner: f64, outer: f64, nodes: &[(f64, f64)]) -> f64 {
        let width = ((outer - inner) / inner).ln_1p();
        width
            * integrate(nodes, |x| {
                let growth = (x * width).exp_m1();
                let rho = inner * (1.0 + growth);
                TAU * rho * rho * (self.logarithm(rho) - self.decay * inner * growth).exp()
            })
    }

    /// ∫ R_d 2πρ dρ from 0 to r at or below the first knot.
    fn within_first(&self, r: f64) -> f64 {
        if r == 0.0 {
            0.0
        } else {
            TAU * r * r * (self.logarithm(r) - self.decay * r).exp() / (2.0 + self.first_slope())
        }
    }

    /// e^(decay·r) · ∫ R_d 2πρ dρ from r at or beyond the last knot on.
    fn beyond_last(&self, r: f64) -> f64 {
        TAU * r * r * self.logarithm(r).exp() / (self.decay * r - self.last_slope() - 2.0)
    }

    fn within(&self, r: f64) -> f64 {
        if r <= self.knot(0) {
            return self.within_first(r);
        }
        let (k, t) = self.place(r);
        let knot = self.knot(k);
        if t > 1.0 {
            let beyond = self.beyond_last(r) * (-self.decay * r).exp();
            return self.total() - beyond;
        }
        self.enclosed[k] + self.band(knot, r, &*GAUSS_8) * (-self.decay * knot).exp()
    }

    fn scaled_beyond(&self, r: f64) -> f64 {
        if r <= self.knot(0) {
            return (self.total() - self.within_first(r)) * (self.decay * r).exp();
        }
        let (k, t) = self.place(r);
        if t > 1.0 {
            return self.beyond_last(r);
        }
        let next = self.knot(k + 1);
        self.band(r, next, &*GAUSS_8) + self.beyond[k + 1] * (-self.decay * (next - r)).exp()
    }
}

impl Radial for Sampled {
    fn decay(&self) -> f64 {
        self.decay
    }

    fn scaled_reflectance(&self, r: f64) -> f64 {
        self.logarithm(r).exp()
    }

    fn scaled_ring(&self, inner: f64, outer: f64) -> f64 {
        let width = outer - inner;
        if width < 0.2 * inner && self.decay * width < 1.0 {
            return self.band(inner, outer, &*GAUSS_12);
        }
        // Of the two differences the one that takes less from more.
        let enclosed = self.within(inner);
        if enclosed < 0.5 * self.total() {
            (self.within(outer) - enclosed) * (self.decay * inner).exp()
        } else {
            self.scaled_beyond(inner) - self.scaled_beyond(outer) * (-self.decay * width).exp()
        }
    }

    fn total(&self) -> f64 {
        self.enclosed[0] + self.beyond[0] * (-self.decay * self.knot(0)).exp()
    }

    fn smooth_length(&self) -> f64 {
        self.smooth_length
    }
}
