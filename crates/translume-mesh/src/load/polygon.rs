//! Cuts the polygons of a file into triangles.

use earcut::Earcut;
use glam::DVec3;

/// Ears are found in a time that grows with the square of the corners; for so many about 0.2 s.
pub(super) const MAX_CORNERS: usize = 1 << 14;

/// Height of a triangle over its longest edge, as a share of that edge, below which it counts as flat: ten times the rounding
/// of positions.
const FLAT: f64 = 1e-6;

/// Area that the ears may miss, as a share of the polygon's: far above the rounding of sums in f64.
const DEVIATION: f64 = 1e-9;

/// A polygon that is no fan has more than [`MAX_CORNERS`].
#[derive(Debug)]
pub(super) struct TooManyCorners;

/// Cuts one polygon after the other.
pub(super) struct Cutter {
    earcut: Earcut<f64>,
    /// The polygon, from its first corner.
    arms: Vec<DVec3>,
    plane: Vec<[f64; 2]>,
    ears: Vec<u32>,
}

impl Cutter {
    pub fn new() -> Self {
        Self { earcut: Earcut::new(), arms: Vec::new(), plane: Vec::new(), ears: Vec::new() }
    }

    /// Appends the triangles of a polygon, as places in it and in its winding; none for fewer than three corners.
    ///
    /// Where the fan around the first corner lies inside, as in every convex polygon, it is that fan. Else ears are clipped
    /// in the coordinate plane across which the polygon's area is largest. Where they do not add up to that area the polygon
    /// crosses itself or is far from flat, and no choice is better than the fan.
    pub fn cut(
        &mut self,
        points: impl IntoIterator<Item = [f32; 3]>,
        triangles: &mut Vec<[u32; 3]>,
    ) -> Result<(), TooManyCorners> {
        self.arms.clear();
        self.arms.extend(points.into_iter().map(|p| DVec3::from(p.map(f64::from))));
        let fan = (2..self.arms.len() as u32).map(|k| [0, k - 1, k]);
        let Some(&first) = self.arms.first().filter(|_| fan.len() > 1) else {
            triangles.extend(fan);
            return Ok(());
        };
        self.arms.iter_mut().for_each(|arm| *arm -= first);
        // Twice the vector area: normal times area of a flat polygon (Newell).
        let area: DVec3 = self.arms.windows(2).map(|pair| pair[0].cross(pair[1])).sum();
        let normal = area.normalize_or_zero();
        if normal == DVec3::ZERO || self.opens_as_fan(normal) {
            triangles.extend(fan);
            return Ok(());
        }
        if self.arms.len() > MAX_CORNERS {
            return Err(TooManyCorners);
        }
        self.project(normal);
        self.earcut.earcut_slice(&self.plane, &[], &mut self.ears);
        if earcut::deviation(self.plane.iter().copied(), &[], &self.ears) < DEVIATION {
            triangles.extend(self.ears.chunks_exact(3).map(|ear| [ear[0], ear[1], ear[2]]));
        } else {
            triangles.extend(fan);
        }
        Ok(())
    }

    fn opens_as_fan(&self, normal: DVec3) -> bool {
        self.arms[1..].windows(2).all(|pair| {
            let [a, b] = [pair[0], pair[1]];
            let longest = a.length_squared().max(b.length_squared()).max(a.distance_squared(b));
            a.cross(b).dot(normal) > FLAT * longest
        })
    }

    /// Drops the coordinate along which the normal is longest, which rounds nothing; the polygon stays counter-clockwise.
    fn project(&mut self, normal: DVec3) {
        let axis = normal.abs().max_position();
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let (u, v) = if normal[axis] > 0.0 { (u, v) } else { (v, u) };
        self.plane.clear();
        self.plane.extend(self.arms.iter().map(|arm| [arm[u], arm[v]]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(points: &[[f32; 3]]) -> Vec<[u32; 3]> {
        let mut triangles = Vec::new();
        Cutter::new().cut(points.iter().copied(), &mut triangles).unwrap();
        triangles
    }

    /// Sum of the triangles' areas, and how many of them face away from the z axis or have no area.
    fn measure(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> (f64, usize) {
        let areas: Vec<f64> = triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|k| DVec3::from(points[k as usize].map(f64::from)));
                (b - a).cross(c - a).z / 2.0
            })
            .collect();
        (areas.iter().map(|a| a.abs()).sum(), areas.iter().filter(|a| **a <= 0.0).count())
    }

    fn flat(corners: &[[f32; 2]]) -> Vec<[f32; 3]> {
        corners.iter().map(|&[x, y]| [x, y, 3.0]).collect()
    }

    const L: [[f32; 2]; 6] = [[2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0], [0.0, 0.0]];

    #[test]
    fn convex_polygons_are_fans() {
        let hexagon: Vec<[f32; 2]> =
            (0..6).map(|k| (k as f32).to_radians() * 60.0).map(|a| [a.cos(), a.sin()]).collect();
        assert_eq!(cut(&flat(&hexagon)), [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]);
        assert_eq!(cut(&flat(&hexagon[..2])), [[0; 3]; 0]);
    }

    #[test]
    fn concave_polygons_keep_their_area_and_side() {
        for turn in 0..L.len() {
            let mut corners = L;
            corners.rotate_left(turn);
            let points = flat(&corners);
            let triangles = cut(&points);
            assert_eq!((triangles.len(), measure(&points, &triangles)), (4, (3.0, 0)), "{turn}");
            let other_side: Vec<_> = points.iter().rev().copied().collect();
            assert_eq!(measure(&other_side, &cut(&other_side)), (3.0, 4), "{turn}");
        }
    }

    /// The fan around this corner of the L folds: the test above would notice.
    #[test]
    fn a_fan_of_the_l_is_too_large() {
        let points = flat(&L);
        let fan: Vec<[u32; 3]> = (2..6).map(|k| [0, k - 1, k]).collect();
        assert!(measure(&points, &fan).0 > 3.0);
    }

    #[test]
    fn points_on_an_edge_are_kept_and_make_no_flat_triangle() {
        let points = flat(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0]]);
        let triangles = cut(&points);
        assert_eq!((triangles.len(), measure(&points, &triangles)), (4, (4.0, 0)));
    }

    /// A square hole in a square, joined to the outside by a cut that is walked twice.
    #[test]
    fn keyholes_stay_open() {
        let points = flat(&[
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 4.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [3.0, 3.0],
            [3.0, 1.0],
            [1.0, 1.0],
        ]);
        assert_eq!(measure(&points, &cut(&points)).0, 12.0);
    }

    #[test]
    fn polygons_without_a_plane_are_fans() {
        let bow_tie = flat(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
        assert_eq!(cut(&bow_tie), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(cut(&[[1.0; 3]; 4]), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn the_largest_polygon_is_cut_and_a_larger_one_refused() {
        let star = |corners: usize| -> Vec<[f32; 3]> {
            let turn = std::f64::consts::TAU / corners as f64;
            let arm = |k: usize| (k as f64 * turn).sin_cos();
            (0..corners)
                .map(|k| (arm(k), if k % 2 == 0 { 1.0 } else { 0.5 }))
                .map(|((y, x), r)| [(r * x) as f32, (r * y) as f32, 0.0])
                .collect()
        };
        assert_eq!(cut(&star(2000)).len(), 1998);
        let mut triangles = Vec::new();
        Cutter::new().cut(star(MAX_CORNERS + 2), &mut triangles).unwrap_err();
        assert!(triangles.is_empty());
    }
}
