//! The dipole's constants, and at which distance how much of its energy lies.

use bytemuck::{Pod, Zeroable};
use std::f64::consts::TAU;
use translume::Medium;

const ENTRIES: usize = 128;
/// −ln of the least share of the energy that is told apart.
const RANGE: f64 = 24.0;

/// As WGSL reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct MediumLayout {
    pub sigma_tr: [f32; 3],
    pub table_step: f32,
    pub z_real: [f32; 3],
    pub padding0: u32,
    pub z_virtual: [f32; 3],
    pub padding1: u32,
    pub half_albedo: [f32; 3],
    pub padding2: u32,
    pub share: [f32; 3],
    pub padding3: u32,
    pub radii: [[f32; 4]; ENTRIES / 4],
}

/// The classical dipole of one channel.
#[derive(Clone, Copy)]
struct Dipole {
    half_albedo: f64,
    /// 1/mm.
    sigma_tr: f64,
    /// Depth of the real source and height of the virtual one, mm.
    z: [f64; 2],
}

impl Dipole {
    /// Jensen et al. 2001, eq. 4.
    fn new(scattering: f64, absorption: f64, boundary: f64) -> Self {
        // A medium that does nothing at all has an infinite mean free path; a very long one behaves the same and stays finite.
        let extinction = (scattering + absorption).max(1e-12);
        let z = 1.0 / extinction;
        Self {
            half_albedo: 0.5 * scattering / extinction,
            sigma_tr: (3.0 * absorption * extinction).sqrt(),
            z: [z, z * (1.0 + 4.0 / 3.0 * boundary)],
        }
    }

    /// ∫ R_d 2πρ dρ from r on.
    fn beyond(&self, r: f64) -> f64 {
        let term = |z: f64| {
            let d = r.hypot(z);
            z / d * (-self.sigma_tr * d).exp()
        };
        self.half_albedo * (term(self.z[0]) + term(self.z[1]))
    }
}

/// A of the boundary, from the fits of Egan and Hilgeman 1973.
fn boundary(eta: f64) -> f64 {
    let reflected = if eta == 1.0 {
        0.0
    } else if eta > 1.0 {
        -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta
    } else {
        -0.4399 + 0.7099 / eta - 0.3319 / (eta * eta) + 0.0636 / (eta * eta * eta)
    };
    let reflected = f64::clamp(reflected, -0.99, 0.99);
    (1.0 + reflected) / (1.0 - reflected)
}

impl MediumLayout {
    /// Constants of a medium, and the table of radii for the mean of its channels.
    pub fn new(medium: &Medium) -> Self {
        let boundary = boundary(medium.ior.into());
        let channels: [Dipole; 3] = std::array::from_fn(|k| {
            Dipole::new(medium.sigma_s_prime[k].into(), medium.sigma_a[k].into(), boundary)
        });
        let each = |value: &dyn Fn(&Dipole) -> f64| std::array::from_fn(|k| value(&channels[k]) as f32);
        let scattering = channels.iter().filter(|c| c.half_albedo > 0.0).count().max(1) as f64;
        let share = |c: &Dipole| if c.half_albedo > 0.0 { 1.0 / (c.beyond(0.0) * scattering) } else { 0.0 };
        let mut radii = [[0.0; 4]; ENTRIES / 4];
        let step = RANGE / (ENTRIES - 1) as f64;
        let energy = |r: f64| channels.iter().map(|c| share(c) * c.beyond(r)).sum::<f64>();
        for (k, radius) in radii.as_flattened_mut().iter_mut().enumerate() {
            *radius = squared_radius(&energy, k as f64 * step, &channels) as f32;
        }
        Self {
            sigma_tr: each(&|c| c.sigma_tr),
            table_step: step as f32,
            z_real: each(&|c| c.z[0]),
            padding0: 0,
            z_virtual: each(&|c| c.z[1]),
            padding1: 0,
            half_albedo: each(&|c| c.half_albedo),
            padding2: 0,
            share: each(&share),
            padding3: 0,
            radii,
        }
    }
}

/// r², mm², beyond which e^(−`depth`) of the energy lies, by bisection.
fn squared_radius(energy: &dyn Fn(f64) -> f64, depth: f64, channels: &[Dipole; 3]) -> f64 {
    if depth == 0.0 {
        return 0.0;
    }
    let longest = channels.iter().map(|c| c.z[1]).fold(0.0, f64::max);
    // Without absorption the energy falls like 1/r: e^24 times the longest length.
    let (mut low, mut high) = (0.0, longest * RANGE.exp() * TAU);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if energy(middle) > (-depth).exp() { low = middle } else { high = middle }
    }
    // f32 holds its square.
    low.min(1e15).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use translume_reference::Dipole as Twin;

    #[test]
    fn constants_and_shares_are_those_of_the_reference() {
        let medium = Medium { sigma_a: [0.0, 0.17, 0.48], ..Medium::SKIN1 };
        let layout = MediumLayout::new(&medium);
        let twins: Vec<_> = (0..3)
            .map(|k| Twin::new(medium.sigma_s_prime[k].into(), medium.sigma_a[k].into(), medium.ior.into()))
            .collect();
        for (k, twin) in twins.iter().enumerate() {
            let found =
                [layout.sigma_tr[k], layout.z_real[k], layout.z_virtual[k], 2.0 * layout.half_albedo[k]];
            for (found, expected) in found.into_iter().zip([twin.sigma_tr, twin.z[0], twin.z[1], twin.albedo])
            {
                // f32.
                assert!((f64::from(found) - expected).abs() <= 1e-6 * expected, "{k}: {found} {expected}");
            }
        }
        for k in [1, 9, 40] {
            let r = f64::from(layout.radii.as_flattened()[k]).sqrt();
            let share = |r: f64| twins.iter().map(|t| (1.0 - t.enclosed(r) / t.total()) / 3.0).sum::<f64>();
            let expected = (-f64::from(layout.table_step) * k as f64).exp();
            // The share is 1e-3 at least, so that 1 − enclosed keeps twelve digits; f32 has seven.
            assert!((share(r) / expected - 1.0).abs() < 1e-5, "{k}: {} {expected}", share(r));
            assert!((share(1.01 * r) / expected - 1.0).abs() > 1e-3, "1 % of the radius must be noticed");
        }
    }

    #[test]
    fn media_at_the_limits_stay_finite() {
        for (s, a, ior) in [(0.0, 0.0, 1.3), (0.0, 1.0, 1.5), (1e4, 0.0, 0.7), (1e-4, 1e-6, 3.0)] {
            let medium = Medium { sigma_s_prime: [s; 3], sigma_a: [a; 3], ior, g: 0.0 };
            let layout = MediumLayout::new(&medium);
            let values = layout.radii.as_flattened().iter().chain(&layout.share).chain(&layout.z_virtual);
            assert!(values.into_iter().all(|x| x.is_finite() && *x >= 0.0), "{medium:?}");
        }
    }
}
