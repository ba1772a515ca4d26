//! Photon beam diffusion and light scattered once, by adaptive quadrature over the depth.

use std::f64::consts::PI;

use super::diffusion::{grosjean, point_source};
use super::{Channel, Numeric, Profile};
use crate::fresnel::transmittance;
use crate::quadrature::integrate;

/// Panels of the depth that double from a fraction of r until nothing of the beam is left.
fn over_depth(r: f64, mean_free_path: f64, start: f64, f: impl Fn(f64) -> f64) -> f64 {
    let end = start + 45.0 * mean_free_path;
    let (mut from, mut width) = (start, 0.5 * r);
    let mut sum = 0.0;
    while from < end {
        let to = (from + width.min(mean_free_path)).min(end);
        sum += integrate(&f, from, to, 1e-9);
        (from, width) = (to, 2.0 * width);
    }
    sum
}

fn range(channel: &Channel) -> [f64; 2] {
    [1e-4, 1e3].map(|x| x / channel.sigma_t())
}

fn beam_reflectance(channel: &Channel) -> impl Fn(f64) -> f64 + use<> {
    let channel = *channel;
    let source = point_source(&channel);
    let (sigma_t, albedo) = (channel.sigma_t(), channel.albedo());
    move |r| {
        let along = |t: f64| {
            let kappa = 1.0 - (-2.0 * sigma_t * (r.hypot(t) + t)).exp();
            albedo * albedo * sigma_t * (-sigma_t * t).exp() * kappa * source(r, t)
        };
        over_depth(r, 1.0 / sigma_t, 0.0, along)
    }
}

/// Habel, Christensen, Jarosz 2013: multiple scattering of a beam along the normal.
#[must_use]
pub fn photon_beam(channel: &Channel) -> Numeric {
    Numeric::new(beam_reflectance(channel), grosjean(channel).1, 0.0, range(channel))
}

pub(super) fn single(channel: &Channel, r: f64) -> f64 {
    let (sigma_t, eta) = (channel.sigma_t(), channel.ior);
    let critical = r * (eta * eta - 1.0).max(0.0).sqrt();
    let at = |t: f64| {
        let d = r.hypot(t);
        let exit = transmittance(1.0 / eta, t / d) * (t / d);
        channel.sigma_s_prime * exit * (-sigma_t * (t + d)).exp() / (4.0 * PI * d * d)
    };
    // t = critical + w² where the transmittance begins as a root.
    let near = integrate(|w: f64| at(critical + w * w) * 2.0 * w, 0.0, r.sqrt(), 1e-9);
    near + over_depth(r, 1.0 / sigma_t, critical + r, at)
}

/// Adds light scattered once to one of the diffusion profiles, dimmed so that both together return no more than came in.
/// `white`: the total of the same profile in a medium that absorbs nothing.
#[must_use]
pub fn with_single(channel: &Channel, diffusion: &dyn Profile, white: f64) -> Numeric {
    let eta = channel.ior;
    let critical = (1.0 - 1.0 / (eta * eta)).max(0.0).sqrt();
    let once = 0.5 * integrate(|mu| transmittance(1.0 / eta, mu) * mu / (1.0 + mu), critical, 1.0, 1e-9);
    let room = ((1.0 - once) / white).min(1.0);
    let decay = diffusion.decay().min(channel.sigma_t());
    Numeric::new(|r| room * diffusion.reflectance(r) + single(channel, r), decay, 0.0, range(channel))
}
