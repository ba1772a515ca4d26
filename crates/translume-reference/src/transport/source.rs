//! Light that entered, as points in the volume.
//!
//! Along the refracted ray it is used up exponentially, until the ray leaves the body. Its first scattering is put into strata, each a disc of the
//! site's area at the stratum's mean depth. Light from many directions is one such row of discs, at the mean of theirs.

use glam::DVec3;

use super::Site;
use super::coefficients::Coefficients;
use super::disc::Disc;
use super::layer::Depth;
use super::phase::balanced;
use super::rays::{Rays, SKY};
use crate::Light;
use crate::dice::Dice;
use crate::fresnel::{refracted_cos, transmittance};
use crate::lights::strata::{Strata as Cells, hemisphere};
use crate::path::lamp::{Aim, Lamp};
use crate::path::way::is_lit;
use crate::rgb::scale;

/// Strata of a ray.
pub(super) const COUNT: usize = 4;
/// Their shares of the power: what gets far is little, and most of what gets into the shade.
pub(super) const SHARES: [f64; COUNT] = [0.4, 0.3, 0.2, 0.1];

/// What entered a site.
#[derive(Clone, Debug, Default)]
pub(super) struct Source {
    /// Power of each stratum's first scattering in each channel, W/m² mm².
    pub power: [[f64; 3]; COUNT],
    /// Where it scatters, and where that is with depths as Hopf's function makes them.
    pub scatters: [[DVec3; 3]; COUNT],
    place: [[DVec3; 3]; COUNT],
    /// Rms depth of each stratum about its mean, mm.
    pub width: [[f64; 3]; COUNT],
    /// Light that entered and scatters evenly, W/m², and of that what is of lamps.
    pub irradiance: [f64; 3],
    pub aimed: [f64; 3],
    /// Mean cosine of its directions inside to the normal, inwards; 1 in the dark.
    pub cosine: f64,
    /// How much less φ is at the depth of the value below the surface than from strata that were sheets, W/m².
    pub spread: [f64; 3],
}

/// Light on its way in.
struct Beam {
    /// Into the body.
    direction: DVec3,
    cosine: f64,
    /// W/m² that enter.
    irradiance: [f64; 3],
    /// Whether it comes from one side.
    is_aimed: bool,
    /// Way through the body to the other side, and the way through other parts of it before, mm.
    chord: f64,
    crossed: f64,
}

/// The lights made ready.
pub(super) struct Lamps(pub Vec<Lamp>);

impl Lamps {
    pub fn new(lights: &[Light]) -> Self {
        Self(lights.iter().filter_map(Lamp::new).collect())
    }

    pub fn enter(
        &self,
        rays: &Rays<'_>,
        medium: &[Coefficients; 3],
        site: &Site,
        thickness: f64,
        index: usize,
    ) -> Source {
        let beams: Vec<Beam> =
            self.aims(site, index).into_iter().filter_map(|aim| beam(rays, site, &aim)).collect();
        Source::new(medium, site, thickness, &beams)
    }

    /// Directions that light comes from, with the light of each on a facing plane.
    fn aims(&self, site: &Site, index: usize) -> Vec<Aim> {
        let (position, normal) = (DVec3::from(site.position), DVec3::from(site.normal));
        let mut dice = Dice::stream(2, index as u64);
        let mut aims = Vec::new();
        for (stream, lamp) in self.0.iter().enumerate() {
            if lamp.region().is_some_and(|region| !is_lit(Some(region), position)) {
                continue;
            }
            let count = SKY * SKY;
            if lamp.has_no_extent() {
                aims.extend(lamp.aim(position, &mut dice));
            } else if lamp.is_aimed_at() {
                let share = 1.0 / f64::from(count);
                let aim = (0..count).filter_map(|_| lamp.aim(position, &mut dice));
                aims.extend(aim.map(|aim| Aim { light: scale(aim.light, share), ..aim }));
            } else {
                for point in Cells::new(SKY, position, stream).points() {
                    let direction = hemisphere(normal, point);
                    let share = std::f64::consts::PI / (normal.dot(direction) * f64::from(count));
                    aims.extend(lamp.sight(position, direction).map(|sight| Aim {
                        direction,
                        distance: sight.distance,
                        light: scale(sight.radiance, share),
                        density: 0.0,
                    }));
                }
            }
        }
        aims
    }
}

/// `None` from behind, and through a surface that refracts where the body is in the way.
fn beam(rays: &Rays<'_>, site: &Site, aim: &Aim) -> Option<Beam> {
    let normal = DVec3::from(site.normal);
    let outside = Some(normal.dot(aim.direction)).filter(|cos| *cos > 0.0)?;
    let origin = DVec3::from(site.position) + normal * rays.offset;
    let cosine = refracted_cos(rays.ior, outside);
    let direction = -rays.bent(aim.direction, normal);
    let crossed = if rays.ior == 1.0 {
        rays.inside(origin, aim.direction, aim.distance)
    } else if rays.shape.first(origin, aim.direction, false, aim.distance).is_some() {
        return None;
    } else {
        0.0
    };
    let irradiance = scale(aim.light, outside * transmittance(rays.ior, outside));
    // Of a sky every direction is one by itself.
    let is_aimed = aim.density > 0.0;
    Some(Beam { direction, cosine, irradiance, is_aimed, chord: rays.chord(site, direction), crossed })
}

impl Source {
    fn new(medium: &[Coefficients; 3], site: &Site, thickness: f64, beams: &[Beam]) -> Self {
        let normal = DVec3::from(site.normal);
        let mut source = Self { cosine: 1.0, ..Self::default() };
        let (mut sum, mut slanted) = (0.0, 0.0);
        // Σ power, displacement, curvature · sideways², curvature.
        let mut strata = [[(0.0, DVec3::ZERO, 0.0, 0.0); 3]; COUNT];
        let mut widths = [[0.0; 3]; COUNT];
        for beam in beams {
            let bend = beam.curvature(thickness);
            let sideways = (1.0 - beam.cosine * beam.cosine).max(0.0);
            for (k, channel) in medium.iter().enumerate() {
                let balance = if beam.is_aimed { balanced(channel.g, beam.cosine) } else { 1.0 };
                let entered = balance * beam.irradiance[k] * (-channel.extinction * beam.crossed).exp();
                let own = Strata::new(channel.extinction * beam.chord);
                source.irradiance[k] += entered;
                source.aimed[k] += if beam.is_aimed { entered } else { 0.0 };
                (sum, slanted) = (sum + entered, slanted + entered * beam.cosine);
                let z = Depth::of(channel, thickness).0;
                for (s, (stratum, depth)) in strata.iter_mut().zip(own.depths).enumerate() {
                    let way = depth / channel.extinction;
                    let power = channel.albedo * entered * own.share * site.area * SHARES[s];
                    widths[s][k] += power * beam.cosine * own.deviation(s) / channel.extinction;
                    let fold = beam.cosine / channel.extinction;
                    let sheet = channel.hopf_depth(beam.cosine * depth) / channel.extinction;
                    source.spread[k] += power * own.away(s, fold, sheet, z);
                    let (total, place, bent, bends) = &mut stratum[k];
                    *total += power;
                    *place += beam.direction * (way * power);
                    *bent += bend * way * way * sideways * power;
                    *bends += bend * power;
                }
            }
        }
        if sum > 0.0 {
            source.cosine = slanted / sum;
        }
        for (stratum, sums) in strata.iter().enumerate() {
            for (k, &(power, place, bent, bends)) in sums.iter().enumerate() {
                source.power[stratum][k] = power;
                source.place[stratum][k] = site.position.into();
                source.scatters[stratum][k] = site.position.into();
                if power > 0.0 {
                    source.width[stratum][k] = widths[stratum][k] / power;
                    let mean = place / power;
                    let deep = -normal.dot(mean);
                    let sideways = (mean + normal * deep).length_squared();
                    // Points beside the mean are less deep under a curved surface than it.
                    let lift = ((bent - bends * sideways) / power).clamp(0.0, (0.5 * deep).max(0.0));
                    // And so is the mean, but where it is tells that.
                    let depth = (deep - lift).max(0.0);
                    let bent = (bends / power * sideways).clamp(0.0, depth);
                    let extinction = medium[k].extinction;
                    let shift =
                        (depth - bent) - medium[k].hopf_depth((depth - bent) * extinction) / extinction;
                    let sheet = depth - shift;
                    source.scatters[stratum][k] += mean + normal * lift;
                    source.place[stratum][k] += mean + normal * (lift + shift);
                    source.spread[k] -= power * (Depth::of(&medium[k], thickness).0 - sheet).abs();
                }
            }
        }
        for (spread, channel) in source.spread.iter_mut().zip(medium) {
            *spread *= if site.area > 0.0 { 0.5 / (channel.diffusion * site.area) } else { 0.0 };
        }
        source
    }
}

impl Beam {
    /// Half the curvature of the surface, 1/mm, from how much shorter the chord is than under a plane: on a sphere, 1/2R.
    fn curvature(&self, thickness: f64) -> f64 {
        if self.chord <= 0.0 || thickness <= 0.0 {
            return 0.0;
        }
        let sideways = 1.0 - self.cosine * self.cosine;
        if sideways < 1e-3 {
            return 1.0 / thickness;
        }
        let short = (1.0 - self.chord * self.cosine / thickness).clamp(0.0, 1.0);
        self.cosine * short / (self.chord * sideways)
    }
}

/// A ray that ends at an optical depth, in strata.
pub(super) struct Strata {
    /// Where they begin and end, and mean depths, in mean free paths.
    edges: [f64; COUNT + 1],
    pub depths: [f64; COUNT],
    /// What is used up.
    pub share: f64,
}

impl Strata {
    pub fn new(end: f64) -> Self {
        let share = -(-end).exp_m1();
        let is_short = end < 1e-3;
        let before = |k: usize| SHARES[..k].iter().sum::<f64>();
        let edge = |k: usize| match k {
            COUNT => end,
            _ if is_short => before(k) * end,
            _ => -(-before(k) * share).ln_1p(),
        };
        let edges = std::array::from_fn(edge);
        // −∫ x e^−x.
        let integral = |x: f64| if x < 700.0 { (1.0 + x) * (-x).exp() } else { 0.0 };
        let depths = std::array::from_fn(|k| {
            if is_short {
                0.5 * (edge(k) + edge(k + 1))
            } else {
                (integral(edge(k)) - integral(edge(k + 1))) / (SHARES[k] * share)
            }
        });
        Self { edges, depths, share }
    }

    /// Rms distance of what scatters in a stratum from its mean, mean free paths.
    pub fn deviation(&self, k: usize) -> f64 {
        let x = (self.edges[k + 1] - self.edges[k]).min(700.0);
        let used_up = -(-x).exp_m1();
        let square = if x < 0.1 { x * x / 12.0 } else { 1.0 - x * x * (1.0 - used_up) / (used_up * used_up) };
        square.sqrt()
    }

    /// How far a stratum is on the mean from a point at a depth `z`, E|z − z'|, whose sheet is at a depth below the same plane. `fold` is the depth over
    /// which light is used up to 1/e; mm.
    pub fn away(&self, k: usize, fold: f64, sheet: f64, z: f64) -> f64 {
        let shift = fold * self.depths[k] - sheet;
        let [begin, end] = [self.edges[k], self.edges[k + 1]].map(|edge| fold * edge - shift);
        if z <= begin || z >= end {
            return (z - sheet).abs();
        }
        let above = (z - begin) / fold;
        let used_up = -(self.edges[k] - self.edges[k + 1]).exp_m1();
        2.0 * fold * (above + (-above).exp_m1()) / used_up + sheet - z
    }
}

/// φ_Q at a point, W/m².
pub(super) fn potential(
    medium: &[Coefficients; 3],
    sites: &[Site],
    sources: &[Source],
    at: DVec3,
) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (site, source) in sites.iter().zip(sources).filter(|(site, _)| site.area > 0.0) {
        for (power, place) in source.power.iter().zip(&source.place) {
            for k in (0..3).filter(|&k| power[k] > 0.0) {
                let disc = Disc { centre: place[k], normal: site.normal.into(), area: site.area };
                sum[k] += power[k] * disc.potential(&medium[k], at);
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strata_keep_the_mean_depth() {
        for end in [1e-5, 1e-2, 0.5, 3.0, 50.0, 1e9] {
            let Strata { depths, share, .. } = Strata::new(end);
            let mean = depths.iter().zip(SHARES).map(|(depth, share)| depth * share).sum::<f64>();
            // ∫ x e^−x over what is used up; a short ray's is its middle.
            let exact =
                if end < 1e-2 { end * (0.5 - end / 12.0) } else { 1.0 - end / end.min(700.0).exp_m1() };
            assert!((mean / exact - 1.0).abs() < 1e-3, "{end}: {mean} {exact}");
            assert!((share - (1.0 - (-end).exp())).abs() < 1e-12 && depths.is_sorted());
        }
    }
}
