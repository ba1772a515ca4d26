//! The sum over all pairs at some receivers, as `translume_reference::scatter::all_pairs` has it, but in seconds: discs that are small or far
//! are averaged over a few points.

use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::SQRT_2;
use translume_reference::Dipole;
use translume_reference::gather::Source;
use translume_reference::scatter::{disc_average, own_average};

/// Discs that are larger against the length over which the profile changes are averaged by quadrature. At 0.35 the rules below are within
/// 5·10⁻⁴, and within 6·10⁻⁵ but at the upper end (test `few_points_follow_quadrature`).
const LARGE: f64 = 0.35;
/// Below this, three points are as good.
const SMALL: f64 = 0.1;
/// And below this, one; it is where most pairs are.
const TINY: f64 = 0.01;
/// Light that had to go so many decay lengths counts for nothing: e⁻³⁰ is 10⁻¹³.
const FAINT: f64 = 30.0;
/// A texel looks narrower to others than its own area; as in `translume_reference::scatter`.
const NEIGHBOUR_NARROWING: f64 = 0.945;

/// Exitance at the texels named by `receivers`, from all texels.
pub fn exitance(sources: &[Source], dipoles: &[Dipole; 3], receivers: &[usize]) -> Vec<[f64; 3]> {
    let lit: Vec<(usize, &Source)> =
        sources.iter().enumerate().filter(|(_, source)| source.power() != [0.0; 3]).collect();
    let at = |&receiver: &usize| {
        let place = DVec3::from(sources[receiver].position);
        lit.iter().fold([0.0; 3], |sum, &(index, source)| {
            let offset = place - DVec3::from(source.position);
            let r = offset.length();
            let facing = if r > 0.0 { (offset.dot(source.normal.into()) / r).powi(2) } else { 0.0 };
            let (a, power) = (SQRT_2 * source.spread() * NEIGHBOUR_NARROWING, source.power());
            std::array::from_fn(|k| {
                if index == receiver {
                    return sum[k] + power[k] * own_average(&dipoles[k], source.spread());
                }
                let [lying, upright] = averages(&dipoles[k], r, a, LARGE);
                sum[k] + power[k] * (lying + facing * (upright - lying))
            })
        })
    };
    receivers.par_iter().map(at).collect()
}

/// Means of R_d, 1/mm², over a disc of radius `a` mm whose centre is `r` mm away: lying along the connecting line, and facing it.
fn averages(dipole: &Dipole, r: f64, a: f64, large: f64) -> [f64; 2] {
    let distance = r.hypot(dipole.z[0]);
    if dipole.sigma_tr * (distance - a) > FAINT {
        return [0.0; 2];
    }
    let size = a * (1.0 / distance + dipole.sigma_tr);
    if size > large {
        return disc_average(dipole, r, a).into();
    }
    if size < TINY {
        return [dipole.reflectance(r); 2];
    }
    let beside = |along: f64, across2: f64| {
        let near = r + along;
        dipole.reflectance((near * near + across2).sqrt())
    };
    let a2 = a * a;
    if size < SMALL {
        // Four points at half the area, of degree 3; the two beside the line are as far as the ring that halves a facing disc.
        let (half, ring) = (a / SQRT_2, beside(0.0, 0.5 * a2));
        return [0.25 * (beside(half, 0.0) + beside(-half, 0.0)) + 0.5 * ring, ring];
    }
    // Radon's seven points of degree 5, mirrored; Gauss's two rings.
    let (ring, spread) = ((2.0 * a2 / 3.0).sqrt(), a2 / 12.0_f64.sqrt());
    let outer = beside(ring, 0.0) + beside(-ring, 0.0);
    let sides = beside(0.5 * ring, 0.5 * a2) + beside(-0.5 * ring, 0.5 * a2);
    let lying = 0.25 * beside(0.0, 0.0) + 0.125 * outer + 0.25 * sides;
    let upright = 0.5 * (beside(0.0, 0.5 * a2 + spread) + beside(0.0, 0.5 * a2 - spread));
    [lying, upright]
}

#[cfg(test)]
mod tests {
    use super::*;
    use translume_reference::scatter;

    const DIPOLES: [fn() -> Dipole; 4] = [
        || Dipole::new(0.70, 0.0014, 1.3),
        || Dipole::new(3.00, 0.0071, 1.5),
        || Dipole::new(1.01, 0.48, 1.3),
        || Dipole::new(20.4, 0.0, 1.3),
    ];

    /// Largest error of an average over the mean of R_d there, discs up to this size.
    fn error(large: f64) -> f64 {
        let mut worst = 0.0_f64;
        for dipole in DIPOLES.map(|make| make()) {
            for r in [0.0, 0.1, 0.3, 1.0, 3.0, 10.0].map(|r| r * dipole.z[0]) {
                for a in [0.009, 0.03, 0.1, 0.3, 0.6, 1.0, 2.0].map(|a| a * dipole.z[0]) {
                    let (lying, facing) = disc_average(&dipole, r, a);
                    let [found_lying, found_facing] = averages(&dipole, r, a, large);
                    worst =
                        worst.max((found_lying / lying - 1.0).abs()).max((found_facing / facing - 1.0).abs());
                }
            }
        }
        worst
    }

    #[test]
    fn few_points_follow_quadrature() {
        assert!(error(LARGE) < 5e-4, "{}", error(LARGE));
        assert!(error(1.0) > 5e-4, "larger discs must be noticed: {}", error(1.0));
    }

    #[test]
    fn sums_are_those_of_the_reference() {
        let source = |k: usize| Source {
            position: [0.4 * (k % 8) as f64, 0.1 * (k / 24) as f64, 0.4 * (k / 8) as f64],
            normal: [0.0, 1.0, 0.0],
            area: 0.16,
            irradiance: [(k % 3) as f64, 1.0, 0.5],
        };
        let sources: Vec<Source> = (0..64).map(source).collect();
        let dipoles = [DIPOLES[0](), DIPOLES[2](), DIPOLES[3]()];
        let wanted = scatter::all_pairs(&sources, &dipoles, &[0, 27, 63]);
        let off = |sources: &[Source]| {
            let found = exitance(sources, &dipoles, &[0, 27, 63]);
            let pairs = found.as_flattened().iter().zip(wanted.as_flattened());
            pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max)
        };
        assert!(off(&sources) < 1e-4, "{}", off(&sources));
        let brighter: Vec<_> = sources.iter().map(|s| Source { area: 1.001 * s.area, ..*s }).collect();
        assert!(off(&brighter) > 1e-4, "a thousandth more light must be noticed");
    }
}
