//! The camera's picture of a solution whose sites are the texels of an atlas.

use glam::DVec3;
use std::f64::consts::PI;
use translume_mesh::Atlas;

use super::layer::{ALONG, MOST_ALONG, Seen};
use super::phase::balanced;
use super::shortfall::shortfall;
use super::single::single;
use super::source::Lamps;
use super::twice::twice;
use super::{Layers, Solution};
use crate::composite::{Camera, Picture, expose, texels_at, view_cosine};
use crate::dice::Dice;
use crate::fresnel::{hemispherical_transmittance, refracted_cos, transmittance};
use crate::{Hit, Surface};

/// How light leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Tier {
    /// By the diffuse law, L = F_t B / π (1 − F_dr,ext).
    Boundary,
    /// Gathered along the ray of view from under the surface, and once scattered. Through a surface to a denser outside as [`Tier::Boundary`].
    Layers,
}

/// A picture of a surface; the sites of the solution are the atlas's texels in its order.
#[must_use]
pub fn picture(
    camera: &Camera,
    surface: &Surface,
    atlas: &Atlas,
    solution: &Solution<'_>,
    tier: Tier,
) -> Picture {
    let is_known = solution.rays.ior >= 1.0;
    let layers = (tier == Tier::Layers && is_known).then(|| solution.layers());
    let eye = Eye {
        surface,
        atlas,
        solution,
        layers,
        lamps: Lamps::new(solution.body.lights),
        shortfall: std::array::from_fn(|k| shortfall(&solution.medium[k])),
    };
    expose(camera, |index| {
        let direction =
            DVec3::from(camera.direction(index % camera.width, index / camera.width)).normalize_or_zero();
        let hit = surface.closest_hit(camera.eye, direction.to_array())?;
        Some(eye.radiance(camera, &hit, direction, index))
    })
}

struct Eye<'a> {
    surface: &'a Surface,
    atlas: &'a Atlas,
    solution: &'a Solution<'a>,
    layers: Option<Layers<'a>>,
    lamps: Lamps,
    /// Of each channel.
    shortfall: [f64; 3],
}

/// Rays that graze the surface by less than this run along it.
const GRAZING: f64 = 0.02;

impl Eye<'_> {
    fn radiance(&self, camera: &Camera, hit: &Hit, direction: DVec3, index: usize) -> [f64; 3] {
        let rays = &self.solution.rays;
        let outside = view_cosine(self.surface, hit, direction);
        let sites: Vec<(usize, f64)> = texels_at(self.atlas, hit).collect();
        let Some(layers) = &self.layers else {
            let leaves = transmittance(rays.ior, outside) / (PI * hemispherical_transmittance(rays.ior));
            let mut sum = [0.0; 3];
            for (site, weight) in sites {
                crate::rgb::accumulate(&mut sum, self.solution.exitance(site), weight * leaves);
            }
            return sum;
        };
        let mut dice = Dice::stream(3, index as u64);
        let normal = DVec3::from(self.surface.normal(hit.triangle, hit.barycentric));
        let seen_at = DVec3::from(self.surface.point(hit.triangle, hit.barycentric));
        let direction = -rays.bent(-direction, normal);
        let place = seen_at + direction * (10.0 * rays.offset);
        let eye = if rays.ior == 1.0 { camera.eye.into() } else { place };
        let ray = (eye, direction);
        let mut segments = rays.segments(ray.0, ray.1, f64::INFINITY);
        if rays.ior != 1.0 {
            // Where light goes that comes in again is another matter.
            segments.truncate(1);
        }
        let chord = segments.first().map_or(0.0, |[from, to]| to - from);
        let cosine = refracted_cos(rays.ior, outside.max(0.0));
        let far = self.surface.closest_hit(place.to_array(), direction.to_array()).and_then(|far| {
            let normal = DVec3::from(self.surface.normal(far.triangle, far.barycentric));
            let (site, _) = texels_at(self.atlas, &far).max_by(|a, b| a.1.total_cmp(&b.1))?;
            Some((site, normal.dot(direction).max(GRAZING)))
        });
        let mean = self.solution.medium.iter().map(|channel| channel.extinction).sum::<f64>() / 3.0;
        let along = ALONG.map(|ways| {
            let s = ways / mean;
            let above = (s < MOST_ALONG * chord)
                .then(|| self.surface.closest_hit((place + direction * s).to_array(), normal.to_array()))
                .flatten();
            let site = above.and_then(|above| {
                texels_at(self.atlas, &above).max_by(|a, b| a.1.total_cmp(&b.1)).map(|(site, _)| site)
            });
            (s, site)
        });
        let bulge =
            sites.iter().map(|(site, weight)| weight * self.solution.equation.bulge(*site)).sum::<f64>();
        let seen = Seen { sites, cosine: cosine.max(GRAZING), chord, along, far };
        let many = layers.radiance(&seen);
        let seen_along = (ray, segments.as_slice(), seen.cosine);
        let once = single(&self.solution.medium, rays, &self.lamps, seen_along, &mut dice);
        // Parts of the ray behind the first are out of the layers' sight.
        let twice = twice(self.solution, (place, direction), seen.cosine, chord);
        let leaves = transmittance(rays.ior, outside) / (rays.ior * rays.ior);
        std::array::from_fn(|k| {
            let medium = &self.solution.medium[k];
            let lacking = self.shortfall[k] * medium.lean(seen.cosine) * medium.along(bulge);
            // Light of lamps that entered close by; what comes from afar leaves as it does where all scatters evenly.
            let lit = |(site, weight): &(usize, f64)| weight * self.solution.sources[*site].aimed[k];
            let lit = seen.sites.iter().map(lit).sum::<f64>();
            let close = (lit / (PI * many[k]).max(1e-30)).min(1.0);
            let balance = 1.0 + close * (balanced(medium.g, seen.cosine) - 1.0);
            leaves * (balance * (many[k] + lacking * twice[k]) + once[k])
        })
    }
}
