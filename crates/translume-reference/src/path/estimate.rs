//! What paths brought, and how sure it is.

use super::volume::Group;
use super::walk::Harvest;

/// What the paths of a pixel brought so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums {
    /// Paths per path of an average pixel, for each group of channels.
    pub share: [f32; 3],
    pub count: [u32; 3],
    /// Steps of each group.
    pub work: [u64; 3],
    /// Of all channels, and how many of them met the body.
    pub paths: u32,
    pub met: u32,
    pub radiance: [f64; 3],
    pub squares: [f64; 3],
    pub single: [f64; 3],
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
    /// One standard error of it; not known, and 0, where fewer than two paths were followed.
    pub error: Vec<[f64; 3]>,
    /// The part that was scattered once.
    pub single: Vec<[f64; 3]>,
    /// Share of each pixel that the body fills, 0..=1.
    pub coverage: Vec<f64>,
    /// Paths of each pixel and channel, which may begin at the eye or be its share of all that begin at a light.
    pub samples: Vec<[u32; 3]>,
}

impl Sums {
    pub fn new(share: [f32; 3]) -> Self {
        let (count, none) = ([0; 3], [0.0; 3]);
        Self { share, count, work: [0; 3], paths: 0, met: 0, radiance: none, squares: none, single: none }
    }

    pub fn add(&mut self, harvest: &Harvest, group: &Group) {
        self.paths += 1;
        self.met += u32::from(harvest.met);
        for k in (0..3).filter(|&k| group.albedo[k] > 0.0) {
            self.count[k] += 1;
            self.radiance[k] += harvest.radiance[k];
            self.squares[k] += harvest.radiance[k] * harvest.radiance[k];
            self.single[k] += harvest.single[k];
        }
    }

    pub fn mean(&self, sum: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| sum[k] / f64::from(self.count[k].max(1)))
    }

    /// Of one path's light, without bias; 0 of fewer than two paths.
    pub fn variance(&self, channel: usize) -> f64 {
        let count = f64::from(self.count[channel].max(2));
        let mean = self.radiance[channel] / count;
        ((self.squares[channel] / count - mean * mean) * count / (count - 1.0)).max(0.0)
    }

    pub fn error(&self) -> [f64; 3] {
        std::array::from_fn(|k| (self.variance(k) / f64::from(self.count[k].max(1))).sqrt())
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
