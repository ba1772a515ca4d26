//! What leaves, sorted by ring.

use super::{BATCHES, Setup};
use std::f64::consts::PI;

/// Mean and standard error of one quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Mean.
    pub value: f64,
    /// One standard error of it.
    pub error: f64,
}

/// Rings of one face: the share of light that leaves in each, the last one beyond all edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Rings {
    /// A value for each ring.
    pub rings: Vec<Estimate>,
    /// Of all rings together.
    pub total: Estimate,
}

/// Light at one face for one albedo.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    /// Scattered exactly once.
    pub single: Rings,
    /// Scattered more than once.
    pub multiple: Rings,
    /// Both.
    pub all: Rings,
    /// Never scattered, in all.
    pub unscattered: Estimate,
}

/// Result of a run, one entry for each albedo.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// What leaves where light entered.
    pub reflected: Vec<Face>,
    /// What leaves on the other side of a slab.
    pub transmitted: Vec<Face>,
    /// What stays.
    pub absorbed: Vec<Estimate>,
    /// What was still on its way after a million scatterings, where next to nothing is absorbed.
    pub unfinished: Vec<Estimate>,
    /// Outer radii of the rings, mean free paths.
    pub edges: Vec<f64>,
}

impl Light {
    pub(super) fn new(setup: &Setup, batches: &[Tally]) -> Self {
        let albedos = 0..setup.albedos.len();
        let of = |each: &dyn Fn(&Tally) -> f64| estimate(batches.iter().map(each));
        let face = |below: usize, k: usize| {
            let albedo = setup.albedos[k];
            let single = move |tally: &Tally, ring: usize| albedo * tally.single[below][ring];
            let count = setup.albedos.len();
            let multiple = move |tally: &Tally, ring: usize| tally.multiple[below][ring * count + k];
            Face {
                single: rings(batches, setup, &single),
                multiple: rings(batches, setup, &multiple),
                all: rings(batches, setup, &|tally, ring| single(tally, ring) + multiple(tally, ring)),
                unscattered: of(&|tally| tally.unscattered[below]),
            }
        };
        Self {
            reflected: albedos.clone().map(|k| face(0, k)).collect(),
            transmitted: albedos.clone().map(|k| face(1, k)).collect(),
            absorbed: albedos.clone().map(|k| of(&|tally| tally.absorbed[k])).collect(),
            unfinished: albedos.map(|k| of(&|tally| tally.unfinished[k])).collect(),
            edges: setup.edges.clone(),
        }
    }

    /// Area of a ring in squared mean free paths; infinite for the last.
    #[must_use]
    pub fn area(&self, ring: usize) -> f64 {
        let inner = if ring == 0 { 0.0 } else { self.edges[ring - 1] };
        self.edges.get(ring).map_or(f64::INFINITY, |outer| PI * (outer - inner) * (outer + inner))
    }
}

fn rings(batches: &[Tally], setup: &Setup, each: &dyn Fn(&Tally, usize) -> f64) -> Rings {
    let count = setup.edges.len() + 1;
    let ring = |ring: usize| estimate(batches.iter().map(|tally| each(tally, ring)));
    let total = estimate(batches.iter().map(|tally| (0..count).map(|ring| each(tally, ring)).sum()));
    Rings { rings: (0..count).map(ring).collect(), total }
}

fn estimate(batches: impl Iterator<Item = f64> + Clone) -> Estimate {
    let count = BATCHES as f64;
    let value = batches.clone().sum::<f64>() / count;
    let variance = batches.map(|x| (x - value).powi(2)).sum::<f64>() / (count - 1.0);
    Estimate { value, error: (variance / count).sqrt() }
}

/// Sums of one batch. Faces: 0 above, 1 below.
pub(super) struct Tally {
    edges: Vec<f64>,
    /// Scattered once, over the albedo: face, ring.
    single: [Vec<f64>; 2],
    /// Scattered more often: face, ring × albedo.
    multiple: [Vec<f64>; 2],
    unscattered: [f64; 2],
    pub absorbed: Vec<f64>,
    unfinished: Vec<f64>,
}

impl Tally {
    pub fn new(setup: &Setup) -> Self {
        let (rings, albedos) = (setup.edges.len() + 1, setup.albedos.len());
        Self {
            edges: setup.edges.clone(),
            single: [(); 2].map(|()| vec![0.0; rings]),
            multiple: [(); 2].map(|()| vec![0.0; rings * albedos]),
            unscattered: [0.0; 2],
            absorbed: vec![0.0; albedos],
            unfinished: vec![0.0; albedos],
        }
    }

    /// A `share` of the weights leaves at radius `r`.
    pub fn leave(&mut self, below: bool, order: u64, r: f64, share: f64, weights: &[f64]) {
        let face = usize::from(below);
        let ring = || self.edges.partition_point(|&edge| edge <= r);
        match order {
            0 => self.unscattered[face] += share,
            1 => self.single[face][ring()] += share,
            _ => {
                let first = ring() * weights.len();
                let row = &mut self.multiple[face][first..first + weights.len()];
                row.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += share * weight);
            }
        }
    }

    pub fn give_up(&mut self, weights: &[f64]) {
        self.unfinished.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight);
    }

    pub fn divide(&mut self, photons: f64) {
        let all = self.single.iter_mut().chain(&mut self.multiple).flatten();
        let rest = self.unscattered.iter_mut().chain(&mut self.absorbed).chain(&mut self.unfinished);
        all.chain(rest).for_each(|sum| *sum /= photons);
    }
}
