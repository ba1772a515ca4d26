//! How well a mesh is laid.

use glam::DVec3;

use crate::mesh::Mesh;

/// Figures of merit of a laid mesh, measured on its stored f32 positions.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct SphericalReport {
    /// Holes that were filled before.
    pub holes_filled: usize,
    /// Triangles that face the egg's middle when laid, or have no area there: always 0.
    pub flipped: usize,
    /// Other triangles that lean away from the egg's own normal by 90° or more: 0 but for meshes so coarse (some dozens of
    /// triangles) that they hardly follow its curvature.
    pub leaning: usize,
    /// 1st, 50th and 99th percentile, by rest area, of a triangle's laid area over its rest area, over the same ratio of
    /// the whole mesh: 1 is as even as at rest.
    pub area_ratio: [f64; 3],
    /// The smallest laid triangle's area over the mean.
    pub least_area: f64,
    /// The smallest angle of a laid triangle, degrees.
    pub least_angle: f64,
    /// Wall time, s.
    pub seconds: f64,
}

impl SphericalReport {
    /// Measures `laid`, the positions of a mesh's vertices on an egg, model units.
    pub(super) fn measure(mesh: &Mesh, laid: &[[f32; 3]]) -> Self {
        let rest = mesh.triangles.iter().map(|&t| area(corners(&mesh.positions, t))).collect::<Vec<_>>();
        let egg = mesh.triangles.iter().map(|&t| area(corners(laid, t))).collect::<Vec<_>>();
        let (rest_total, egg_total) = (rest.iter().sum::<f64>(), egg.iter().sum::<f64>());
        let mut ratios = rest.iter().zip(&egg).map(|(&r, &e)| (e / r, r)).collect::<Vec<_>>();
        ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
        let ratio = |share| percentile(&ratios, share * rest_total) * rest_total / egg_total;
        let angles = mesh.triangles.iter().map(|&t| least_angle(corners(laid, t)));
        Self {
            area_ratio: [0.01, 0.5, 0.99].map(ratio),
            least_area: egg.iter().copied().fold(f64::MAX, f64::min) * egg.len() as f64 / egg_total,
            least_angle: angles.fold(180.0, f64::min),
            ..Self::default()
        }
    }
}

pub(super) fn corners(positions: &[[f32; 3]], triangle: [u32; 3]) -> [DVec3; 3] {
    triangle.map(|v| DVec3::from(positions[v as usize].map(f64::from)))
}

fn area([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).length() / 2.0
}

fn least_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let angle = |at: DVec3, p: DVec3, q: DVec3| (p - at).angle_between(q - at);
    angle(a, b, c).min(angle(b, c, a)).min(angle(c, a, b)).to_degrees()
}

/// The value below which entries of this weight lie; entries are (value, weight), ascending.
fn percentile(entries: &[(f64, f64)], weight: f64) -> f64 {
    let mut sum = 0.0;
    let reached = entries.iter().find(|entry| {
        sum += entry.1;
        sum >= weight
    });
    reached.or(entries.last()).map_or(0.0, |entry| entry.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_go_by_weight() {
        let entries = [(1.0, 1.0), (2.0, 8.0), (3.0, 1.0)];
        assert_eq!(
            [0.5, 1.0, 1.5, 9.0, 9.5, 11.0].map(|w| percentile(&entries, w)),
            [1.0, 1.0, 2.0, 2.0, 3.0, 3.0]
        );
        assert_eq!(percentile(&[], 1.0), 0.0);
    }

    #[test]
    fn angles_are_those_of_a_set_square() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::new(0.0, 3f64.sqrt(), 0.0)];
        assert!((least_angle(corners) - 30.0).abs() < 1e-12);
    }
}
