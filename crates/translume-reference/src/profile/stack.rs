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
/// `range`, `decay`: as in [`Numeric::new`].
#[must_use]
pub fn stack(sheets: &[Sheet], range: [f64; 2], decay: f64) -> Numeric {
    let outside =
        |index: Option<usize>| index.and_then(|k| sheets.get(k)).map_or(1.0, |sheet| sheet.channel.ior);
    let plates: Vec<Plate> = (0..sheets.len())
        .map(|k| Plate::new(&sheets[k], [outside(k.checked_sub(1)), outside(Some(k + 1))]))
        .collect();
    let depth = plates.iter().map(|plate| plate.depth).fold(f64::INFINITY, f64::min);
    Numeric::new(|r| inverse_hankel(|k| reflected(&plates, k), depth, r), decay, depth, range)
}

struct Plate {
    thickness: f64,
    sigma_tr: f64,
    /// Depth of the source, mm: the mean of where light is scattered first.
    depth: f64,
    power: f64,
    /// What goes through without meeting anything.
    unscattered: f64,
    /// 2AD at top and bottom, mm.
    z_b: [f64; 2],
}

impl Plate {
    /// `outside`: index of refraction above and below.
    fn new(sheet: &Sheet, outside: [f64; 2]) -> Self {
        let (Sheet { channel, thickness }, sigma_t) = (*sheet, sheet.channel.sigma_t());
        let end = thickness.min(50.0 / sigma_t);
        let first = |t: f64| sigma_t * (-sigma_t * t).exp();
        let scattered = integrate(first, 0.0, end, 1e-12);
        let z_b = outside.map(|other| {
            let f_dr = diffuse_reflectance_fit(channel.ior / other);
            2.0 * (1.0 + f_dr) / (1.0 - f_dr) / (3.0 * sigma_t)
        });
        Self {
            thickness,
            sigma_tr: (3.0 * channel.sigma_a * sigma_t).sqrt(),
            depth: integrate(|t| t * first(t), 0.0, end, 1e-12) / scattered,
            power: channel.albedo() * scattered,
            unscattered: (-sigma_t * thickness).exp(),
            z_b,
        }
    }

    /// What is reflected and what goes through, from one side. A source at depth z is the exponential e^(−sz) at the surface.
    fn response(&self, k: f64, [near, far]: [f64; 2]) -> [f64; 2] {
        let s = k.hypot(self.sigma_tr);
        if self.thickness.is_infinite() {
            let mirror = self.depth + 2.0 * near;
            return [0.5 * self.power * ((-s * self.depth).exp() + (-s * mirror).exp()), 0.0];
        }
        let period = 2.0 * (self.thickness + near + far);
        let wave = |z: f64| z.signum() * (-s * z.abs()).exp();
        let pair = |i: i32| {
            let real = f64::from(i) * period + self.depth;
            let mirror = f64::from(i) * period - self.depth - 2.0 * near;
            [wave(real) - wave(mirror), wave(self.thickness - real) - wave(self.thickness - mirror)]
        };
        let mut sums = pair(0);
        for i in 1..MOST {
            let [left, right] = [pair(-i), pair(i)];
            (0..2).for_each(|k| sums[k] += left[k] + right[k]);
            if [left, right].iter().flatten().all(|term| term.abs() < 1e-14) {
                break;
            }
        }
        [0.5 * self.power * sums[0], 0.5 * self.power * sums[1] + self.unscattered]
    }
}

/// Reflectance at spatial frequency k, 1/mm.
fn reflected(plates: &[Plate], k: f64) -> f64 {
    let Some((plate, below)) = plates.split_first() else { return 0.0 };
    let [back, down] = plate.response(k, plate.z_b);
    let [under, up] = plate.response(k, [plate.z_b[1], plate.z_b[0]]);
    let below = reflected(below, k);
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
