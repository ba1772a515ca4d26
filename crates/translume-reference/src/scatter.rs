//! Scatter: radiant exitance of texels from all pairs, without a tree (twin of the GPU's scatter stage).
//!
//! B_i = Σ_j E_j A_j K̄(|p_i − p_j|, s_j), where K̄ is the profile averaged over a flat disc about the source whose rms
//! radius s gives it the texel's area, a little narrower where source and receiver are not the same texel. The disc lies along the connecting line or faces it; with c the cosine between
//! the line and the source's normal, K̄ = K_lying (1 − c²) + K_facing c².

use std::f64::consts::{PI, SQRT_2};

use glam::DVec3;
use rayon::prelude::*;

use crate::gather::Source;
use crate::profile::Profile;
use crate::quadrature::integrate;
use crate::rgb::accumulate;

/// How much narrower than a disc of its own area a texel looks to any other texel. Discs in a square lattice overlap along the axes, and
/// a receiver in the middle of its own disc would see its neighbours reach into it.
const NEIGHBOUR_NARROWING: f64 = 0.945;

/// Exitance, W/m², at the texels named by `receivers`, from all texels.
///
/// # Panics
/// If a receiver is not the index of a texel.
#[must_use]
pub fn all_pairs<P: Profile>(sources: &[Source], profiles: &[P; 3], receivers: &[usize]) -> Vec<[f64; 3]> {
    let lit: Vec<(usize, &Source)> =
        sources.iter().enumerate().filter(|(_, s)| s.power() != [0.0; 3]).collect();
    let exitance = |&receiver: &usize| {
        let at = DVec3::from(sources[receiver].position);
        let mut sum = [0.0; 3];
        for (index, source) in &lit {
            let power = source.power();
            let kernel = if *index == receiver {
                std::array::from_fn(|k| own_average(&profiles[k], source.spread()))
            } else {
                averaged_kernel(profiles, at, source)
            };
            accumulate(&mut sum, std::array::from_fn(|k| kernel[k] * power[k]), 1.0);
        }
        sum
    };
    receivers.par_iter().map(exitance).collect()
}

/// Mean of R_d, 1/mm², over a texel of rms radius `spread` around the receiver itself, as what an evenly lit plane of such squares has to send
/// there less what the discs of its neighbours do: with 5 × 5 squares, the rest being smooth. It makes up for the gaps and overlaps of discs.
#[must_use]
pub fn own_average<P: Profile>(profile: &P, spread: f64) -> f64 {
    const STEPS: u32 = 64;
    let side = (2.0 * PI).sqrt() * spread;
    if side * side < f64::MIN_POSITIVE {
        return profile.reflectance(0.0);
    }
    let rim = |k: u32| 2.5 * side / (0.25 * PI * (f64::from(k) + 0.5) / f64::from(STEPS)).cos();
    let block = (0..STEPS).map(|k| profile.enclosed(rim(k))).sum::<f64>() / f64::from(STEPS);
    let radius = SQRT_2 * spread * NEIGHBOUR_NARROWING;
    let places = (-2..=2).flat_map(|x: i32| (-2..=2).map(move |y: i32| (x, y)));
    let others = places
        .filter(|place| *place != (0, 0))
        .map(|(x, y)| disc_average(profile, side * f64::from(x).hypot(f64::from(y)), radius).0);
    (block / (side * side) - others.sum::<f64>()).max(0.0)
}

/// K̄ of each channel, 1/mm², at a point for one source of another texel.
fn averaged_kernel<P: Profile>(profiles: &[P; 3], at: DVec3, source: &Source) -> [f64; 3] {
    let offset = at - DVec3::from(source.position);
    let r = offset.length();
    let cos = if r > 0.0 { offset.dot(source.normal.into()) / r } else { 0.0 };
    let radius = SQRT_2 * source.spread() * NEIGHBOUR_NARROWING;
    std::array::from_fn(|k| {
        let (lying, facing) = disc_average(&profiles[k], r, radius);
        lying * (1.0 - cos * cos) + facing * cos * cos
    })
}

/// Mean of R_d, 1/mm², over a flat disc of radius `a` mm (rms radius a/√2) whose centre is `r` mm away: with the disc
/// lying along the connecting line, and with the disc facing it. Relative error below 1e-7; a = 0 gives R_d(r) twice.
#[must_use]
pub fn disc_average<P: Profile>(profile: &P, r: f64, a: f64) -> (f64, f64) {
    if profile.total() == 0.0 {
        return (0.0, 0.0);
    }
    let area = PI * a * a;
    let point = profile.reflectance(r);
    // A disc whose area or whose ring underflows is a point.
    let facing = if area < f64::MIN_POSITIVE { point } else { profile.ring(r, a) / area };
    let smallest_distance = (r * r + profile.core() * profile.core()).sqrt();
    let relative_size = a * (1.0 / smallest_distance + profile.decay());
    let lying =
        if relative_size < 0.03 { small_lying_disc(profile, r, a) } else { lying_disc(profile, r, a) };
    (lying, facing)
}

/// Radon's seven-point rule of degree 5 for the disc: 1/4 at the centre and 1/8 at six points at √(2/3) of the radius,
/// here mirrored about the connecting line. Its error is of the order of the sixth power of the disc's size over the
/// kernel's length.
fn small_lying_disc(profile: &impl Profile, r: f64, a: f64) -> f64 {
    let ring = a * (2.0f64 / 3.0).sqrt();
    let at = |along: f64, across: f64| profile.reflectance((r + along).hypot(across));
    let (half, height) = (0.5 * ring, 0.75f64.sqrt() * ring);
    0.25 * at(0.0, 0.0)
        + 0.125 * (at(ring, 0.0) + at(-ring, 0.0))
        + 0.25 * (at(half, height) + at(-half, height))
}

/// The disc as an integral along its rim. With M(ρ) the profile enclosed in radius ρ, Gauss's theorem turns
/// ∫_disc R_d dA into 1/2π ∮ M(ρ) dψ, ψ the rim's direction seen from the receiver: the integral ∫ R_d ρ 2φ(ρ) dρ over
/// arcs φ integrated by parts, without its root singularities. Outside the disc ∮ dψ = 0 and M may be replaced by
/// M − total, which keeps its digits where R_d is exponentially small.
fn lying_disc(profile: &impl Profile, r: f64, a: f64) -> f64 {
    let clearance = r - a;
    let near = clearance <= profile.core();
    // At angle t from the rim's nearest point: ρ² = (r − a)² + 4 r a sin²(t/2), ρ² dψ/dt = a² − a r cos t.
    let rim = |t: f64| {
        let chord = (0.5 * t).sin().powi(2);
        let rho = (clearance * clearance + 4.0 * r * a * chord).sqrt();
        let turn = 2.0 * a * r * chord - a * clearance;
        if near {
            // M/ρ² is the mean over the disc of radius ρ and stays finite as ρ vanishes.
            let mean = if rho > 1e-150 {
                profile.enclosed(rho) / (rho * rho)
            } else {
                PI * profile.reflectance(0.0)
            };
            mean * turn
        } else {
            -profile.beyond(rho) * turn / (rho * rho)
        }
    };
    // Near t = 0 the integrand changes over the clearance or over the profile's core: panels that double from there resolve it.
    let mut from = 0.0;
    let mut to = clearance.abs().max(profile.core()).max(1e-9 * a) / a;
    let mut sum = 0.0;
    while from < PI {
        to = if to > 0.5 * PI { PI } else { to };
        sum += integrate(rim, from, to, 1e-9);
        (from, to) = (to, 2.0 * to);
    }
    sum / (PI * PI * a * a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::integrate_panels;
    use crate::testing::{assert_rel, sphere_exitance};
    use crate::{Dipole, Medium};

    const MARBLE: Medium =
        Medium { sigma_s_prime: [2.19, 2.62, 3.0], sigma_a: [0.0021, 0.0041, 0.0071], ior: 1.5 };

    fn media() -> [Dipole; 4] {
        [
            Dipole::new(2.19, 0.0021, 1.5),
            Dipole::new(0.03, 1.45, 1.3),
            Dipole::new(20.4, 0.0, 1.3),
            Dipole::new(1.01, 0.48, 1.0),
        ]
    }

    /// The lying average as an integral over arcs about the receiver: another way to the same number.
    fn arcs(dipole: &Dipole, r: f64, a: f64) -> f64 {
        let arc = |rho: f64| {
            let cos = (rho * rho + r * r - a * a) / (2.0 * rho * r);
            dipole.reflectance(rho) * rho * 2.0 * cos.clamp(-1.0, 1.0).acos()
        };
        let (low, high) = ((r - a).abs(), r + a);
        let mut breaks = vec![low];
        let mut step = low.max(dipole.z[0]);
        while low + step < high {
            breaks.push(low + step);
            step *= 2.0;
        }
        breaks.push(high);
        let whole = if r < a { dipole.enclosed(a - r) } else { 0.0 };
        (whole + integrate_panels(arc, &breaks, 1e-10)) / (PI * a * a)
    }

    #[test]
    fn lying_disc_matches_the_arcs() {
        for dipole in media() {
            for a in [0.001, 0.02, 0.4, 3.0, 60.0, 3000.0].map(|a| a * dipole.z[0]) {
                for r in [0.3, 0.9, 1.001, 1.2, 2.0, 10.0, 80.0].map(|r| r * a) {
                    let reference = arcs(&dipole, r, a);
                    if reference < 1e-280 {
                        continue;
                    }
                    let what = format!("lying, r {r:e}, a {a:e}, z_r {:e}", dipole.z[0]);
                    // The promised 1e-7; clamped arcs of a tiny disc far away lose digits to cos φ = 1.
                    assert_rel(disc_average(&dipole, r, a).0, reference, 1e-7, &what);
                }
            }
        }
    }

    /// The facing disc by quadrature over its rings, which the closed form must match; a radius 1 % off must not.
    #[test]
    fn facing_disc_matches_quadrature() {
        for dipole in media() {
            for (r, a) in [(0.0f64, 1.0), (1.0, 0.3), (2.0, 5.0), (9.0, 0.01)] {
                let ring = |rho: f64| dipole.reflectance(r.hypot(rho)) * 2.0 * rho / (a * a);
                let reference = integrate(ring, 0.0, a, 1e-11);
                assert_rel(disc_average(&dipole, r, a).1, reference, 1e-8, "facing");
            }
            let off = disc_average(&dipole, 2.0, 5.05).1 / disc_average(&dipole, 2.0, 5.0).1;
            assert!((off - 1.0).abs() > 1e-3, "{off}");
        }
    }

    #[test]
    fn limits_of_the_disc() {
        for dipole in media() {
            for r in [0.0, 0.1, 1.0, 10.0] {
                for a in [0.0, 1e-200, 1e-9] {
                    let (lying, facing) = disc_average(&dipole, r, a);
                    assert_rel(lying, dipole.reflectance(r), 1e-12, "point, lying");
                    assert_rel(facing, dipole.reflectance(r), 1e-12, "point, facing");
                }
            }
            for a in [1e-3, 0.1, 1.0, 1e3] {
                let (lying, facing) = disc_average(&dipole, 0.0, a);
                let exact = dipole.enclosed(a) / (PI * a * a);
                assert_rel(lying, exact, 1e-9, "centre, lying");
                assert_rel(facing, exact, 1e-12, "centre, facing");
                assert_rel(
                    disc_average(&dipole, a, a).0,
                    disc_average(&dipole, a * (1.0 + 1e-12), a).0,
                    1e-7,
                    "rim",
                );
            }
        }
        assert_eq!(disc_average(&Dipole::new(0.0, 1.0, 1.3), 1.0, 1.0), (0.0, 0.0));
    }

    /// Moving a lying disc over the whole plane collects the profile's total, whatever its size.
    #[test]
    fn lying_average_keeps_the_energy() {
        for dipole in [Dipole::new(1.01, 0.48, 1.3), Dipole::new(0.3, 0.9, 1.0)] {
            for a in [0.1, 1.0, 5.0] {
                let far = a + 40.0 / dipole.sigma_tr;
                let collected = |gain: f64| {
                    let ring = |r: f64| disc_average(&dipole, r, gain * a).0 * 2.0 * PI * r;
                    integrate_panels(ring, &[0.0, 0.5 * a, a, 2.0 * a, far], 1e-7)
                };
                // The quadrature's tolerance; beyond `far` e^-40 is left.
                assert_rel(collected(1.0), dipole.total(), 1e-6, "energy");
            }
        }
    }

    /// Above its source a receiver sees the disc face on, beside it edge on, at 45° half of each.
    #[test]
    fn the_normal_decides_how_the_disc_lies() {
        let dipoles = MARBLE.dipoles();
        let normal = [0.0, 1.0, 0.0];
        let source = Source { position: [1.0, 2.0, 3.0], normal, area: PI, irradiance: [1.0; 3] };
        let (lying, facing) = disc_average(&dipoles[0], 1.5, NEIGHBOUR_NARROWING);
        assert!((lying / facing - 1.0).abs() > 0.05, "the two must differ for this test to mean anything");
        let seen = |offset: DVec3| averaged_kernel(&dipoles, DVec3::new(1.0, 2.0, 3.0) + offset, &source)[0];
        assert_rel(seen(DVec3::new(0.0, 1.5, 0.0)), facing, 1e-12, "above");
        assert_rel(seen(DVec3::new(0.0, -1.5, 0.0)), facing, 1e-12, "below");
        assert_rel(seen(DVec3::new(1.5, 0.0, 0.0)), lying, 1e-12, "beside");
        let diagonal = 1.5 * std::f64::consts::FRAC_1_SQRT_2;
        assert_rel(seen(DVec3::new(diagonal, diagonal, 0.0)), 0.5 * (lying + facing), 1e-12, "diagonal");
    }

    /// Points spread evenly on a sphere (a Fibonacci lattice), each with its share of the area and unit irradiance.
    fn sphere_texels(radius: f64, count: u32) -> Vec<Source> {
        let golden = PI * (3.0 - 5.0f64.sqrt());
        let texel = |k: u32| {
            let y = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(count);
            let (sin, angle) = ((1.0 - y * y).sqrt(), golden * f64::from(k));
            let normal = [sin * angle.cos(), y, sin * angle.sin()];
            Source {
                position: normal.map(|x| x * radius),
                normal,
                area: 4.0 * PI * radius * radius / f64::from(count),
                irradiance: [1.0; 3],
            }
        };
        (0..count).map(texel).collect()
    }

    #[test]
    fn evenly_lit_sphere_by_all_pairs() {
        let dipoles = MARBLE.dipoles();
        let mut texels = sphere_texels(10.0, 8000);
        let receivers: Vec<usize> = (700..8000).step_by(700).collect();
        let error = |texels: &[Source]| {
            let exitances = all_pairs(texels, &dipoles, &receivers);
            let errors = exitances
                .iter()
                .flat_map(|b| (0..3).map(|k| (b[k] / sphere_exitance(&dipoles[k], 10.0) - 1.0).abs()));
            errors.fold(0.0, f64::max)
        };
        // Discs of the texels' area overlap and leave gaps: measured 0.07 % with texels of 0.4 mm at z_r = 0.33 mm
        // (0.003 % with texels of 0.2 mm). The lattice's poles, where texels are uneven, are left out.
        let measured = error(&texels);
        assert!(measured < 2e-3, "{measured}");
        texels.iter_mut().for_each(|texel| texel.area *= 1.01);
        assert!(error(&texels) > 2e-3, "1 % too much area must be noticed");
    }

    #[test]
    fn dark_and_coincident_texels_stay_finite() {
        let dipoles = MARBLE.dipoles();
        let mut texels = sphere_texels(1.0, 50);
        texels[1] = texels[0];
        texels[2].area = 0.0;
        texels[3].normal = [0.0; 3];
        let exitances = all_pairs(&texels, &dipoles, &[0, 1, 2, 3]);
        assert!(exitances.iter().flatten().all(|b| b.is_finite() && *b > 0.0));
        assert_eq!(exitances[0], exitances[1]);
        texels.iter_mut().for_each(|texel| texel.irradiance = [0.0; 3]);
        assert_eq!(all_pairs(&texels, &dipoles, &[5]), [[0.0; 3]]);
    }
}
