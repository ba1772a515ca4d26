//! Radiance from what is known of φ under the surface.
//!
//! L = α'/4π ∫ σ_t e^−σ_t s φ(s) ds along the ray of view inside. φ below a site is a parabola of the depth, through its value and its slope at
//! the surface (the boundary condition gives that) and its value a little below, less p e^−σ_t z/μ₀, the particular solution of the light that
//! enters there. A ray is z(s) = μs (1 − βs/L) deep, L its chord and β = 1 − Lμ/thickness, which is exact on a sphere and in a slab. Towards its
//! other end φ goes over into the parabola of the site there, by the geometric mean, as it varies by orders of magnitude.

use glam::DVec3;
use rayon::prelude::*;

use super::Solution;
use super::coefficients::{Coefficients, hopf_shift};
use std::f64::consts::PI;

/// Depth of the value below the surface, mean free paths.
const DEPTH: f64 = 0.6;
/// No deeper than this share of the way to the other side.
const MOST: f64 = 0.5;
/// Parabolas end at this many depths of that value.
const REACH: f64 = 2.5;
/// Points of the integral, at midpoints of equal weight.
const STEPS: u32 = 24;

/// Depth of the value below the surface, mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Depth(pub f64);

impl Depth {
    pub fn of(medium: &Coefficients, thickness: f64) -> Self {
        Self((DEPTH / medium.extinction).min(MOST * thickness))
    }
}

/// φ under a site in one channel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parabola {
    surface: f64,
    slope: f64,
    curve: f64,
    /// Of the light that enters: p, and σ_t/μ₀.
    beam: f64,
    rate: f64,
    reach: f64,
    thickness: f64,
}

impl Parabola {
    /// `fluence` at the surface and at `depth`, mean curvature and Γ, `light` irradiance that entered and its cosine.
    pub fn new(
        medium: &Coefficients,
        fluence: [f64; 2],
        (bulge, returning): (f64, f64),
        (irradiance, cosine): (f64, f64),
        Depth(depth): Depth,
        thickness: f64,
    ) -> Self {
        let rate = medium.extinction / cosine.max(0.05);
        let beam = medium.albedo * irradiance / (medium.diffusion * rate);
        let surface = fluence[0] + beam;
        let flux = medium.net_flux(bulge, fluence[0], returning);
        let mut own = Self { surface, slope: 0.0, curve: 0.0, beam, rate, reach: REACH * depth, thickness };
        if depth * medium.extinction > 1e-3 {
            own.slope = flux / medium.diffusion - beam * rate;
            let rise = fluence[1] + beam * (-rate * depth).exp() - surface;
            own.curve = (rise / depth - own.slope) / depth;
        }
        own
    }

    /// φ along a ray that leaves at this cosine, so far from where it does.
    fn at(&self, medium: &Coefficients, cosine: f64, s: f64, chord: f64) -> f64 {
        let depth = depth_along(self.thickness, cosine, s, chord).min(self.reach);
        let shifted = depth - hopf_shift(depth * medium.extinction) / medium.extinction;
        self.surface + shifted * (self.slope + shifted * self.curve) - self.beam * (-self.rate * depth).exp()
    }

    /// Radiance at the surface, W/(m² sr); `far` is the site at the other end of the ray, with the cosine there.
    pub fn radiance(&self, medium: &Coefficients, far: Option<(&Self, f64)>, cosine: f64, chord: f64) -> f64 {
        let share = -(-medium.extinction * chord).exp_m1();
        let least = 1e-3 * self.surface.max(far.map_or(0.0, |(far, _)| far.surface)).max(f64::MIN_POSITIVE);
        let step = |k: u32| {
            let part = (f64::from(k) + 0.5) / f64::from(STEPS);
            let s = (-(-part * share).ln_1p() / medium.extinction).min(chord);
            let near = self.at(medium, cosine, s, chord);
            let Some((far, there)) = far else { return near };
            let y = s / chord;
            let y = y * y * (3.0 - 2.0 * y);
            let far = far.at(medium, there, chord - s, chord);
            (near.max(least).ln() * (1.0 - y) + far.max(least).ln() * y).exp()
        };
        medium.albedo / (4.0 * PI) * share * (0..STEPS).map(step).sum::<f64>() / f64::from(STEPS)
    }
}

/// Depth of a ray that leaves at this cosine, so far from where it does, mm.
fn depth_along(thickness: f64, cosine: f64, s: f64, chord: f64) -> f64 {
    let short = (1.0 - chord * cosine / thickness.max(1e-12)).clamp(0.0, 1.0);
    let turned = if chord.is_finite() { short * s / chord.max(1e-12) } else { 0.0 };
    cosine * s * (1.0 - turned)
}

/// A place of the surface that is seen.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Sites around it and their weights, which add up to 1.
    pub sites: Vec<(usize, f64)>,
    /// Cosine of the ray to the normal, inside, > 0.
    pub cosine: f64,
    /// How long the ray is inside from here, mm.
    pub chord: f64,
    /// The site where it comes out at the back, and the cosine there; `None` if that is not known.
    pub far: Option<(usize, f64)>,
}

/// φ under every site.
pub struct Layers<'a> {
    solution: &'a Solution<'a>,
    parabolas: Vec<[Parabola; 3]>,
}

impl<'a> Layers<'a> {
    pub(super) fn new(solution: &'a Solution<'a>) -> Self {
        let parabolas = (0..solution.sites.len()).into_par_iter().map(|index| parabolas(solution, index));
        Self { solution, parabolas: parabolas.collect() }
    }

    /// How far the surface is from a place so far along the ray, mm.
    pub(super) fn depth_at(&self, seen: &Seen, s: f64) -> f64 {
        let of = |site: usize| self.solution.thickness[site];
        let own: f64 = seen.sites.iter().map(|&(site, weight)| weight * of(site)).sum();
        let near = depth_along(own, seen.cosine, s, seen.chord);
        let far = seen.far.map(|(site, there)| depth_along(of(site), there, seen.chord - s, seen.chord));
        far.map_or(near, |far| near.min(far))
    }

    /// Radiance of light that scattered more than once, W/(m² sr).
    #[must_use]
    pub fn radiance(&self, seen: &Seen) -> [f64; 3] {
        std::array::from_fn(|k| {
            let medium = &self.solution.medium[k];
            let far = seen.far.map(|(index, cosine)| (&self.parabolas[index][k], cosine));
            let each = |&(index, weight): &(usize, f64)| {
                weight * self.parabolas[index][k].radiance(medium, far, seen.cosine, seen.chord)
            };
            seen.sites.iter().map(each).sum()
        })
    }
}

fn parabolas(solution: &Solution<'_>, index: usize) -> [Parabola; 3] {
    let (site, source, thickness) =
        (&solution.sites[index], &solution.sources[index], solution.thickness[index]);
    std::array::from_fn(|k| {
        let medium = &solution.medium[k];
        let depth = Depth::of(medium, thickness);
        let below = DVec3::from(site.position) - DVec3::from(site.normal) * depth.0;
        let under = solution.fluence_at(below.to_array())[k] - source.spread[k];
        let fluence = [solution.fluence[index][k], under];
        let light = (source.irradiance[k], source.cosine);
        let boundary = (solution.equation.bulge(index), solution.returning[index][k]);
        Parabola::new(medium, fluence, boundary, light, depth, thickness)
    })
}
