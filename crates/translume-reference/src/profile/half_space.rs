//! All orders of scattering, from random walks of the medium itself.

use std::f64::consts::TAU;

use super::Numeric;
use super::beam::single;
use super::{Channel, Entry};
use crate::half_space::{Entry as Way, Light, Rings, Setup, decay_rate};

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
    let face = &light.reflected[0];
    let beam = |r: f64| TAU * (-r).exp();
    let source = |r: f64| (-rate * r.hypot(1.0)).exp() / r.hypot(1.0);
    let once = knots(light, &face.single, beam);
    let often = knots(light, &face.multiple, source);
    let reflectance = |r: f64| {
        let x = r * sigma_t;
        let once = match entry {
            Entry::Normal => single(channel, r),
            Entry::Diffuse => follow(&once, x) * (-x).exp() / x * sigma_t * sigma_t,
        };
        once + follow(&often, x) * falloff(x, rate) * sigma_t * sigma_t
    };
    Numeric::new(reflectance, rate * sigma_t, 0.0, [1e-4, 1e4].map(|x| x / sigma_t))
}

/// What light scattered often looks like from far: a source a mean free path deep in a half-space.
fn falloff(r: f64, rate: f64) -> f64 {
    let d = r.hypot(1.0);
    (1.0 + rate * d) * (-rate * d).exp() / (TAU * d.powi(3))
}

/// ln r in the middle of each ring, and ln of what left there over what `beyond` has in it: the integral of a simple shape from r on.
fn knots(light: &Light, walked: &Rings, beyond: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let mut knots = Vec::new();
    for (ring, outer) in light.edges.iter().enumerate().skip(1) {
        let (inner, walked) = (light.edges[ring - 1], walked.rings[ring]);
        let middle = (inner * outer).sqrt();
        if walked.error > NOISIEST * walked.value && middle > 1.0 {
            break;
        }
        if walked.value > 0.0 {
            knots.push([middle.ln(), (walked.value / (beyond(inner) - beyond(*outer))).ln()]);
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
