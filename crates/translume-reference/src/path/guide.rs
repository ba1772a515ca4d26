//! Where light is worth following from: cells of the lights' squares of directions, chosen by what came of them.

use super::PathTracer;
use super::emit::Ray;
use super::lamp::Lamp;
use super::walk::Splat;
use crate::dice::Dice;
use crate::lights::density::{pick, running};
use crate::rgb::{accumulate, mean, scale};

/// Cells along each side of a light's square.
const SIDE: usize = 64;

/// Cells on each side that share what they know.
const REACH: usize = 1;

/// This share of the light's paths starts as if nothing was known.
const LEAST: f64 = 0.1;

/// Rays from which a light's power is estimated, to share paths among lights.
const PROBES: u32 = 256;

/// Probabilities of the cells of all lights.
pub(super) struct Guide {
    shares: Vec<f64>,
    sums: Vec<f64>,
}

/// What came of each cell.
pub(super) struct Yield {
    paths: Vec<f64>,
    steps: Vec<f64>,
    squares: Vec<[f64; 3]>,
}

impl Guide {
    /// In proportion to power.
    pub fn new(tracer: &PathTracer<'_>) -> Self {
        let mut dice = Dice::new([0; 4]);
        let mut power = |lamp: &Lamp| {
            let mut probe = || {
                let place = dice.pair();
                mean(lamp.emit(&tracer.bounds, place, &mut dice).power)
            };
            (0..PROBES).map(|_| probe()).sum::<f64>()
        };
        let powers: Vec<f64> = tracer.lamps.iter().map(&mut power).collect();
        let least = LEAST * powers.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let shares = powers.into_iter().flat_map(|power| [power + least; SIDE * SIDE]).collect();
        Self::from_shares(shares)
    }

    fn from_shares(shares: Vec<f64>) -> Self {
        let total: f64 = shares.iter().sum();
        let shares: Vec<f64> = shares.into_iter().map(|share| share / total).collect();
        Self { sums: running(shares.iter().copied()), shares }
    }

    pub fn nothing(&self) -> Yield {
        let none = vec![0.0; self.shares.len()];
        Yield { paths: none.clone(), steps: none, squares: vec![[0.0; 3]; self.shares.len()] }
    }

    /// A ray, and the cell it is from.
    pub fn emit(&self, tracer: &PathTracer<'_>, dice: &mut Dice) -> (Ray, usize) {
        let (cell, _) = pick(&self.sums, dice.roll());
        let (lamp, within) = (Self::lamp(cell), cell % (SIDE * SIDE));
        let [x, y] = dice.pair();
        let place = [(within % SIDE) as f64 + x, (within / SIDE) as f64 + y].map(|x| x / SIDE as f64);
        let ray = tracer.lamps[lamp].emit(&tracer.bounds, place, dice);
        let weight = 1.0 / (self.shares[cell] * (SIDE * SIDE) as f64);
        (Ray { power: scale(ray.power, weight), ..ray }, cell)
    }

    /// The light that a cell belongs to.
    pub fn lamp(cell: usize) -> usize {
        cell / (SIDE * SIDE)
    }

    /// The guide under which squares, over those of the channels' means, have the least sum after as many steps; and under it that sum and
    /// the steps, for each path.
    pub fn learned(&self, found: &Yield, means: [f64; 3]) -> (Self, [f64; 2]) {
        let relative = |squares: &[f64; 3]| {
            (0..3).filter(|&k| means[k] > 0.0).map(|k| squares[k] / means[k].powi(2)).sum::<f64>()
        };
        let squares: Vec<f64> = found.squares.iter().map(relative).collect();
        let cells = 0..self.shares.len();
        let [squares, steps] = [&squares, &found.steps].map(|values| -> Vec<f64> {
            let mean = |cell| around(values, cell) / around(&found.paths, cell).max(1.0);
            cells.clone().map(mean).collect()
        });
        let wanted = |cell: usize| self.shares[cell] * (squares[cell] / steps[cell].max(1.0)).sqrt();
        let wanted: Vec<f64> = cells.clone().map(wanted).collect();
        let sum: f64 = wanted.iter().sum();
        let mixed = |cell: usize| {
            let share = self.shares[cell];
            if sum > 0.0 { LEAST * share + (1.0 - LEAST) * wanted[cell] / sum } else { share }
        };
        let guide = Self::from_shares(cells.clone().map(mixed).collect());
        let weighted = |cell: usize| self.shares[cell].powi(2) / guide.shares[cell] * squares[cell];
        let path =
            [cells.clone().map(weighted).sum(), cells.map(|cell| guide.shares[cell] * steps[cell]).sum()];
        (guide, path)
    }
}

impl Yield {
    /// Counts a path of a cell, its steps and what it brought.
    pub fn add(&mut self, cell: usize, steps: u64, splats: &[Splat]) {
        self.paths[cell] += 1.0;
        self.steps[cell] += steps as f64;
        for splat in splats {
            let squares = splat.radiance.map(|radiance| radiance * radiance);
            accumulate(&mut self.squares[cell], squares, 1.0);
        }
    }
}

/// Sum of a value over a cell and its neighbours of the same light.
fn around(values: &[f64], cell: usize) -> f64 {
    let (first, within) = (cell - cell % (SIDE * SIDE), cell % (SIDE * SIDE));
    let range = |at: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(SIDE);
    let columns = range(within % SIDE);
    range(within / SIDE)
        .map(|row| {
            let row = first + row * SIDE;
            values[row + columns.start..row + columns.end].iter().sum::<f64>()
        })
        .sum()
}
