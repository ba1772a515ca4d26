//! Layers over each other: mirrored sources summed one by one, layers joined bounce by bounce.

use std::f64::consts::PI;

use super::{Channel, Numeric};
use crate::fresnel::diffuse_reflectance_fit;
use crate::quadrature::integrate;

/// A layer: its medium, whose index counts against air, and its thickness, mm (infinite for the last alone).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// The medium.
    pub channel: Channel,
    /// Thickness, mm.
    pub thickness: f64,
}

/// Bounces between two layers, and mirrored pairs of sources, before the sum is taken as complete.
const MOST: i32 = 4000;

/// Donner, Jensen 2005: reflectance of layers from top to bottom, air above and, unless the last is infinite, below.
#[must_use]
pub fn stack(sheets: &[Sheet], range: [f64; 2], decay: f64) -> Numeric {
    let depth = sheets.iter().map(|sheet| source(sheet).0).fold(f64::INFINITY, f64::min);
    let spectrum = |k: f64| reflected(sheets, 0, k);
    Numeric::new(|r| inverse_hankel(spectrum, depth, r), decay, depth, range)
}

/// Depth of the source, mm: the mean of where light is scattered first; and its power.
fn source(sheet: &Sheet) -> (f64, f64) {
    let sigma_t = sheet.channel.sigma_t();
    if sheet.thickness.is_infinite() {
        return (1.0 / sigma_t, sheet.channel.albedo());
    }
    let first = |t: f64| sigma_t * (-sigma_t * t).exp();
    let scattered = integrate(first, 0.0, sheet.thickness, 1e-12);
    let depth = integrate(|t| t * first(t), 0.0, sheet.thickness, 1e-12) / scattered;
    (depth, sheet.channel.albedo() * scattered)
}

/// Reflectance at spatial frequency k, 1/mm, of the sheets from `top` on.
fn reflected(sheets: &[Sheet], top: usize, k: f64) -> f64 {
    let Some(sheet) = sheets.get(top) else { return 0.0 };
    let outside =
        |index: Option<usize>| index.and_then(|k| sheets.get(k)).map_or(1.0, |sheet| sheet.channel.ior);
    let ratios = [outside(top.checked_sub(1)), outside(Some(top + 1))].map(|other| sheet.channel.ior / other);
    let [back, down] = response(sheet, ratios, k);
    if top + 1 == sheets.len() {
        return back;
    }
    let [under, up] = response(sheet, [ratios[1], ratios[0]], k);
    let below = reflected(sheets, top + 1, k);
    let (mut sum, mut bounce) = (back, down * below * up);
    for _ in 0..MOST {
        sum += bounce;
        bounce *= under * below;
        if bounce < 1e-14 * sum {
            break;
        }
    }
    sum
}

/// What is reflected and what goes through, from one side. A source at depth z is the exponential e^(−sz) at the surface.
fn response(sheet: &Sheet, ratios: [f64; 2], k: f64) -> [f64; 2] {
    let Channel { sigma_a, .. } = sheet.channel;
    let sigma_t = sheet.channel.sigma_t();
    let s = k.hypot((3.0 * sigma_a * sigma_t).sqrt());
    let [near, far] = ratios.map(|eta| {
        let f_dr = diffuse_reflectance_fit(eta);
        2.0 * (1.0 + f_dr) / (1.0 - f_dr) / (3.0 * sigma_t)
    });
    let (depth, power) = source(sheet);
    let through = (-sigma_t * sheet.thickness).exp();
    if sheet.thickness.is_infinite() {
        return [0.5 * power * ((-s * depth).exp() + (-s * (depth + 2.0 * near)).exp()), 0.0];
    }
    let period = 2.0 * (sheet.thickness + near + far);
    let wave = |z: f64| z.signum() * (-s * z.abs()).exp();
    let (mut reflected, mut passed) = (0.0, 0.0);
    for i in 0..MOST {
        let mut largest = 0.0_f64;
        for i in if i == 0 { vec![0] } else { vec![-i, i] } {
            let real = f64::from(i) * period + depth;
            let mirror = f64::from(i) * period - depth - 2.0 * near;
            let up = wave(real) - wave(mirror);
            let on = wave(sheet.thickness - real) - wave(sheet.thickness - mirror);
            (reflected, passed) = (reflected + 0.5 * power * up, passed + 0.5 * power * on);
            largest = largest.max(up.abs() + on.abs());
        }
        if largest < 1e-14 {
            break;
        }
    }
    [reflected, passed + through]
}

/// 1/2π ∫ F(k) J₀(kr) k dk, for F that falls like e^(−k·depth).
fn inverse_hankel(spectrum: impl Fn(f64) -> f64, depth: f64, r: f64) -> f64 {
    // Panels no longer than half a wave, a quarter of the decay, or what lies before them.
    let (mut from, mut to) = (0.0, 1e-3 / r.max(depth));
    let mut sum = 0.0;
    while from < 36.0 / depth {
        sum += integrate(|k| spectrum(k) * bessel(k * r) * k, from, to, 1e-10);
        (from, to) = (to, to + to.min(PI / r).min(2.0 / depth));
    }
    sum / (2.0 * PI)
}

/// J₀ from its integral, ∫ cos(x sin θ) dθ / π, by the trapezoid rule, which for a period converges beyond any power.
fn bessel(x: f64) -> f64 {
    let steps = 12 + (0.6 * x) as u32;
    let at = |k: u32| (x * ((f64::from(k) + 0.5) * PI / (2.0 * f64::from(steps))).sin()).cos();
    (0..steps).map(at).sum::<f64>() / f64::from(steps)
}

#[cfg(test)]
mod tests {
    use super::super::Profile;
    use super::*;
    use crate::Dipole;
    use crate::testing::assert_rel;

    #[test]
    fn an_infinite_sheet_is_the_dipole() {
        let channel = Channel { sigma_s_prime: 0.88, sigma_a: 0.17, ior: 1.3 };
        let dipole = Dipole::new(0.88, 0.17, 1.3);
        let half_space = [Sheet { channel, thickness: f64::INFINITY }];
        let profile = stack(&half_space, [0.01, 10.0], dipole.sigma_tr);
        for r in [0.02, 0.5, 3.0] {
            assert_rel(profile.reflectance(r), dipole.reflectance(r), 1e-5, "dipole");
        }
        let slab = stack(&[Sheet { thickness: 1.0, ..half_space[0] }], [0.01, 10.0], dipole.sigma_tr);
        assert!((slab.reflectance(0.5) / dipole.reflectance(0.5) - 1.0).abs() > 0.02, "1 mm is not infinite");
    }

    /// The published sum over mirrored sources, in space.
    #[test]
    fn a_slab_is_its_multipole() {
        let channel = Channel { sigma_s_prime: 1.0, sigma_a: 0.05, ior: 1.3 };
        let (sigma_t, thickness) = (channel.sigma_t(), 12.0);
        let sigma_tr = (3.0 * 0.05 * sigma_t).sqrt();
        let profile = stack(&[Sheet { channel, thickness }], [0.01, 20.0], sigma_tr);
        let f_dr = diffuse_reflectance_fit(1.3);
        let z_b = 2.0 / 3.0 * (1.0 + f_dr) / (1.0 - f_dr) / sigma_t;
        let multipole = |r: f64| {
            let term = |z: f64| {
                let d = r.hypot(z);
                z * (1.0 + sigma_tr * d) * (-sigma_tr * d).exp() / (4.0 * PI * d.powi(3))
            };
            let pair = |i: i32| {
                let base = 2.0 * f64::from(i) * (thickness + 2.0 * z_b);
                term(base + 1.0 / sigma_t) - term(base - 1.0 / sigma_t - 2.0 * z_b)
            };
            channel.albedo() * (-20..=20).map(pair).sum::<f64>()
        };
        for r in [0.1, 1.0, 4.0] {
            // The source's depth and power are off by some e^(−12.6).
            assert_rel(profile.reflectance(r), multipole(r), 3e-4, "multipole");
            assert!((profile.reflectance(1.05 * r) / multipole(r) - 1.0).abs() > 3e-3 || r < 0.5);
        }
    }
}
