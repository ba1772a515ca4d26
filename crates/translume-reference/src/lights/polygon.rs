//! Uniform radiance from a polygon, exactly: Lambert's sum over its edges, with Fresnel's transmittance inside.
//!
//! By Stokes, ∫ F_t cos dω over a region is ∮ G dφ around it, φ the azimuth about the normal and G(c) = ∫_c^1 F_t c' dc'.
//! Along an edge, a great circle with unit normal e, dφ = (n·e) dα / (1 − c²) with α the angle along it, so that each edge
//! gives (n·e) ∫ H dα with H = G/(1 − c²). Without Fresnel H is ½ and this is Lambert's formula.

use glam::DVec3;

use crate::Boundary;
use crate::quadrature::{integrate, integrate_panels};

/// ∫ F_t g cos dω over the part of a polygon above the horizon of `normal`, g the gain of entry, sr. Corners are relative to
/// the receiver, in either order.
pub(super) fn polygon_transmittance(boundary: &Boundary, normal: DVec3, corners: &[DVec3]) -> [f64; 3] {
    let above = above_horizon(normal, corners);
    let is_even = *boundary == Boundary::from(1.0);
    let half_mean = |entering: &dyn Fn(f64) -> f64, cos| {
        if is_even { 0.5 } else { mean_above(boundary.ior, entering, cos) }
    };
    boundary.each(|entering| {
        let pairs = above.iter().zip(above.iter().cycle().skip(1));
        pairs.map(|(&from, &to)| edge(&|cos| half_mean(entering, cos), normal, from, to)).sum::<f64>().abs()
    })
}

/// The part of a polygon on the side that `normal` points to (Sutherland and Hodgman 1974).
pub(super) fn above_horizon(normal: DVec3, corners: &[DVec3]) -> Vec<DVec3> {
    let mut above = Vec::with_capacity(corners.len() + 1);
    for (&from, &to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let (low, high) = (normal.dot(from), normal.dot(to));
        if low >= 0.0 {
            above.push(from);
        }
        if (low < 0.0 && high > 0.0) || (low > 0.0 && high < 0.0) {
            above.push(from + (to - from) * (low / (low - high)));
        }
    }
    above
}

fn edge(half_mean: &dyn Fn(f64) -> f64, normal: DVec3, from: DVec3, to: DVec3) -> f64 {
    let across = from.cross(to);
    let size = across.length();
    // An edge through the receiver, or of no length, covers no angle.
    if size == 0.0 {
        return 0.0;
    }
    let (start, along) = (from.normalize(), across.cross(from).normalize());
    let angle = size.atan2(from.dot(to));
    let height = |alpha: f64| normal.dot(start * alpha.cos() + along * alpha.sin()).clamp(0.0, 1.0);
    normal.dot(across) / size * integrate(|alpha| half_mean(height(alpha)), 0.0, angle, 1e-9)
}

/// H(c) = ∫_c^1 F_t g c' dc' / (1 − c²): half the mean share that enters of uniform light from cosines above `cos`.
fn mean_above(eta: f64, entering: &dyn Fn(f64) -> f64, cos: f64) -> f64 {
    // c'² = c² + w² (1 − c²) keeps the integrand smooth at both ends.
    let square = cos * cos;
    let integrand = |w: f64| entering((square + w * w * (1.0 - square)).sqrt()) * w;
    let critical = (1.0 - eta) * (1.0 + eta);
    if critical <= square {
        return integrate(integrand, 0.0, 1.0, 1e-10);
    }
    let onset = ((critical - square) / (1.0 - square)).sqrt();
    integrate_panels(integrand, &[onset, 1.0], 1e-10)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::fresnel::hemispherical_transmittance;
    use crate::testing::assert_rel;

    /// Without a gain.
    fn polygon(eta: f64, normal: DVec3, corners: &[DVec3]) -> f64 {
        polygon_transmittance(&eta.into(), normal, corners)[0]
    }

    /// A regular polygon of many corners around +y, as far as a cone of
    /// half angle `half` reaches.
    fn disc(half: f64, corners: u32) -> Vec<DVec3> {
        let at = |k: u32| {
            let (sin, cos) = (2.0 * PI * f64::from(k) / f64::from(corners)).sin_cos();
            DVec3::new(sin * half.sin(), half.cos(), cos * half.sin())
        };
        (0..corners).map(at).collect()
    }

    #[test]
    fn round_polygon_is_a_cone() {
        for eta in [0.7, 1.0, 1.4] {
            for (tilt, half) in [(0.0f64, 0.6f64), (0.7, 0.6), (1.4, 0.6), (2.0, 0.6)] {
                let normal = DVec3::new(tilt.sin(), tilt.cos(), 0.0);
                let cone = super::super::ambient_transmittance(eta, tilt.cos(), half);
                let round = |half: f64| polygon(eta, normal, &disc(half, 720));
                // The polygon lacks (2π/720)²/6 = 1.3e-5 of the disc, up to four times that where only the rim is above the horizon:
                // measured 4.5e-5.
                assert!(
                    (round(half) - cone).abs() < 6e-5 * cone + 1e-15,
                    "{eta} {tilt}: {} {cone}",
                    round(half)
                );
                assert!(cone == 0.0 || (round(half * 1.001) / cone - 1.0).abs() > 1e-4, "{eta} {tilt}");
            }
        }
    }

    #[test]
    fn whole_hemisphere() {
        for eta in [0.7, 1.0, 1.3] {
            let sky = disc(0.5 * PI, 8);
            let exact = PI * hemispherical_transmittance(eta);
            assert_rel(polygon(eta, DVec3::Y, &sky), exact, 1e-8, "tolerance of the integral");
            let tilted = polygon(eta, DVec3::new(0.8, 0.6, 0.0), &sky);
            assert!(tilted < 0.99 * exact, "part of it is below the horizon");
        }
    }

    #[test]
    fn degenerate_polygons_give_nothing() {
        let normal = DVec3::Y;
        assert_eq!(polygon(1.3, normal, &[]), 0.0);
        assert_eq!(polygon(1.3, normal, &[DVec3::Y; 4]), 0.0);
        let below: Vec<_> = disc(0.6, 4).iter().map(|p| -p).collect();
        assert_eq!(polygon(1.3, normal, &below), 0.0);
        // Seen from one of its own corners it covers a quarter of the directions in its plane and no solid angle.
        let square = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Z, DVec3::Z];
        assert!(polygon(1.3, normal, &square).is_finite());
    }
}
