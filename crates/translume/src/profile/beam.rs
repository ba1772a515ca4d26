//! Photon beam diffusion at normal incidence, and light that was scattered once. Habel, Christensen, Jarosz 2013, "Photon Beam
//! Diffusion: A Hybrid Monte Carlo Method for Subsurface Scattering".

use super::channel::{Channel, Grosjean};
use super::dipole::Dipole;
use super::radial::Radial;
use super::sampled::{RANGE, Sampled, Shape};
use crate::fresnel;
use crate::quadrature::{GAUSS_32, GAUSS_64, integrate};
use std::f64::consts::PI;

/// Beyond this many mean free paths a beam has left e^−40 of itself.
const BEAM_LENGTH: f64 = 40.0;

/// R_d of the beam: dipoles of d'Eon's kind along it, each held down near the surface by κ.
pub(crate) fn beam(channel: &Channel) -> Sampled {
    let grosjean = Grosjean::new(channel);
    // κ leaves R_d only the logarithm of r near 0: the trees may pass over it as over a dipole's core.
    let shape = Shape { smooth_length: 0.5 / channel.extinction(), ..shape(channel, grosjean.sigma_tr) };
    Sampled::new(&shape, |r| scaled_beam(channel, &grosjean, r))
}

/// The same with light scattered once. The two together would give back up to 9 % more than they got where nothing is absorbed (at
/// η = 1), so the beam is dimmed to what is just all then.
pub(crate) fn beam_with_single(channel: &Channel) -> Sampled {
    let grosjean = Grosjean::new(channel);
    let shape = shape(channel, grosjean.sigma_tr.min(channel.extinction()));
    let excess = grosjean.sigma_tr - shape.decay;
    let white = Channel { scattering: channel.extinction(), absorption: 0.0, ..*channel };
    let room = ((1.0 - single_total(channel) / channel.albedo()) / beam(&white).total()).min(1.0);
    Sampled::new(&shape, |r| {
        room * scaled_beam(channel, &grosjean, r) * (-excess * r).exp()
            + scaled_single(channel, shape.decay, r)
    })
}

/// A dipole with light scattered once. What has left after one scattering is no longer there to diffuse: the dipole keeps the rest.
pub(crate) fn dipole_with_single(channel: &Channel, dipole: &Dipole) -> Sampled {
    let shape = shape(channel, dipole.decay().min(channel.extinction()));
    let excess = dipole.decay() - shape.decay;
    let rest = 1.0 - single_total(channel) / channel.albedo();
    Sampled::new(&shape, |r| {
        rest * dipole.scaled_reflectance(r) * (-excess * r).exp() + scaled_single(channel, shape.decay, r)
    })
}

/// Light scattered once falls like 1/r from r = 0 on, so there is no smooth core. With a core of one mean free path the error of the dual
/// scatter over a body of texels shorter than that rose from 0.16 % to 2.7 %, for 14 % fewer evaluations.
fn shape(channel: &Channel, decay: f64) -> Shape {
    let mean_free_path = 1.0 / channel.extinction();
    Shape { decay, smooth_length: 0.0, range: RANGE.map(|x| x * mean_free_path) }
}

/// e^(σ_tr r) · α'² ∫ σ_t' e^(−σ_t' t) κ(r, t) R(r, t) dt, κ = 1 − e^(−2σ_t'(d + t)). t = r sinh u: steps as long as the distance.
fn scaled_beam(channel: &Channel, grosjean: &Grosjean, r: f64) -> f64 {
    let extinction = channel.extinction();
    let reach = (BEAM_LENGTH / (extinction * r)).asinh();
    let integral = integrate(&*GAUSS_64, |x| {
        let (depth, distance) = (r * (reach * x).sinh(), r * (reach * x).cosh());
        let kappa = -(-2.0 * extinction * (distance + depth)).exp_m1();
        let point = Dipole::at_depth(grosjean, depth).scaled_reflectance(r);
        (-extinction * depth).exp() * kappa * point * distance
    });
    channel.albedo().powi(2) * extinction * reach * integral
}

/// e^(decay·r) · α' ∫ σ_t' e^(−σ_t'(t + d)) F_t(η, t/d) t/(4πd³) dt for isotropic scattering. Starts where light is no longer
/// reflected back inside; t = r sinh(u₀ + v²) tames the root there.
pub(crate) fn scaled_single(channel: &Channel, decay: f64, r: f64) -> f64 {
    let extinction = channel.extinction();
    let critical = r * (channel.ior * channel.ior - 1.0).max(0.0).sqrt();
    let start = (critical / r).asinh();
    let reach = (((critical + BEAM_LENGTH / extinction) / r).asinh() - start).sqrt();
    let integral = integrate(&*GAUSS_64, |x| {
        let v = reach * x;
        let (depth, distance) = (r * (start + v * v).sinh(), r * (start + v * v).cosh());
        let cosine = (depth / distance).min(1.0);
        let exit = fresnel::transmittance(1.0 / channel.ior, cosine);
        exit * cosine * (decay * r - extinction * (depth + distance)).exp() / distance * 2.0 * v
    });
    channel.albedo() * extinction * reach * integral / (4.0 * PI)
}

/// What leaves after one scattering: α'/2 · ∫ F_t(1/η, μ) μ/(1 + μ) dμ.
fn single_total(channel: &Channel) -> f64 {
    let critical = (1.0 - 1.0 / (channel.ior * channel.ior)).max(0.0).sqrt();
    let span = 1.0 - critical;
    let integral = integrate(&*GAUSS_32, |x| {
        let cosine = critical + span * x * x;
        fresnel::transmittance(1.0 / channel.ior, cosine) * cosine / (1.0 + cosine) * 2.0 * x
    });
    0.5 * channel.albedo() * span * integral
}
