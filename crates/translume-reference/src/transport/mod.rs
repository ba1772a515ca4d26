//! Light transport past the dipole, on the surface alone: twin of the boundary solver, by dense sums and rays.
//!
//! A dipole knows a half-space. Here diffusion is solved with the boundary that the body has, as an integral equation for the fluence φ at
//! sites of the surface, in each channel on its own:
//!
//! c_i φ_i + Σ_j A_j [c_G (φ_j − 4 η² Γ_j) G_ij + φ_j H_ij] = φ_Q,i,  G = e^−σr / 4πDr,  H = D ∂G/∂n_j,  c_i = −Σ_j A_j H⁰_ij
//!
//! | module | what it does |
//! | --- | --- |
//! | `coefficients` | D, σ, c_G of a channel, and what diffusion makes of them |
//! | `rays` | what is inside of a straight line, chords, how much of the sky of a site is body |
//! | `source` | light that entered a site, as points in the volume: φ_Q |
//! | `disc` | G and H averaged over a site |
//! | `equation` | the sums of the equation, and light that leaves a concave body and enters it again: Γ |
//! | `krylov` | its solution in a few applications |
//! | `layer` | radiance from φ under the surface |
//! | `single` | light that scattered once |
//! | `twice` | light that scattered twice, which diffusion lacks some of |
//! | `shortfall` | how much of it, from the exact half-space |
//! | `picture` | the camera's picture |
//!
//! Three things are ours and make it right with few sites (figures in `docs/method.md`):
//!
//! * **Every site is a disc**, in closed form along lines through a near receiver's foot. Sites may then be larger than a mean free path: where
//!   that is short the equation becomes the half-space's, as it should.
//! * **Depths are shifted by Hopf's function.** Diffusion extrapolates to zero .7104 mean free paths outside, which holds deep inside; near the
//!   surface the exact field is that of a shallower depth by .7104 − q(z). By reciprocity that holds for sources as well as for what leaves, and
//!   a thick slab then lets through what it should within 1 %, where it was 4 % too much.
//! * **What diffusion lacks is a share of what scattered twice**, ρ(α') such that an even half-space returns Chandrasekhar's exact albedo.
//!
//! Lengths are millimetres. The boundary is index-matched or a smooth dielectric; with the latter light leaves by the diffuse law alone.

mod coefficients;
mod disc;
mod equation;
mod krylov;
mod layer;
mod phase;
mod picture;
mod rays;
mod shortfall;
mod single;
mod source;
#[cfg(test)]
mod tests;
mod twice;

use glam::DVec3;
use rayon::prelude::*;
use translume_mesh::{Atlas, Texel};

use crate::gather;
use crate::path::{Shape, Volume};
use crate::{Light, Surface};
use coefficients::Coefficients;
use equation::Equation;
pub use layer::{Layers, Seen};
pub use phase::spread;
pub use picture::{Tier, picture};
use rays::Rays;
use source::Source;

/// ρ: how much of the light that scattered twice diffusion lacks, so that a half-space in an even light returns Chandrasekhar's albedo.
#[must_use]
pub fn shortfall(volume: &Volume) -> [f64; 3] {
    Coefficients::of(volume).map(|medium| shortfall::shortfall(&medium))
}

/// A body and its light. Light is shadowed by what it crosses, and goes on through it.
#[derive(Clone, Copy)]
pub struct Body<'a> {
    /// Where it is.
    pub shape: &'a dyn Shape,
    /// What it is made of.
    pub volume: Volume,
    /// What shines on it.
    pub lights: &'a [Light],
}

/// A piece of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// Position, mm.
    pub position: [f64; 3],
    /// Unit normal, outwards.
    pub normal: [f64; 3],
    /// Area, mm²; a site without any receives and gives nothing.
    pub area: f64,
}

/// The texels of an atlas as sites, in its order: those beside a chart moved onto it.
#[must_use]
pub fn sites(atlas: &Atlas, surface: &Surface, texels: &[gather::Source]) -> Vec<Site> {
    let site = |(place, texel): (&Texel, &gather::Source)| {
        let barycentric = gather::clamped(place.barycentric.map(f64::from));
        let position = surface.point(place.triangle, barycentric);
        Site { position, normal: surface.normal(place.triangle, barycentric), area: texel.area }
    };
    atlas.texels.iter().zip(texels).map(site).collect()
}

/// Fluence on the surface.
pub struct Solution<'a> {
    body: Body<'a>,
    medium: [Coefficients; 3],
    rays: Rays<'a>,
    sites: Vec<Site>,
    /// Way straight inwards to the other side, mm.
    thickness: Vec<f64>,
    sources: Vec<Source>,
    equation: Equation,
    given: Vec<[f64; 3]>,
    fluence: Vec<[f64; 3]>,
    returning: Vec<[f64; 3]>,
    residual: [f64; 3],
}

impl<'a> Solution<'a> {
    /// Casts the light, and solves with `steps` applications of the sums.
    #[must_use]
    pub fn new(body: Body<'a>, sites: Vec<Site>, steps: usize) -> Self {
        let medium = Coefficients::of(&body.volume);
        let rays = Rays::new(body.shape, body.volume.ior);
        let thickness: Vec<f64> = sites.par_iter().map(|site| rays.thickness(site)).collect();
        let light = source::Lamps::new(body.lights);
        let enter =
            |(index, site): (usize, &Site)| light.enter(&rays, &medium, site, thickness[index], index);
        let sources: Vec<Source> = sites.par_iter().enumerate().map(enter).collect();
        let equation = Equation::new(&medium, &rays, &sites);
        let given: Vec<[f64; 3]> = sites
            .par_iter()
            .map(|site| source::potential(&medium, &sites, &sources, site.position.into()))
            .collect();
        let (fluence, residual) = krylov::solve(&equation, &given, steps);
        let returning = equation.returning(&fluence);
        Self { body, medium, rays, sites, thickness, sources, equation, given, fluence, returning, residual }
    }

    /// φ_Q at every site, W/m²: what there would be in an endless medium.
    #[must_use]
    pub fn given(&self) -> &[[f64; 3]] {
        &self.given
    }

    /// c of a site: the share of all directions that is body.
    #[must_use]
    pub fn closure(&self, site: usize) -> f64 {
        self.equation.closure(site)
    }

    /// Γ at every site, W/m²: what falls on it of what leaves elsewhere.
    #[must_use]
    pub fn returning(&self) -> &[[f64; 3]] {
        &self.returning
    }

    /// Fluence of scattered light at every site, W/m².
    #[must_use]
    pub fn fluence(&self) -> &[[f64; 3]] {
        &self.fluence
    }

    /// Diffuse exitance of a site, W/m²: what crosses the surface outwards, B = c_G (φ − 4 η² Γ) + T Γ, with T what gets in of diffuse light.
    #[must_use]
    pub fn exitance(&self, site: usize) -> [f64; 3] {
        let (bulge, fluence, returning) =
            (self.equation.bulge(site), self.fluence[site], self.returning[site]);
        std::array::from_fn(|k| self.medium[k].exitance(bulge, fluence[k], returning[k]))
    }

    /// How much of the equation is not solved, over what is given, in the norm that the solver lowers.
    #[must_use]
    pub fn residual(&self) -> [f64; 3] {
        self.residual
    }

    /// Fluence at a point of the volume, W/m².
    #[must_use]
    pub fn fluence_at(&self, point: [f64; 3]) -> [f64; 3] {
        let point = DVec3::from(point);
        let given = source::potential(&self.medium, &self.sites, &self.sources, point);
        let (sum, closure) = self.equation.sums(point, &self.fluence, &self.returning);
        std::array::from_fn(|k| (given[k] - sum[k]) / closure)
    }

    /// The same a little under every site, which tells how light leaves.
    #[must_use]
    pub fn layers(&'a self) -> Layers<'a> {
        Layers::new(self)
    }
}
