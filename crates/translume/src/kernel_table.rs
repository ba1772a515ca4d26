//! The area-averaged profile K̄(r, s): what a flat disc of rms radius s, seen from distance r, sends per unit of power.
//!
//! A texel or cluster is not a point. Averaging R_d over its disc keeps the sum right from mean free paths far below a texel
//! (the disc around the receiver itself then holds all the energy) to far above. Averages are computed once per medium, in the
//! logarithm so that nothing underflows, for the disc lying along r and for the disc facing r; WGSL blends the two by
//! how far the source reaches along r.

use crate::profile::Channels;
use crate::profile::radial::Radial;
use crate::quadrature::{GAUSS_12, GAUSS_32, integrate};
use std::f64::consts::PI;
use std::sync::Arc;

/// Cells per octave of r² and of s². Linear interpolation of ln K̄ then stays within 0.5 % of quadrature
/// (test `interpolation_follows_quadrature`).
const R2_CELLS_PER_OCTAVE: f64 = 8.0;
const S2_CELLS_PER_OCTAVE: f64 = 4.0;
/// e^−80 ≈ 2·10⁻³⁵ is the least f32 that is safe from underflow when multiplied; it stands for nothing.
const LN_NOTHING: f64 = -80.0;

/// What WGSL needs to find its way in the table. Mirrors `KernelTable` in `shared/kernel_table.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct KernelTableLayout {
    pub least_r2: f32,
    pub least_s2: f32,
    pub columns: u32,
    pub rows: u32,
}

/// The range of lengths a body needs, mm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KernelRange {
    /// Rms radius of the smallest source that matters.
    pub least_spread: f32,
    /// Longest distance across the body.
    pub longest: f32,
}

impl KernelTableLayout {
    pub(crate) fn new(range: KernelRange) -> Self {
        let least_r = range.least_spread / 8.0;
        let cells = |least: f32, per_octave: f64| {
            let octaves = 2.0 * f64::from(range.longest / least).max(1.0).log2();
            (octaves * per_octave).ceil() as u32 + 2
        };
        Self {
            least_r2: (least_r * least_r).max(f32::MIN_POSITIVE),
            least_s2: (range.least_spread * range.least_spread).max(f32::MIN_POSITIVE),
            columns: cells(least_r, R2_CELLS_PER_OCTAVE),
            rows: cells(range.least_spread, S2_CELLS_PER_OCTAVE),
        }
    }

    fn distance(&self, column: f64) -> f64 {
        (f64::from(self.least_r2) * (column / R2_CELLS_PER_OCTAVE).exp2()).sqrt()
    }

    fn disc_radius(&self, row: f64) -> f64 {
        // The rms radius of a disc of radius a is a/√2.
        (2.0 * f64::from(self.least_s2) * (row / S2_CELLS_PER_OCTAVE).exp2()).sqrt()
    }
}

/// One more than `columns` × 2·`rows` texels of ln K̄: the lying half, then the facing half, each behind a column of what texels send to
/// themselves.
pub(crate) fn build(layout: KernelTableLayout, channels: &Channels) -> Vec<[f32; 4]> {
    let mut texels = Vec::with_capacity(((layout.columns + 1) * layout.rows * 2) as usize);
    let alike = |a: usize, b: usize| Arc::ptr_eq(&channels[a], &channels[b]);
    for average in [ln_lying as fn(&dyn Radial, f64, f64) -> f64, ln_facing] {
        for row in 0..layout.rows {
            let radius = layout.disc_radius(row.into());
            let mut push = |ln: &dyn Fn(&dyn Radial) -> f64| {
                let ln = |k: usize| ln(&*channels[k]).max(LN_NOTHING) as f32;
                let red = ln(0);
                let green = if alike(0, 1) { red } else { ln(1) };
                let blue = if alike(1, 2) { green } else { ln(2) };
                texels.push([red, green, blue, 0.0]);
            };
            push(&|profile| ln_own(profile, radius));
            for column in 0..layout.columns {
                let r = layout.distance(column.into());
                push(&|profile| average(profile, r, radius));
            }
        }
    }
    texels
}

/// How much narrower than a disc of its own area a texel looks to any other; as in `shared/cluster.wgsl`.
const NEIGHBOUR_NARROWING: f64 = 0.945;
/// Squares around a square, up to two away: how far they are in sides, and how many are as far.
const AROUND: [(f64, f64); 5] = [
    (1.0, 4.0),
    (std::f64::consts::SQRT_2, 4.0),
    (2.0, 4.0),
    (2.236_067_977_499_79, 8.0),
    (2.828_427_124_746_19, 4.0),
];

/// ln of the mean of R_d over a texel around the receiver itself, whose disc of radius `a` is what the others see: what a plane of squares
/// has to send to the middle of one, less what the discs around it do. Discs overlap and leave gaps; here that is made up for, so that an
/// evenly lit plane closes at any mean free path.
fn ln_own(profile: &dyn Radial, a: f64) -> f64 {
    let side = PI.sqrt() * a / NEIGHBOUR_NARROWING;
    // From the middle of the block to its rim, over an eighth of the way around.
    let block = integrate(&*GAUSS_12, |u| profile.enclosed(2.5 * side / (0.25 * PI * u).cos()));
    let others: f64 = AROUND.iter().map(|(r, count)| count * ln_lying(profile, r * side, a).exp()).sum();
    (block / (side * side) - others).max(0.0).ln()
}

/// ln of the mean of R_d over a disc of radius `a` that lies in the plane of the receiver, its centre at distance `r`.
///
/// In polar coordinates around the receiver: full circles inside the disc in closed form, then arcs of the angle
/// 2·acos((ρ² + r² − a²)/(2ρr)). ρ = max − min·cos(πu³) puts the nodes where R_d falls fastest.
pub(crate) fn ln_lying(profile: &dyn Radial, r: f64, a: f64) -> f64 {
    let (long, short) = (r.max(a), r.min(a));
    let nearest = long - short;
    let arcs = if short == 0.0 {
        0.0
    } else {
        integrate(nodes_for(profile, r, a), |u| {
            let t = PI * u * u * u;
            // 1 − cos t without cancellation.
            let rise = 2.0 * short * (0.5 * t).sin().powi(2);
            let rho = nearest + rise;
            let cosine = ((rho * rho + r * r - a * a) / (2.0 * rho * r)).clamp(-1.0, 1.0);
            let arc = 2.0 * cosine.acos() * rho;
            let falloff = (-profile.decay() * rise).exp();
            profile.scaled_reflectance(rho) * falloff * arc * short * t.sin() * 3.0 * PI * u * u
        })
    };
    if r < a {
        let circles = profile.enclosed(nearest);
        ((circles + arcs * (-profile.decay() * nearest).exp()) / (PI * a * a)).ln()
    } else {
        (arcs / (PI * a * a)).ln() - profile.decay() * nearest
    }
}

/// ln of the mean of R_d over a disc of radius `a` that faces the receiver, its centre at distance `r`: the distances from r to
/// √(r² + a²), each with the same share of the disc, are a ring of the plane.
pub(crate) fn ln_facing(profile: &dyn Radial, r: f64, a: f64) -> f64 {
    (profile.scaled_ring(r, (r * r + a * a).sqrt()) / (PI * a * a)).ln() - profile.decay() * r
}

/// Discs that are small seen from the receiver, and over which R_d hardly falls, need few nodes.
fn nodes_for(profile: &dyn Radial, r: f64, a: f64) -> &'static [(f64, f64)] {
    if a < 0.25 * r && a * profile.decay() < 1.0 { &*GAUSS_12 } else { &*GAUSS_32 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BurleyFit, Medium, Profile};

    fn dipole(medium: &Medium) -> Arc<dyn Radial> {
        Arc::clone(&Profile::Dipole.channels(medium)[0])
    }

    /// Mean over the disc by brute force: a dense polar grid around the disc's centre.
    fn brute_force(dipole: &dyn Radial, r: f64, a: f64, facing: bool) -> f64 {
        let (rings, spokes) = (400, 400);
        let mut sum = 0.0;
        for i in 0..rings {
            let rho = a * ((f64::from(i) + 0.5) / f64::from(rings)).sqrt();
            for k in 0..spokes {
                let angle = PI * (f64::from(k) + 0.5) / f64::from(spokes);
                let d2 =
                    if facing { r * r + rho * rho } else { r * r + rho * rho - 2.0 * r * rho * angle.cos() };
                let d = d2.sqrt();
                sum += dipole.scaled_reflectance(d) * (-dipole.decay() * d).exp();
            }
        }
        sum / f64::from(rings * spokes)
    }

    #[test]
    fn wgsl_knows_the_same_narrowing() {
        let line = format!("const NEIGHBOUR_NARROWING: f32 = {NEIGHBOUR_NARROWING};");
        assert!(translume_shaders::CLUSTER.source.contains(&line));
    }

    /// Far below a texel all of its light comes back to it; far above, it is one of many alike.
    #[test]
    fn a_texel_sends_itself_what_is_left() {
        let dipole = dipole(&Medium::MARBLE);
        let area = |a: f64| PI * (a / NEIGHBOUR_NARROWING).powi(2);
        let coarse = 1e3;
        assert!((ln_own(&*dipole, coarse).exp() * area(coarse) / dipole.total() - 1.0).abs() < 2e-3);
        let fine = 1e-3;
        assert!((ln_own(&*dipole, fine) - dipole.scaled_reflectance(0.0).ln()).abs() < 1e-3);
    }

    #[test]
    fn averages_match_brute_force() {
        for medium in [Medium::SKIMMILK, Medium::MARBLE, Medium::KETCHUP, Medium::SPECTRALON] {
            let dipole = &*dipole(&medium);
            for r in [0.05, 0.3, 1.0, 5.0] {
                for a in [0.01, 0.2, 0.9, 2.0].into_iter().filter(|a| *a < 10.0 * dipole.smooth_length()) {
                    for (ln, facing) in [(ln_lying(dipole, r, a), false), (ln_facing(dipole, r, a), true)] {
                        let expected = brute_force(dipole, r, a, facing);
                        let error = ln.exp() / expected - 1.0;
                        // 0.3 %: the brute-force grid's own error where a narrow peak lies inside the disc.
                        assert!(error.abs() < 3e-3, "{medium:?} r {r} a {a} facing {facing}: {error}");
                    }
                }
            }
        }
    }

    /// Profiles without a bound at r = 0, and those that are sampled. Brute force cannot resolve discs over a peak: they stay beside.
    #[test]
    fn averages_of_other_profiles_match_brute_force() {
        let medium = Medium::SKIN1;
        for profile in [
            Profile::NormalisedDiffusion(BurleyFit::Searchlight),
            Profile::PhotonBeam,
            Profile::named("photon-beam-single").unwrap(),
            Profile::BetterDipole,
        ] {
            let channels = profile.channels(&medium);
            for (r, a) in [(0.1, 0.05), (0.5, 0.4), (1.0, 0.1), (3.0, 2.0), (9.0, 1.0)] {
                for (ln, facing) in
                    [(ln_lying(&*channels[1], r, a), false), (ln_facing(&*channels[1], r, a), true)]
                {
                    let expected = brute_force(&*channels[1], r, a, facing);
                    // As above.
                    assert!((ln.exp() / expected - 1.0).abs() < 3e-3, "{profile:?} r {r} a {a} {facing}");
                    let other = brute_force(&*channels[1], 1.01 * r, a, facing);
                    assert!(r < 0.5 || (ln.exp() / other - 1.0).abs() > 3e-3, "{profile:?}: 1 % farther");
                }
            }
        }
    }

    #[test]
    fn a_disc_around_the_receiver_has_a_closed_form() {
        for (_, medium) in Medium::PRESETS {
            let dipole = &*dipole(medium);
            for a in [1e-3, 0.1, 10.0, 1e4] {
                let expected = dipole.enclosed(a) / (PI * a * a);
                for ln in [ln_lying(dipole, 0.0, a), ln_facing(dipole, 0.0, a)] {
                    assert!((ln.exp() / expected - 1.0).abs() < 1e-9, "{medium:?} {a}");
                }
            }
        }
    }

    #[test]
    fn a_small_disc_is_a_point() {
        let dipole = &*dipole(&Medium::SKIN1);
        for r in [0.5, 5.0, 50.0] {
            let point = dipole.scaled_reflectance(r).ln() - dipole.decay() * r;
            for ln in [ln_lying(dipole, r, 1e-3 * r), ln_facing(dipole, r, 1e-3 * r)] {
                assert!((ln - point).abs() < 1e-4, "r {r}: {ln} against {point}");
            }
        }
    }

    #[test]
    fn opaque_and_clear_media_stay_finite() {
        for scale in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
            let medium = Medium { sigma_s_prime: [scale; 3], sigma_a: [0.1 * scale; 3], ior: 1.3, g: 0.0 };
            let layout = KernelTableLayout::new(KernelRange { least_spread: 1e-3, longest: 1e3 });
            let channels = Profile::Dipole.channels(&medium);
            for texel in build(layout, &channels) {
                assert!(texel.iter().all(|v| v.is_finite() && *v >= LN_NOTHING as f32), "{scale}: {texel:?}");
            }
        }
    }

    /// Largest error of bilinear interpolation against quadrature in the middle of cells, where ln K̄ is `shift` off.
    fn interpolation_error(layout: KernelTableLayout, dipole: &Arc<dyn Radial>, shift: f64) -> f64 {
        let table = build(layout, &[(); 3].map(|()| Arc::clone(dipole)));
        let dipole = &**dipole;
        let at =
            |row: u32, column: u32| f64::from(table[(row * (layout.columns + 1) + column + 1) as usize][0]);
        let mut worst = 0.0_f64;
        for row in 0..layout.rows - 1 {
            for column in 0..layout.columns - 1 {
                let r = layout.distance(f64::from(column) + 0.5);
                let a = layout.disc_radius(f64::from(row) + 0.5);
                let exact = ln_lying(dipole, r, a);
                // Where a disc's rim passes over the receiver no smooth table follows, and where light dies out across a disc its
                // mean says little: the tree opens such clusters.
                if exact > -30.0 && !(0.4..2.0).contains(&(r / a)) && dipole.decay() * a < 1.0 {
                    let corners =
                        at(row, column) + at(row, column + 1) + at(row + 1, column) + at(row + 1, column + 1);
                    worst = worst.max((0.25 * corners + shift - exact).abs());
                }
            }
        }
        worst
    }

    #[test]
    fn interpolation_follows_quadrature() {
        let layout = KernelTableLayout::new(KernelRange { least_spread: 0.1, longest: 100.0 });
        for medium in [Medium::SKIMMILK, Medium::MARBLE, Medium::SKIN1] {
            let error = interpolation_error(layout, &dipole(&medium), 0.0);
            assert!(error < 5e-3, "{medium:?}: {error}");
        }
        assert!(
            interpolation_error(layout, &dipole(&Medium::MARBLE), 0.01) > 5e-3,
            "a shifted table must be noticed"
        );
    }
}
