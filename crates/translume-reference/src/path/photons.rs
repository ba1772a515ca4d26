//! Light followed from its sources, and what it brings to the whole picture.

use rayon::prelude::*;

use super::PathTracer;
use super::emit::Ray;
use super::film::Film;
use super::guide::Guide;
use super::walk::Splat;
use crate::dice::Dice;

/// Paths that one thread follows at a time.
const PART: usize = 512;

/// Paths between two looks at the clock, which start in the order of their cells: those that run through the same part of the body follow
/// each other, so that it is at hand.
pub(super) const BATCH: u64 = 32_768;

/// Tells the dice of light from those of pixels.
const STREAM: u64 = u64::MAX;

/// The light of one group of channels.
pub(super) struct Photons {
    group: usize,
    guide: Guide,
    /// Tells the dice before the guide was learned from those after.
    era: u64,
    /// Paths for one path of an average pixel.
    pub share: f64,
    pub count: u64,
    /// Steps so far.
    pub work: u64,
    pixels: Vec<Sums>,
}

/// What all light brought to a pixel.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    radiance: [f64; 3],
    squares: [f64; 3],
    single: [f64; 3],
}

/// A path about to start, and the cell of the guide it is from.
struct Start {
    ray: Ray,
    cell: usize,
    dice: Dice,
}

/// What a path of light brought, pixel by pixel.
struct Part {
    splats: Vec<Splat>,
    paths: Vec<Path>,
}

/// A path's cell of the guide, its steps, and the end of its splats in the list of all.
struct Path {
    cell: usize,
    steps: u64,
    end: usize,
}

impl Photons {
    pub fn new(tracer: &PathTracer<'_>, group: usize, pixels: usize) -> Self {
        let guide = Guide::new(tracer);
        Self { group, guide, era: 0, share: 0.0, count: 0, work: 0, pixels: vec![Sums::default(); pixels] }
    }

    /// Follows more light, no more than a batch; `found` hears of every path's cell, its steps and what it brought to each pixel.
    pub fn add(
        &mut self,
        tracer: &PathTracer<'_>,
        (film, seed, count): (&Film, u64, u64),
        mut found: impl FnMut(usize, u64, &[Splat]),
    ) {
        let paths = self.count..self.count + count;
        let mut starts: Vec<Start> =
            paths.into_par_iter().map(|path| self.start(tracer, seed, path)).collect();
        starts.par_sort_by_key(|start| start.cell);
        let follow = |starts: &mut [Start]| self.part(tracer, film, starts);
        let parts: Vec<Part> = starts.par_chunks_mut(PART).map(follow).collect();
        self.count += count;
        for part in parts {
            part.splats.iter().for_each(|splat| self.pixels[splat.pixel].add(splat));
            let mut start = 0;
            for Path { cell, steps, end } in part.paths {
                self.work += steps;
                found(cell, steps, &part.splats[start..end]);
                start = end;
            }
        }
    }

    fn start(&self, tracer: &PathTracer<'_>, seed: u64, path: u64) -> Start {
        let mut dice = Dice::new([seed, STREAM - self.era, path, self.group as u64]);
        let (ray, cell) = self.guide.emit(tracer, &mut dice);
        Start { ray, cell, dice }
    }

    fn part(&self, tracer: &PathTracer<'_>, film: &Film, starts: &mut [Start]) -> Part {
        let mut part = Part { splats: Vec::new(), paths: Vec::new() };
        let group = &tracer.groups[self.group];
        let mut found = Vec::new();
        for Start { ray, cell, dice } in starts {
            let steps = tracer.shine(group, (ray, Guide::lamp(*cell)), dice, (film, &mut found));
            merge(&mut found, &mut part.splats);
            part.paths.push(Path { cell: *cell, steps, end: part.splats.len() });
        }
        part
    }

    /// Follows light for as many steps as `work`, learns from it where more is worth following, and forgets what it brought. `means` are
    /// the channels' means by other paths, in sums over the picture. Returns the sum of squared errors, over the squares of the means, and the steps,
    /// both for one path.
    pub fn learn(
        &mut self,
        tracer: &PathTracer<'_>,
        (film, seed): (&Film, u64),
        work: u64,
        means: &mut [f64; 3],
    ) -> [f64; 2] {
        let mut found = self.guide.nothing();
        while self.work < work && self.count < work {
            self.add(tracer, (film, seed, BATCH), |cell, steps, splats| found.add(cell, steps, splats));
        }
        let count = self.count.max(1) as f64;
        for (k, mean) in means.iter_mut().enumerate() {
            let sum: f64 = self.pixels.iter().map(|sums| sums.radiance[k]).sum();
            *mean = mean.max(sum / count);
        }
        let (guide, path) = self.guide.learned(&found, *means);
        self.pixels.fill(Sums::default());
        (self.guide, self.era, self.count, self.work) = (guide, self.era + 1, 0, 0);
        path
    }

    /// Radiance, its standard error and single scattering of a pixel; 0 in other groups' channels.
    pub fn pixel(&self, pixel: usize) -> [[f64; 3]; 3] {
        let (sums, count) = (&self.pixels[pixel], self.count.max(1) as f64);
        let error = |k: usize| {
            let mean = sums.radiance[k] / count;
            ((sums.squares[k] / count - mean * mean) / (count - 1.0).max(1.0)).max(0.0).sqrt()
        };
        let mean = |sum: [f64; 3]| sum.map(|sum| sum / count);
        [mean(sums.radiance), std::array::from_fn(error), mean(sums.single)]
    }

    pub fn group(&self) -> usize {
        self.group
    }
}

impl Sums {
    fn add(&mut self, splat: &Splat) {
        for k in 0..3 {
            self.radiance[k] += splat.radiance[k];
            self.squares[k] += splat.radiance[k] * splat.radiance[k];
            self.single[k] += splat.single[k];
        }
    }
}

/// One path's splats, those of a pixel added up, as its error is that of independent paths.
fn merge(found: &mut Vec<Splat>, into: &mut Vec<Splat>) {
    found.sort_by_key(|splat| splat.pixel);
    let start = into.len();
    for splat in found.drain(..) {
        match into[start..].last_mut().filter(|last| last.pixel == splat.pixel) {
            Some(last) => {
                for k in 0..3 {
                    last.radiance[k] += splat.radiance[k];
                    last.single[k] += splat.single[k];
                }
            }
            None => into.push(splat),
        }
    }
}
