//! A closed mesh as a body.

use std::collections::HashMap;

use glam::DVec3;

use super::grid::Grid;
use super::{Crossing, PathError, Shape};
use crate::Surface;

/// A surface whose edges all have a triangle on either side. Light is refracted by the faces, whatever normals the surface is
/// shaded with.
pub struct Closed<'a> {
    surface: &'a Surface,
    grid: Grid,
}

impl<'a> Closed<'a> {
    /// Checks a surface and makes its grid.
    ///
    /// # Errors
    /// [`PathError::Open`] counts edges without a counterpart. Vertices of the same position are one.
    pub fn new(surface: &'a Surface) -> Result<Self, PathError> {
        match open_edges(surface) {
            0 if !surface.triangles.is_empty() => Ok(Self { surface, grid: Grid::new(surface) }),
            edges => Err(PathError::Open { edges }),
        }
    }
}

impl Shape for Closed<'_> {
    fn crossings(&self, origin: DVec3, direction: DVec3, found: &mut dyn FnMut(Crossing)) {
        self.surface.every_hit(origin.to_array(), direction.to_array(), f64::INFINITY, |hit, normal| {
            found(Crossing { t: hit.t, normal: normal.normalize_or_zero() });
            f64::INFINITY
        });
    }

    fn first(&self, origin: DVec3, direction: DVec3, leaving: bool, within: f64) -> Option<Crossing> {
        let mut closest: Option<Crossing> = None;
        self.surface.every_hit(origin.to_array(), direction.to_array(), within, |hit, normal| {
            if (normal.dot(direction) > 0.0) == leaving {
                closest = Some(Crossing { t: hit.t, normal });
            }
            closest.map_or(within, |crossing| crossing.t)
        });
        closest.map(|crossing| Crossing { normal: crossing.normal.normalize_or_zero(), ..crossing })
    }

    fn clearance(&self, point: DVec3) -> f64 {
        self.grid.clearance(point)
    }

    fn extent(&self) -> [DVec3; 2] {
        self.grid.extent
    }
}

/// Directed edges that no triangle runs along in the other direction as often.
fn open_edges(surface: &Surface) -> usize {
    let mut ids = HashMap::new();
    let mut id = |vertex: u32| {
        // Adding 0 makes one of the two zeros.
        let key = surface.positions[vertex as usize].map(|x| (x + 0.0).to_bits());
        let next = ids.len();
        *ids.entry(key).or_insert(next)
    };
    let mut balance: HashMap<[usize; 2], i64> = HashMap::new();
    for triangle in &surface.triangles {
        let corners = triangle.map(&mut id);
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            if a != b {
                *balance.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
            }
        }
    }
    balance.values().filter(|&&sum| sum != 0).count()
}

#[cfg(test)]
mod tests {
    use super::super::dice::Dice;
    use super::super::grid::CELLS;
    use super::*;
    use crate::testing::octasphere;

    /// A thick shell: a sphere with a hollow one in its middle.
    fn shell() -> Surface {
        let (mut positions, mut triangles) = octasphere(3.0, 4);
        let (more, others) = octasphere(1.0, 4);
        let count = positions.len() as u32;
        positions.extend(more);
        triangles.extend(others.into_iter().map(|[a, b, c]| [a + count, c + count, b + count]));
        Surface::flat(positions, triangles)
    }

    /// The bound is one, is not below a half of the distance by much, and knows the hollow from the body.
    #[test]
    fn clearance_is_a_close_bound_inside_alone() {
        let surface = shell();
        let shell = Closed::new(&surface).unwrap();
        let mut dice = Dice::new([0; 4]);
        let edge = 6.0 / CELLS;
        for _ in 0..20_000 {
            let point = DVec3::new(dice.roll(), dice.roll(), dice.roll()) * 8.0 - 4.0;
            let (r, clearance) = (point.length(), shell.clearance(point));
            let distance = (3.0 - r).min(r - 1.0);
            // Facets lie within 0.6 % of the radius, and cells along them touch boxes around whole triangles, 0.3 wide at most.
            assert!(clearance <= distance.max(0.0), "{point}: {clearance} {distance}");
            let least = distance / 3.0f64.sqrt() - 0.3 - 2.0 * edge;
            assert!(clearance >= least || distance < 0.0, "{point}: {clearance} {distance}");
            assert!(clearance >= 0.0 || distance < 0.02, "{point}: {clearance} {distance}");
            assert!(distance < 1.0 || clearance > 0.0, "the bound must be of use");
        }
        assert!(shell.clearance(DVec3::ZERO) < 0.0, "the hollow is outside");
        let filled = octasphere(3.0, 4);
        let filled = Surface::flat(filled.0, filled.1);
        assert!(Closed::new(&filled).unwrap().clearance(DVec3::ZERO) > 1.5);
    }

    #[test]
    fn crossings_tell_their_side() {
        let surface = shell();
        let shell = Closed::new(&surface).unwrap();
        let (origin, direction) = (DVec3::new(-5.0, 0.11, 0.13), DVec3::X);
        let mut found = Vec::new();
        shell.crossings(origin, direction, &mut |crossing| {
            found.push((crossing.t, crossing.leaves(direction)));
        });
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert_eq!(found.iter().map(|crossing| crossing.1).collect::<Vec<_>>(), [false, true, false, true]);
        for (leaving, expected) in [(false, found[0].0), (true, found[1].0)] {
            assert_eq!(shell.first(origin, direction, leaving, 100.0).unwrap().t, expected);
            assert_eq!(shell.first(origin, direction, leaving, expected - 1e-6), None);
        }
    }
}
