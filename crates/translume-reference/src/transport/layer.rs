//! Radiance from what is known of φ under the surface.
//!
//! L = α'/4π ∫ σ_t e^−σ_t s φ(s) ds along the ray of view inside. φ below a site is a parabola of the depth, through its value and its slope at
//! the surface (the boundary condition gives that) and its value a little below, less the particular solution of the light that enters there. Further
//! along the ray that is told by the sites it passes under. A ray is z(s) = μs (1 − βs/L) deep, L its chord and β = 1 − Lμ/thickness, which is exact on a sphere and in a slab. At its other end
//! φ is that of the site there; between the two, where there are no sources but that light, it is the hyperbola that absorption makes of it.

use glam::DVec3;
use rayon::prelude::*;

use super::Solution;
use super::coefficients::Coefficients;
use crate::fresnel::transmittance;
use std::f64::consts::PI;

/// Depth of the value below the surface, mean free paths.
const DEPTH: f64 = 0.9;
/// No deeper than this share of the way to the other side.
const MOST: f64 = 0.5;
/// Parabolas end at this many depths of that value, and no further than this share of a ray.
const REACH: f64 = 1.6;
const MOST_OF_RAY: f64 = 0.35;
/// Where along a ray other sites than the one that is seen tell how light is there, mean free paths of the mean of the channels.
pub(super) const ALONG: [f64; 2] = [0.6, 1.6];
/// No further than this share of the ray.
pub(super) const MOST_ALONG: f64 = 0.5;
/// How much more light there may be a mean free path further in: a ray that looks through a gap at a lit site is no speck of light. Under a plane that is lit
/// from afar it is .7 of what there is at one.
const MOST_GROWTH: f64 = 2.5;
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
    /// Of the light that enters: α' E / D σ_t, and 1/μ₀.
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
        let beam = medium.albedo * irradiance / (medium.diffusion * medium.extinction);
        let reach = REACH * depth;
        let mut own = Self {
            surface: 0.0,
            slope: 0.0,
            curve: 0.0,
            beam,
            rate: 1.0 / cosine.max(0.05),
            reach,
            thickness,
        };
        own.surface = fluence[0] + own.beam(medium, medium.hopf_surface() / medium.extinction);
        let flux = medium.net_flux(bulge, fluence[0], returning);
        let optical = depth * medium.extinction;
        if optical > 1e-3 {
            own.slope = (flux - medium.albedo * irradiance) / medium.diffusion;
            let there = (optical + medium.hopf_shift(optical)) / medium.extinction;
            let rise = fluence[1] + own.beam(medium, there) - own.surface;
            own.curve = (rise / depth - own.slope) / depth;
        }
        own
    }

    /// φ at a depth, less the particular solution of light that enters there.
    fn at(&self, medium: &Coefficients, depth: f64) -> f64 {
        let shifted = depth - medium.hopf_shift(depth * medium.extinction) / medium.extinction;
        self.surface + shifted * (self.slope + shifted * self.curve)
    }

    /// That, less than 0: α' E / D times the mean way from a depth to what scatters deeper, with depths as Hopf's function makes them.
    fn beam(&self, medium: &Coefficients, depth: f64) -> f64 {
        let optical = depth * medium.extinction;
        let x = optical.max(medium.hopf_surface());
        let hopf = medium.hopf_rate();
        let way = 1.0 / self.rate + medium.hopf_shift(x) * hopf / (self.rate + hopf);
        self.beam * ((-self.rate * x).exp() * way + (medium.hopf_shift(optical) - optical).max(0.0))
    }
}

/// Parabolas in one channel along a ray: of the site that is seen, of those that it passes under so far along it, and of the site at its other end with the
/// cosine there.
pub(super) struct Row<'a> {
    pub own: Parabola,
    pub along: [(f64, Parabola); ALONG.len()],
    pub far: Option<(&'a Parabola, f64)>,
}

impl Row<'_> {
    /// Radiance at the surface, W/(m² sr).
    pub fn radiance(&self, medium: &Coefficients, cosine: f64, chord: f64) -> f64 {
        let share = -(-medium.extinction * chord).exp_m1();
        let near = |s: f64| depth_along(self.own.thickness, cosine, s, chord);
        let begin = (self.own.reach / cosine).min(MOST_OF_RAY * chord);
        let whole = |s: f64| self.weighted(s, |site| site.at(medium, near(s.min(begin))));
        let beam = |s: f64| self.weighted(s, |site| site.beam(medium, near(s)));
        let from = whole(begin).max(0.0);
        let step = |k: u32| {
            let part = (f64::from(k) + 0.5) / f64::from(STEPS);
            let s = (-(-part * share).ln_1p() / medium.extinction).min(chord);
            let Some((other, there)) = self.far else {
                let decayed = (-medium.decay * cosine * (s - begin).max(0.0)).exp();
                return whole(s) * decayed - beam(s);
            };
            let back = |s: f64| depth_along(other.thickness, there, chord - s, chord);
            let end = chord - (other.reach / there).min(MOST_OF_RAY * chord);
            if s <= begin {
                return whole(s) - beam(s);
            }
            if s >= end {
                return other.at(medium, back(s)) - other.beam(medium, back(s));
            }
            let to = other.at(medium, back(end)).max(0.0) + beam(end);
            let from = from + other.beam(medium, back(begin));
            let between = Between { length: 0.5 * medium.decay * (cosine + there) * (end - begin) };
            let way = (s - begin) / (end - begin);
            let risen = from * between.rising(1.0 - way) + to * between.rising(way);
            let most = from * (1.0 + MOST_GROWTH * medium.extinction * (s - begin));
            risen.min(most) - beam(s) - other.beam(medium, back(s))
        };
        medium.albedo / (4.0 * PI) * share * (0..STEPS).map(|k| step(k).max(0.0)).sum::<f64>()
            / f64::from(STEPS)
            + self.thrown_back(medium) * (-medium.extinction * chord).exp()
    }

    /// By the surface at the other end, of light that is there as bright in all directions.
    fn thrown_back(&self, medium: &Coefficients) -> f64 {
        let Some((other, there)) = self.far.filter(|_| medium.ior() != 1.0) else { return 0.0 };
        let fluence = (other.at(medium, 0.0) - other.beam(medium, 0.0)).max(0.0);
        (1.0 - transmittance(1.0 / medium.ior(), there)) * fluence / (4.0 * PI)
    }

    /// What the sites along the ray say of a place so far along it: linear in between.
    fn weighted(&self, s: f64, of: impl Fn(&Parabola) -> f64) -> f64 {
        let [(first, near), (second, further)] = &self.along;
        let a = (s / first).clamp(0.0, 1.0);
        let b = ((s - first) / (second - first)).clamp(0.0, 1.0);
        (1.0 - a) * of(&self.own) + (a - b) * of(near) + b * of(further)
    }
}

/// Where there are no sources φ between two places is sinh of the way from either; lengths are over that of 1/e.
struct Between {
    length: f64,
}

impl Between {
    /// sinh(y·length) / sinh(length).
    fn rising(&self, y: f64) -> f64 {
        if self.length < 1e-6 {
            return y;
        }
        let x = self.length;
        (-x * (1.0 - y)).exp() * (-2.0 * x * y).exp_m1() / (-2.0 * x).exp_m1()
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
    /// So far along it, mm, it passes under these sites; `None` where that is not known.
    pub along: [(f64, Option<usize>); ALONG.len()],
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

    /// Radiance of light that scattered more than once, W/(m² sr).
    #[must_use]
    pub fn radiance(&self, seen: &Seen) -> [f64; 3] {
        std::array::from_fn(|k| {
            let medium = &self.solution.medium[k];
            let far = seen.far.map(|(index, cosine)| (&self.parabolas[index][k], cosine));
            let each = |&(index, weight): &(usize, f64)| {
                let mut last = index;
                let along = seen.along.map(|(s, site)| {
                    last = site.unwrap_or(last);
                    (s, self.parabolas[last][k])
                });
                let row = Row { own: self.parabolas[index][k], along, far };
                weight * row.radiance(medium, seen.cosine, seen.chord)
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
