//! The same subject in the same light, by rays.

use super::IOR;
use super::subject::Subject;
use translume::Light;
use translume_mesh::Atlas;
use translume_reference::gather::{Gather, Source};
use translume_reference::{EnvironmentMap, Surface, deform, metrics};

/// A subject on the CPU, thinned to every so manieth texel.
pub struct Twin {
    atlas: Atlas,
    rest: Vec<[f64; 3]>,
    pub surface: Surface,
    mm_per_unit: f64,
    every: usize,
}

/// What should be at every so manieth texel.
pub struct Reference {
    every: usize,
    irradiance: Vec<[f64; 3]>,
}

/// How far from it something is, all channels together.
#[derive(Clone, Copy)]
pub struct Figures {
    /// RMS of the difference over the mean of the reference.
    pub relative_rmse: f64,
    /// RMS of the difference over the RMS of the reference.
    pub rmse_over_rms: f64,
    /// Mean of the difference over the mean of the reference.
    pub bias: f64,
}

/// Light from an extent, or from all pixels of a map, is slow to sum up: so many texels are enough to tell its error, whose own standard
/// error is then about 2 %.
const MOST: usize = 2048;

impl Twin {
    pub fn new(subject: &Subject, every: usize) -> Self {
        let mesh = &subject.model.mesh;
        let mm_per_unit = f64::from(subject.mm_per_unit);
        let mut atlas = subject.atlas.clone();
        atlas.texels = atlas.texels.into_iter().step_by(every).collect();
        Self {
            atlas,
            rest: deform::positions(mesh, &[], mm_per_unit),
            surface: translume_twin::surface(mesh, &subject.pose, subject.warp, mm_per_unit, false),
            mm_per_unit,
            every,
        }
    }

    /// Irradiance by rays, from `samples`² points of each texel, with `rays`² rays to each light that has an extent. With more than one
    /// ray, at [`MOST`] texels at most.
    pub fn cast(&self, lights: &[translume_reference::Light], samples: u32, rays: u32) -> Reference {
        let stride = if rays > 1 { self.stride() } else { 1 };
        let mut atlas = self.atlas.clone();
        atlas.texels = atlas.texels.into_iter().step_by(stride).collect();
        let sources = self.sources(&atlas, lights, samples, rays);
        let irradiance = sources.iter().map(|source| source.irradiance).collect();
        Reference { every: self.every * stride, irradiance }
    }

    /// Irradiance from all of a map's sky above the horizon, the sum over its pixels, at [`MOST`] texels at most.
    pub fn integrate(&self, map: &EnvironmentMap) -> Reference {
        let stride = self.stride();
        let sources = self.sources(&self.atlas, &[], 1, 1).into_iter().step_by(stride);
        let irradiance = sources.map(|source| map.irradiance(IOR.into(), source.normal)).collect();
        Reference { every: self.every * stride, irradiance }
    }

    fn stride(&self) -> usize {
        self.atlas.texels.len().div_ceil(MOST).max(1)
    }

    /// A light in millimetres; `None` for a kind that rays do not know, such as harmonics.
    pub fn light(&self, light: &Light) -> Option<translume_reference::Light> {
        translume_twin::light(light, self.mm_per_unit)
    }

    fn sources(
        &self,
        atlas: &Atlas,
        lights: &[translume_reference::Light],
        samples: u32,
        rays: u32,
    ) -> Vec<Source> {
        let gather = Gather {
            atlas,
            rest: &self.rest,
            mm_per_unit: self.mm_per_unit,
            surface: &self.surface,
            lights,
            boundary: f64::from(IOR).into(),
            samples,
            rays,
        };
        gather.run()
    }
}

impl Reference {
    /// `None` where there is nothing to compare.
    pub fn compare(&self, irradiance: &[[f64; 3]]) -> Option<Figures> {
        let found: Vec<f64> = irradiance.iter().step_by(self.every).flatten().copied().collect();
        let wanted = self.irradiance.as_flattened();
        let metrics = metrics::compare(&found, wanted, None)?;
        let count = wanted.len() as f64;
        let mean = wanted.iter().sum::<f64>() / count;
        let rms = (wanted.iter().map(|e| e * e).sum::<f64>() / count).sqrt();
        Some(Figures {
            relative_rmse: metrics.relative_rmse,
            rmse_over_rms: metrics.relative_rmse * mean / rms,
            bias: metrics.bias,
        })
    }
}
