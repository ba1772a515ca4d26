//! A profile from a table of the user's.

use super::radial::Radial;
use crate::Error;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Radii and R_d there, for measured profiles: straight lines between in ln R_d over ln r, constant before the first radius, an
/// exponential with the slope of the last two beyond.
///
/// ```
/// use translume::{Profile, Table};
///
/// let table = Table { radii: [0.1, 1.0, 5.0].into(), values: [[0.5; 3], [0.05; 3], [0.0005; 3]].into() };
/// let profile = Profile::Tabulated(table);
/// profile.validate()?;
/// # Ok::<(), translume::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// r, mm: at least two, ascending, finite, > 0.
    pub radii: Arc<[f32]>,
    /// R_d at each radius, RGB, 1/mm². A channel is > 0 everywhere, falling between the last two radii, or 0 everywhere. Its integral over
    /// the plane, the albedo of the surface, is at most 1 (1 % of slack).
    pub values: Arc<[[f32; 3]]>,
}

impl Table {
    /// # Errors
    /// [`Error::Profile`] names the entry that cannot be.
    pub(crate) fn validate(&self) -> Result<(), Error> {
        let fail = |problem: String, remedy| Err(Error::Profile { problem, remedy });
        let count = self.radii.len();
        if count < 2 || self.values.len() != count {
            let problem = format!("table of {count} radii and {} values", self.values.len());
            return fail(problem, "give as many values as radii, at least two");
        }
        for (k, &r) in self.radii.iter().enumerate() {
            let before = if k == 0 { 0.0 } else { self.radii[k - 1] };
            if !(r > before && r.is_finite()) {
                let problem = format!("radius {k} of the table is {r} mm after {before}");
                return fail(problem, "sort radii from small to large, above 0, each once");
            }
        }
        (0..3).try_for_each(|channel| self.validate_channel(channel))
    }

    fn validate_channel(&self, channel: usize) -> Result<(), Error> {
        let name = ["red", "green", "blue"][channel];
        let fail = |problem: String, remedy| Err(Error::Profile { problem, remedy });
        let value = |k: usize| self.values[k][channel];
        let count = self.radii.len();
        if (0..count).all(|k| value(k) == 0.0) {
            return Ok(());
        }
        if let Some(k) = (0..count).find(|&k| !(value(k) > 0.0 && value(k).is_finite())) {
            let problem = format!("entry {k} of the table is {} in {name}", value(k));
            return fail(problem, "give finite values above 0, or a channel of zeros");
        }
        if value(count - 1) >= value(count - 2) {
            let problem = format!("entry {} of the table, the last, does not fall in {name}", count - 1);
            return fail(problem, "go on until the profile dies out");
        }
        let total = PowerLaws::new(self, channel).total();
        if total > 1.01 {
            let problem = format!("the table gives back {total} of the light in {name}");
            return fail(problem, "give values in 1/mm² whose integral over the plane is at most 1");
        }
        Ok(())
    }
}

/// One channel of a table: a power law between each pair of radii.
pub(crate) struct PowerLaws {
    radii: Vec<f64>,
    logarithms: Vec<f64>,
    /// Exponent between each radius and the next.
    exponents: Vec<f64>,
    /// ∫ R_d 2πρ dρ from 0 to each radius.
    enclosed: Vec<f64>,
    /// From each radius on.
    beyond: Vec<f64>,
    /// Rate beyond the last radius, 1/mm.
    rate: f64,
}

impl PowerLaws {
    pub fn new(table: &Table, channel: usize) -> Self {
        let radii: Vec<f64> = table.radii.iter().map(|&r| r.into()).collect();
        let value = |row: &[f32; 3]| f64::from(row[channel]).max(f64::MIN_POSITIVE).ln();
        let logarithms: Vec<f64> = table.values.iter().map(value).collect();
        let slope = |k: usize| (logarithms[k + 1] - logarithms[k]) / (radii[k + 1] / radii[k]).ln();
        let last = radii.len() - 1;
        let rate = (logarithms[last - 1] - logarithms[last]) / (radii[last] - radii[last - 1]);
        let exponents = (0..last).map(slope).collect();
        let mut laws = Self {
            radii,
            logarithms,
            exponents,
            enclosed: Vec::new(),
            beyond: Vec::new(),
            rate: rate.max(1e-12),
        };
        laws.add_up();
        laws
    }

    fn add_up(&mut self) {
        let cells: Vec<f64> =
            (0..self.exponents.len()).map(|k| self.piece(k, self.radii[k], self.radii[k + 1])).collect();
        let first = 0.5 * TAU * self.radii[0].powi(2) * self.logarithms[0].exp();
        self.enclosed = vec![first];
        self.beyond = vec![self.tail(self.radii[cells.len()])];
        for (k, cell) in cells.iter().enumerate() {
            self.enclosed.push(self.enclosed[k] + cell);
        }
        for cell in cells.iter().rev() {
            let nearest = self.beyond[self.beyond.len() - 1];
            self.beyond.push(nearest + cell);
        }
        self.beyond.reverse();
    }

    /// ∫ of law k between two radii: v_a·a²·2π·((b/a)^(p + 2) − 1)/(p + 2), in one expm1 for thin rings.
    fn piece(&self, k: usize, from: f64, to: f64) -> f64 {
        let power = self.exponents[k] + 2.0;
        let width = ((to - from) / from).ln_1p();
        let growth = if (power * width).abs() < 1e-12 { width } else { (power * width).exp_m1() / power };
        TAU * from
            * from
            * (self.logarithms[k] + self.exponents[k] * (from / self.radii[k]).ln()).exp()
            * growth
    }

    /// ∫ from r at or beyond the last radius on.
    fn tail(&self, r: f64) -> f64 {
        TAU * self.logarithm(r).exp() * (r + 1.0 / self.rate) / self.rate
    }

    /// The last radius at or below r, if any.
    fn below(&self, r: f64) -> Option<usize> {
        self.radii.partition_point(|&knot| knot <= r).checked_sub(1)
    }

    fn logarithm(&self, r: f64) -> f64 {
        match self.below(r) {
            None => self.logarithms[0],
            Some(k) if k < self.exponents.len() => {
                self.logarithms[k] + self.exponents[k] * (r / self.radii[k]).ln()
            }
            Some(k) => self.logarithms[k] - self.rate * (r - self.radii[k]),
        }
    }

    fn ring_without_scale(&self, inner: f64, outer: f64) -> f64 {
        let (from, to) = (self.below(inner), self.below(outer));
        let flat = |a: f64, b: f64| 0.5 * TAU * (b - a) * (b + a) * self.logarithms[0].exp();
        let (first, last) = (self.radii[0], self.exponents.len());
        // What is left of the piece that `inner` lies in, and what of the piece of `outer` lies before it.
        let step = |k: usize, a: f64, b: f64| if k < last { self.piece(k, a, b) } else { self.fall(a, b) };
        match (from, to) {
            (None, None) => flat(inner, outer),
            (None, Some(m)) => flat(inner, first) + self.between(0, m) + step(m, self.radii[m], outer),
            (Some(k), Some(m)) if k < m => {
                step(k, inner, self.radii[k + 1]) + self.between(k + 1, m) + step(m, self.radii[m], outer)
            }
            (Some(k), _) => step(k, inner, outer),
        }
    }

    /// From radius k to radius m ≥ k; of the two differences the one that takes less from more.
    fn between(&self, k: usize, m: usize) -> f64 {
        if self.enclosed[k] < self.beyond[k] {
            self.enclosed[m] - self.enclosed[k]
        } else {
            self.beyond[k] - self.beyond[m]
        }
    }

    /// ∫ between two radii at or beyond the last.
    fn fall(&self, from: f64, to: f64) -> f64 {
        let (length, step) = (1.0 / self.rate, to - from);
        let lost = -(-self.rate * step).exp_m1();
        TAU * self.logarithm(from).exp() * length * ((from + length) * lost - step * (1.0 - lost))
    }
}

impl Radial for PowerLaws {
    fn decay(&self) -> f64 {
        // The whole rate, unless that overflows within the table.
        self.rate.min(600.0 / self.radii[self.radii.len() - 1])
    }

    fn scaled_reflectance(&self, r: f64) -> f64 {
        (self.logarithm(r) + self.decay() * r).exp()
    }

    fn scaled_ring(&self, inner: f64, outer: f64) -> f64 {
        // Far out the ring itself underflows first, where the table of kernels has nothing left to say.
        self.ring_without_scale(inner, outer) * (self.decay() * inner).min(700.0).exp()
    }

    fn total(&self) -> f64 {
        self.enclosed[0] + self.beyond[0]
    }

    fn smooth_length(&self) -> f64 {
        self.radii[0]
    }
}
