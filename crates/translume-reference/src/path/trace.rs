//! A picture that grows pass by pass.

use glam::DVec3;
use rayon::prelude::*;

use super::PathTracer;
use super::dice::Dice;
use super::walk::Harvest;
use crate::composite::Camera;

/// Pixels between two looks at the clock.
const BATCH: usize = 2048;

/// A picture under way.
pub struct Trace<'a> {
    tracer: &'a PathTracer<'a>,
    camera: Camera,
    seed: u64,
    passes: u64,
    pixels: Vec<Sums>,
}

/// What the paths of a pixel brought so far.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    count: u32,
    met: u32,
    radiance: [f64; 3],
    squares: [f64; 3],
    single: [f64; 3],
}

/// Pixels row by row from the top, averaged over their squares.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Radiance, W/(m² sr).
    pub radiance: Vec<[f64; 3]>,
    /// One standard error of it; infinite where fewer than two paths were followed.
    pub error: Vec<[f64; 3]>,
    /// The part that was scattered once.
    pub single: Vec<[f64; 3]>,
    /// Share of each pixel that the body fills, 0..=1.
    pub coverage: Vec<f64>,
    /// Paths of each pixel.
    pub samples: Vec<u32>,
}

/// How far a pass has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Pixels finished in this pass.
    pub done: usize,
    /// Pixels of the picture.
    pub total: usize,
}

impl<'a> Trace<'a> {
    pub(super) fn new(tracer: &'a PathTracer<'a>, camera: Camera, seed: u64) -> Self {
        let pixels = vec![Sums::default(); camera.width * camera.height];
        Self { tracer, camera, seed, passes: 0, pixels }
    }

    /// Adds `samples` paths to every pixel. `progress` hears of every few thousand pixels; when it returns `false` the pass ends early and
    /// returns `false`, and what was found so far is a valid estimate. The same seed and passes give the same picture to the last bit.
    pub fn pass(&mut self, samples: u32, mut progress: impl FnMut(Progress) -> bool) -> bool {
        let total = self.pixels.len();
        let mut pixels = std::mem::take(&mut self.pixels);
        let mut proceed = true;
        for (batch, part) in pixels.chunks_mut(BATCH).enumerate() {
            part.par_iter_mut().enumerate().for_each(|(k, sums)| self.add(batch * BATCH + k, samples, sums));
            proceed = progress(Progress { done: batch * BATCH + part.len(), total });
            if !proceed {
                break;
            }
        }
        self.pixels = pixels;
        self.passes += 1;
        proceed
    }

    fn add(&self, pixel: usize, samples: u32, sums: &mut Sums) {
        let (column, row) = (pixel % self.camera.width, pixel / self.camera.width);
        let mut dice = Dice::new([self.seed, self.passes, pixel as u64, 0]);
        for _ in 0..samples {
            let [x, y] = dice.pair();
            let direction = self.camera.direction_at(column as f64 + x, row as f64 + y);
            let direction = DVec3::from(direction).normalize_or_zero();
            sums.add(&self.tracer.sample(self.camera.eye.into(), direction, &mut dice));
        }
    }

    /// What has been found so far.
    #[must_use]
    pub fn estimate(&self) -> Estimate {
        let each = |of: fn(&Sums) -> [f64; 3]| self.pixels.iter().map(of).collect();
        Estimate {
            width: self.camera.width,
            height: self.camera.height,
            radiance: each(|sums| sums.mean(sums.radiance)),
            error: each(Sums::error),
            single: each(|sums| sums.mean(sums.single)),
            coverage: self
                .pixels
                .iter()
                .map(|sums| f64::from(sums.met) / f64::from(sums.count.max(1)))
                .collect(),
            samples: self.pixels.iter().map(|sums| sums.count).collect(),
        }
    }
}

impl Sums {
    fn add(&mut self, harvest: &Harvest) {
        self.count += 1;
        self.met += u32::from(harvest.met);
        for k in 0..3 {
            self.radiance[k] += harvest.radiance[k];
            self.squares[k] += harvest.radiance[k] * harvest.radiance[k];
            self.single[k] += harvest.single[k];
        }
    }

    fn mean(&self, sum: [f64; 3]) -> [f64; 3] {
        sum.map(|sum| sum / f64::from(self.count.max(1)))
    }

    fn error(&self) -> [f64; 3] {
        if self.count < 2 {
            return [f64::INFINITY; 3];
        }
        let count = f64::from(self.count);
        std::array::from_fn(|k| {
            let mean = self.radiance[k] / count;
            let variance = (self.squares[k] / count - mean * mean).max(0.0);
            (variance / (count - 1.0)).sqrt()
        })
    }
}

impl Estimate {
    /// Root mean square of the standard error over the mean radiance, both over the pixels that the body touches, of the noisiest channel.
    /// 0 where nothing shines.
    #[must_use]
    pub fn noise(&self) -> f64 {
        let touched: Vec<usize> = (0..self.coverage.len()).filter(|&k| self.coverage[k] > 0.0).collect();
        let count = touched.len() as f64;
        let noise = |channel: usize| {
            let mean = touched.iter().map(|&k| self.radiance[k][channel]).sum::<f64>() / count;
            let square = touched.iter().map(|&k| self.error[k][channel].powi(2)).sum::<f64>() / count;
            if mean > 0.0 { square.sqrt() / mean } else { 0.0 }
        };
        (0..3).map(noise).fold(0.0, f64::max)
    }
}
