//! The sums of the boundary equation, and light that comes in again.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::Site;
use super::coefficients::Coefficients;
use super::disc::{Disc, Sight, flux};
use super::rays::Rays;

/// How often light that leaves a concave body is followed back into it.
const RETURNS: usize = 4;

/// A site as a source.
struct Patch {
    disc: Disc,
    /// c_i: the solid angle of the body seen from the site, over 4π.
    closure: f64,
    /// Mean curvature of the surface, 1/mm, above 0 where it bulges.
    bulge: f64,
    /// Share of an even sky that the body hides from it.
    occlusion: f64,
    /// Σ A F as the sums have it.
    seen: f64,
}

pub(super) struct Equation {
    medium: [Coefficients; 3],
    patches: Vec<Patch>,
}

impl Equation {
    pub fn new(medium: &[Coefficients; 3], rays: &Rays<'_>, sites: &[Site]) -> Self {
        let wide = || sites.iter().map(|site| site.area).filter(|area| *area > 0.0);
        let mean = wide().sum::<f64>() / wide().count().max(1) as f64;
        let patch = |site: &Site| {
            let disc = Disc { centre: site.position.into(), normal: site.normal.into(), area: site.area };
            let bulge = curvature(site, sites, mean);
            Patch { disc, closure: 0.5, bulge, occlusion: rays.occlusion(site), seen: 0.0 }
        };
        let mut equation = Self { medium: *medium, patches: sites.par_iter().map(patch).collect() };
        let nothing = vec![[0.0; 3]; sites.len()];
        let patches = &equation.patches;
        let measured: Vec<(f64, f64)> = patches
            .par_iter()
            .map(|patch| {
                let (_, closure) = equation.sums(patch.disc.centre, &nothing, &nothing);
                (closure, patches.iter().map(|other| form_factor(&patch.disc, &other.disc)).sum())
            })
            .collect();
        for (patch, (closure, seen)) in equation.patches.iter_mut().zip(measured) {
            (patch.closure, patch.seen) = (closure, seen);
        }
        equation
    }

    pub fn len(&self) -> usize {
        self.patches.len()
    }

    pub fn area(&self, index: usize) -> f64 {
        self.patches[index].disc.area
    }

    pub fn closure(&self, index: usize) -> f64 {
        self.patches[index].closure
    }

    pub fn bulge(&self, index: usize) -> f64 {
        self.patches[index].bulge
    }

    /// Σ_j A_j [c_G (φ_j − 4 η² Γ_j) G + φ_j H] at a point, and −Σ_j A_j H⁰ there, within .2 to 1.2.
    pub fn sums(&self, at: DVec3, fluence: &[[f64; 3]], returning: &[[f64; 3]]) -> ([f64; 3], f64) {
        let (mut sum, mut closure) = ([0.0; 3], 0.0);
        let lit = self.patches.iter().zip(fluence.iter().zip(returning));
        for (patch, (fluence, returning)) in lit.filter(|(patch, _)| patch.disc.area > 0.0) {
            let disc = &patch.disc;
            let leaving = |k: usize| self.medium[k].net_flux(patch.bulge, fluence[k], returning[k]);
            match disc.seen_from(at) {
                Sight::Far(r) => {
                    let along = disc.normal.dot(disc.centre - at);
                    closure += disc.area * along * flux(0.0, r);
                    for (k, medium) in self.medium.iter().enumerate() {
                        let flux = -along * flux(medium.decay, r);
                        sum[k] += disc.area * (leaving(k) * medium.potential(r) + fluence[k] * flux);
                    }
                }
                Sight::Near(fan) => {
                    closure -= disc.area * fan.flux(0.0);
                    for (k, medium) in self.medium.iter().enumerate() {
                        let flux = fan.flux(medium.decay);
                        sum[k] += disc.area * (leaving(k) * fan.potential(medium) + fluence[k] * flux);
                    }
                }
            }
        }
        (sum, closure.clamp(0.2, 1.2))
    }

    /// The left side of the equation, at every site.
    pub fn apply(&self, fluence: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let returning = self.returning(fluence);
        let row = |(patch, own): (&Patch, &[f64; 3])| {
            let (sum, _) = self.sums(patch.disc.centre, fluence, &returning);
            std::array::from_fn(|k| patch.closure * own[k] + sum[k])
        };
        self.patches.par_iter().zip(fluence).map(row).collect()
    }

    /// Γ, W/m²: of what leaves elsewhere, what falls on each site. Form factors know no obstacles; a row is scaled down so that it adds up to
    /// what the site really sees of the body.
    pub fn returning(&self, fluence: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut returning = vec![[0.0; 3]; fluence.len()];
        if self.patches.iter().all(|patch| patch.occlusion == 0.0) {
            return returning;
        }
        for _ in 0..RETURNS {
            let exitance = |(patch, (fluence, returning)): (&Patch, (&[f64; 3], &[f64; 3]))| -> [f64; 3] {
                std::array::from_fn(|k| self.medium[k].leaving(patch.bulge, fluence[k], returning[k]))
            };
            let lit = self.patches.iter().zip(fluence.iter().zip(&returning));
            let leaving: Vec<[f64; 3]> = lit.map(exitance).collect();
            let row = |patch: &Patch| {
                let mut sum = [0.0; 3];
                if patch.occlusion > 0.0 && patch.seen > 0.0 {
                    for (other, leaving) in self.patches.iter().zip(&leaving) {
                        let form = form_factor(&patch.disc, &other.disc);
                        if form > 0.0 {
                            (0..3).for_each(|k| sum[k] += form * leaving[k]);
                        }
                    }
                }
                sum.map(|sum| sum * (patch.occlusion / patch.seen).min(1.0))
            };
            returning = self.patches.par_iter().map(row).collect();
        }
        returning
    }
}

/// Sites so many of its widths away are around one.
const REACH: f64 = 2.2;

/// Mean curvature of the surface about a site, 1/mm: of those around it that face its way, Σ n·x over Σ x² about their middle, which is 1/R on a ball. `mean` is the
/// area of a site.
fn curvature(site: &Site, sites: &[Site], mean: f64) -> f64 {
    let (normal, position) = (DVec3::from(site.normal), DVec3::from(site.position));
    let reach = REACH * REACH * site.area.max(mean);
    let is_around = |other: &&Site| {
        let faces = other.area > 0.0 && normal.dot(other.normal.into()) > 0.0;
        faces && position.distance_squared(other.position.into()) < reach
    };
    let around: Vec<&Site> = sites.iter().filter(is_around).collect();
    let middle =
        around.iter().map(|site| DVec3::from(site.position)).sum::<DVec3>() / around.len().max(1) as f64;
    let sums = around.iter().fold((0.0, 0.0), |(turned, apart), site| {
        let offset = DVec3::from(site.position) - middle;
        (turned + offset.dot(site.normal.into()), apart + offset.length_squared())
    });
    if sums.1 > 0.0 { sums.0 / sums.1 } else { 0.0 }
}

/// A F: what of an even light that leaves a disc falls on the middle of another, cos⁺ cos⁺ A / πr².
fn form_factor(to: &Disc, from: &Disc) -> f64 {
    let offset = from.centre - to.centre;
    let (receives, gives) = (to.normal.dot(offset), -from.normal.dot(offset));
    if from.area <= 0.0 || receives <= 0.0 || gives <= 0.0 {
        return 0.0;
    }
    let square = offset.length_squared();
    from.area * receives * gives / (PI * square * square.max(0.25 * from.area))
}
