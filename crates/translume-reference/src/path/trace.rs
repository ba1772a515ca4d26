//! A picture that grows pass by pass.

use glam::DVec3;
use rayon::prelude::*;

use super::estimate::{Estimate, Sums};
use super::film::Film;
use super::photons::{self, Photons};
use super::{PathTracer, Vantage};
use crate::composite::Camera;
use crate::dice::Dice;

/// Pixels between two looks at the clock.
const BATCH: usize = 2048;

/// Neighbours on each side whose spread is averaged where [`Trace::focus`] looks: few paths alone know little of rare light.
const REACH: usize = 2;

/// This share of the paths is spent evenly.
const LEAST: f64 = 0.1;

/// A picture under way.
pub struct Trace<'a> {
    tracer: &'a PathTracer<'a>,
    camera: Camera,
    film: Film,
    seed: u64,
    passes: u64,
    pixels: Vec<Sums>,
    /// Of the groups of channels whose light is followed from its sources, and not from the eye.
    photons: Vec<Photons>,
}

/// Where paths begin. At a refracting boundary they can only begin at the eye.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Source {
    /// Where, channel by channel, less noise is left in the same time.
    #[default]
    Quieter,
    /// At the eye.
    Eye,
    /// At the lights.
    Lights,
}

/// How far a pass has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Pixels finished in this pass, and paths of light.
    pub done: usize,
    /// Of how many.
    pub total: usize,
}

impl<'a> Trace<'a> {
    pub(super) fn new(tracer: &'a PathTracer<'a>, camera: Camera, seed: u64) -> Self {
        let pixels = vec![Sums::new([1.0; 3]); camera.width * camera.height];
        let fan =
            if tracer.is_matched() { tracer.shape.fan(Vantage::Point(camera.eye.into())) } else { None };
        let film = Film::new(&camera, fan);
        Self { tracer, camera, film, seed, passes: 0, pixels, photons: Vec::new() }
    }

    /// Adds `samples` paths to every pixel, or as many as [`Trace::focus`] found better. `progress` hears of every few thousand; when it returns `false` the pass ends early and
    /// returns `false`, and what was found so far is a valid estimate. The same seed and passes give the same picture to the last bit.
    pub fn pass(&mut self, samples: u32, mut progress: impl FnMut(Progress) -> bool) -> bool {
        let counts = self.photons.iter().map(|light| (f64::from(samples) * light.share).ceil() as u64);
        let counts: Vec<u64> = counts.collect();
        let total = self.pixels.len() + counts.iter().sum::<u64>() as usize;
        let mut done = 0;
        let mut go_on = |more: usize| {
            done += more;
            progress(Progress { done, total })
        };
        let proceed = self.look(samples, &mut go_on) && self.shine(&counts, &mut go_on);
        self.passes += 1;
        proceed
    }

    fn look(&mut self, samples: u32, go_on: &mut impl FnMut(usize) -> bool) -> bool {
        let mut pixels = std::mem::take(&mut self.pixels);
        let proceed = pixels.chunks_mut(BATCH).enumerate().all(|(batch, part)| {
            part.par_iter_mut().enumerate().for_each(|(k, sums)| self.add(batch * BATCH + k, samples, sums));
            go_on(part.len())
        });
        self.pixels = pixels;
        proceed
    }

    fn shine(&mut self, counts: &[u64], go_on: &mut impl FnMut(usize) -> bool) -> bool {
        for (light, &count) in self.photons.iter_mut().zip(counts) {
            let mut left = count;
            while left > 0 {
                let some = left.min(photons::BATCH);
                light.add(self.tracer, (&self.film, self.seed, some), |_, _, _| {});
                left -= some;
                if !go_on(some as usize) {
                    return false;
                }
            }
        }
        true
    }

    fn add(&self, pixel: usize, samples: u32, sums: &mut Sums) {
        let (column, row) = (pixel % self.camera.width, pixel / self.camera.width);
        let is_looked_for = |index: usize| self.photons.iter().all(|light| light.group() != index);
        for (index, group) in self.tracer.groups.iter().enumerate().filter(|&(k, _)| is_looked_for(k)) {
            let mut dice = Dice::new([self.seed, self.passes, pixel as u64, index as u64]);
            // A broken number of paths is rounded up as often as it is right on average.
            let count = (f64::from(samples) * f64::from(sums.share[index]) + dice.roll()) as u32;
            // Whoever gets few at first must not be taken for black.
            let is_new = sums.share[index] > 0.0
                && sums.count.iter().zip(group.albedo).all(|(&n, a)| n == 0 || a == 0.0);
            let count = if is_new { count.max(samples.min(2)) } else { count };
            for _ in 0..count {
                let [x, y] = dice.pair();
                let direction = self.camera.direction_at(column as f64 + x, row as f64 + y);
                let direction = DVec3::from(direction).normalize_or_zero();
                let harvest = self.tracer.follow(group, &self.film, direction, &mut dice);
                sums.work[index] += harvest.work;
                sums.add(&harvest, group);
            }
        }
    }

    /// Learns from the paths so far which pixels and channels are the noisiest, and whether light is better followed from its sources, which a
    /// few paths of that kind tell. What all these brought is forgotten, and later passes spend their paths so that [`Estimate::noise`] falls
    /// fastest, as many in all as before. Because the choice is made once, from paths that do not count, no bias follows. A dozen paths of each
    /// pixel are enough.
    pub fn focus(&mut self) {
        self.focus_on(Source::Quieter);
    }

    /// The same with paths that begin where they are told, if they can begin there.
    pub fn focus_on(&mut self, source: Source) {
        let met: Vec<f64> = self.pixels.iter().map(|sums| f64::from(sums.met)).collect();
        // A rim that the paths so far missed is not far from where they met the body.
        let reached: Vec<bool> = (0..self.pixels.len()).map(|pixel| self.around(pixel, &met) > 0.0).collect();
        let mut wanted = vec![[0.0; 3]; self.pixels.len()];
        let mut lights = Vec::new();
        for index in 0..self.tracer.groups.len() {
            let mut means = self.means(index);
            let light = if source == Source::Eye { None } else { self.learn(index, &mut means) };
            let variances = self.variances(index, means);
            let spread = |pixel: usize| self.around(pixel, &variances).sqrt();
            let spreads: Vec<f64> = (0..self.pixels.len()).map(spread).collect();
            // Paths in proportion to the spread make the sum of squared errors least. It falls to the square of the sum of spreads over
            // the number of paths, so a group needs as many as its sum to be as good as the others.
            let sum: f64 = spreads.iter().sum();
            let cost = sum * sum * self.steps(index);
            let is_better = |[squares, steps]: [f64; 2]| source == Source::Lights || squares * steps < cost;
            match light.filter(|(_, path)| is_better(*path)) {
                Some((light, [squares, _])) => lights.push((light, squares)),
                None => {
                    let wanted = wanted.iter_mut().zip(spreads);
                    wanted.for_each(|(wanted, spread)| wanted[index] = spread * sum);
                }
            }
        }
        let total =
            wanted.as_flattened().iter().sum::<f64>() + lights.iter().map(|light| light.1).sum::<f64>();
        let pixels = reached.iter().filter(|&&reached| reached).count();
        let scale = (pixels * self.tracer.groups.len()) as f64 / total;
        // Where nothing varies, every pixel is as good as another.
        let share = |wanted: f64| if total > 0.0 { LEAST + (1.0 - LEAST) * wanted * scale } else { 1.0 };
        for (sums, (wanted, reached)) in self.pixels.iter_mut().zip(wanted.into_iter().zip(reached)) {
            let share = wanted.map(|wanted| if reached { share(wanted) as f32 } else { 0.0 });
            // Whether the body is met does not decide anything but where to look.
            *sums = Sums { paths: sums.paths, met: sums.met, ..Sums::new(share) };
        }
        self.photons = lights
            .into_iter()
            .map(|(mut light, squares)| {
                light.share = pixels as f64 * LEAST + (1.0 - LEAST) * squares * scale;
                light
            })
            .collect();
    }

    /// Light of a group, learned as long as the paths from the eye took; and its squares and steps.
    fn learn(&self, index: usize, means: &mut [f64; 3]) -> Option<(Photons, [f64; 2])> {
        if !self.tracer.is_matched() || self.tracer.lamps.is_empty() {
            return None;
        }
        let work = self.pixels.iter().map(|sums| sums.work[index]).sum();
        let mut light = Photons::new(self.tracer, index, self.pixels.len());
        let learned = light.learn(self.tracer, (&self.film, self.seed), work, means);
        Some((light, learned))
    }

    /// Steps of a path that met the body, of a group.
    fn steps(&self, index: usize) -> f64 {
        let work: u64 = self.pixels.iter().map(|sums| sums.work[index]).sum();
        let met: u64 = self.pixels.iter().map(|sums| u64::from(sums.met)).sum();
        // Met by the paths of all groups, as many of each.
        work as f64 * self.tracer.groups.len() as f64 / met.max(1) as f64
    }

    /// Radiance summed over the picture, in the channels of a group.
    fn means(&self, index: usize) -> [f64; 3] {
        let albedo = self.tracer.groups[index].albedo;
        let sum = |k: usize| self.pixels.iter().map(|sums| sums.mean(sums.radiance)[k]).sum();
        std::array::from_fn(|k| if albedo[k] > 0.0 { sum(k) } else { 0.0 })
    }

    /// Variance of one path's light over the squares of the means, of the channels of a group together.
    fn variances(&self, index: usize, means: [f64; 3]) -> Vec<f64> {
        let albedo = self.tracer.groups[index].albedo;
        let channels = || (0..3).filter(|&k| albedo[k] > 0.0 && means[k] > 0.0);
        let of = |sums: &Sums| channels().map(|k| sums.variance(k) / means[k].powi(2)).sum();
        self.pixels.iter().map(of).collect()
    }

    /// Mean of a value over a pixel and its neighbours.
    fn around(&self, pixel: usize, values: &[f64]) -> f64 {
        let (width, height) = (self.camera.width, self.camera.height);
        let range = |at: usize, end: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(end);
        let (columns, rows) = (range(pixel % width, width), range(pixel / width, height));
        let count = (columns.len() * rows.len()) as f64;
        let sum: f64 = rows
            .map(|row| values[row * width + columns.start..row * width + columns.end].iter().sum::<f64>())
            .sum();
        sum / count
    }

    /// What has been found so far.
    #[must_use]
    pub fn estimate(&self) -> Estimate {
        let each = |of: fn(&Sums) -> [f64; 3]| self.pixels.iter().map(of).collect();
        let mut estimate = Estimate {
            width: self.camera.width,
            height: self.camera.height,
            radiance: each(|sums| sums.mean(sums.radiance)),
            error: each(Sums::error),
            single: each(|sums| sums.mean(sums.single)),
            coverage: self
                .pixels
                .iter()
                .map(|sums| f64::from(sums.met) / f64::from(sums.paths.max(1)))
                .collect(),
            samples: self.pixels.iter().map(|sums| sums.count).collect(),
        };
        self.photons.iter().for_each(|light| self.take(light, &mut estimate));
        estimate
    }

    fn take(&self, light: &Photons, estimate: &mut Estimate) {
        let albedo = self.tracer.groups[light.group()].albedo;
        let samples = (light.count / self.pixels.len() as u64) as u32;
        for pixel in 0..self.pixels.len() {
            let [radiance, error, single] = light.pixel(pixel);
            for k in (0..3).filter(|&k| albedo[k] > 0.0) {
                estimate.radiance[pixel][k] = radiance[k];
                estimate.error[pixel][k] = error[k];
                estimate.single[pixel][k] = single[k];
                estimate.samples[pixel][k] = samples;
            }
        }
    }
}
