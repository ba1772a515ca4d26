//! All orders of scattering, from random walks of the medium itself.

use std::f64::consts::TAU;

use super::Numeric;
use super::beam::single;
use super::{Channel, Entry};
use crate::half_space::{Entry as Way, Light, Setup, decay_rate};

/// Rings noisier than this are left to the exponential.
const NOISIEST: f64 = 0.1;

/// The walks that [`half_space`] is made of: isotropic with σ_s'. 200,000 know the energy of a ring of a third of an octave to about 1 %
/// where most of it is.
#[must_use]
pub fn walks(channel: &Channel, entry: Entry, photons: u64) -> Setup {
    let entry = if entry == Entry::Normal { Way::Normal } else { Way::Diffuse };
    Setup { entry, ior: channel.ior, albedos: vec![channel.albedo()], photons, ..Setup::default() }
}

/// R_d of a half-space from its [`walks`]. Light scattered once along the normal is exact.
#[must_use]
pub fn half_space(channel: &Channel, entry: Entry, light: &Light) -> Numeric {
    let sigma_t = channel.sigma_t();
    let rate = decay_rate(channel.albedo());
    let knots = knots(light, rate, entry);
    let reflectance = |r: f64| {
        let walked = follow(&knots, r * sigma_t) * falloff(r * sigma_t, rate) * sigma_t * sigma_t;
        walked + if entry == Entry::Normal { single(channel, r) } else { 0.0 }
    };
    Numeric::new(reflectance, rate * sigma_t, 0.0, [1e-4, 1e4].map(|x| x / sigma_t))
}

/// What profiles of this kind look like from far: a source a mean free path deep in a half-space.
fn falloff(r: f64, rate: f64) -> f64 {
    let d = r.hypot(1.0);
    (1.0 + rate * d) * (-rate * d).exp() / (TAU * d.powi(3))
}

/// ln r and ln of the ratio to `falloff` in the middle of each ring: of what the closed form does not know.
fn knots(light: &Light, rate: f64, entry: Entry) -> Vec<[f64; 2]> {
    let face = &light.reflected[0];
    let walks = if entry == Entry::Normal { &face.multiple } else { &face.all };
    let mut knots = Vec::new();
    for (ring, outer) in light.edges.iter().enumerate().skip(1) {
        let walked = walks.rings[ring];
        let middle = (light.edges[ring - 1] * outer).sqrt();
        if walked.error > NOISIEST * walked.value && middle > 1.0 {
            break;
        }
        if walked.value > 0.0 {
            let ratio = walked.value / light.area(ring) / falloff(middle, rate);
            knots.push([middle.ln(), ratio.ln()]);
        }
    }
    knots
}

/// Straight lines over ln r, constant beyond.
fn follow(knots: &[[f64; 2]], r: f64) -> f64 {
    let x = r.ln();
    let next = knots.partition_point(|knot| knot[0] < x);
    if next == 0 || next == knots.len() {
        return knots.get(next.saturating_sub(1)).map_or(0.0, |knot| knot[1].exp());
    }
    let [[x0, y0], [x1, y1]] = [knots[next - 1], knots[next]];
    (y0 + (y1 - y0) * (x - x0) / (x1 - x0)).exp()
}
