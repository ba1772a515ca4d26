//! A closed mesh as a body.

use std::collections::HashMap;

use glam::DVec3;

use super::fan::{Fan, Vantage};
use super::grid::Grid;
use super::{Crossing, PathError, Shape};
use crate::Surface;
use crate::surface::Ray;

/// A surface whose edges all have a triangle on either side. Light is refracted by the faces, whatever normals the surface is
/// shaded with. Pieces may run through each other, as the spout of a teapot through its wall: what is inside of any is inside.
pub struct Closed<'a> {
    surface: &'a Surface,
    grid: Grid,
    /// Whether there are several pieces, so that not every hit is a boundary of the whole.
    is_composed: bool,
}

impl<'a> Closed<'a> {
    /// Checks a surface and makes its grid.
    ///
    /// # Errors
    /// [`PathError::Open`] counts edges without a counterpart. Vertices of the same position are one.
    pub fn new(surface: &'a Surface) -> Result<Self, PathError> {
        match open_edges(surface) {
            0 if !surface.triangles.is_empty() => {
                Ok(Self { surface, grid: Grid::new(surface), is_composed: pieces(surface) > 1 })
            }
            edges => Err(PathError::Open { edges }),
        }
    }

    /// Calls `found` for the crossings of the whole's boundary along a ray, from near to far, until it returns `false`. Far away a ray is
    /// outside of every piece, which tells how many it begins in.
    fn boundary(&self, origin: DVec3, direction: DVec3, mut found: impl FnMut(Crossing) -> bool) {
        let mut hits = Vec::new();
        self.surface.every_hit(origin.to_array(), direction.to_array(), f64::INFINITY, |hit, normal| {
            hits.push(Crossing { t: hit.t, normal: normal.normalize_or_zero() });
            f64::INFINITY
        });
        hits.sort_by(|a, b| a.t.total_cmp(&b.t));
        let step = |crossing: &Crossing| if crossing.leaves(direction) { -1 } else { 1 };
        let mut depth = -hits.iter().map(step).sum::<i32>();
        for crossing in hits {
            let before = depth;
            depth += step(&crossing);
            if (before > 0) != (depth > 0) && !found(crossing) {
                return;
            }
        }
    }
}

impl Shape for Closed<'_> {
    fn crossings(&self, origin: DVec3, direction: DVec3, found: &mut dyn FnMut(Crossing)) {
        if self.is_composed {
            return self.boundary(origin, direction, |crossing| {
                found(crossing);
                true
            });
        }
        self.surface.every_hit(origin.to_array(), direction.to_array(), f64::INFINITY, |hit, normal| {
            found(Crossing { t: hit.t, normal: normal.normalize_or_zero() });
            f64::INFINITY
        });
    }

    fn fan(&self, vantage: Vantage) -> Option<Fan> {
        if self.is_composed { None } else { Fan::new(self.surface, self.grid.extent, vantage) }
    }

    fn crossings_seen(&self, fan: &Fan, origin: DVec3, direction: DVec3, found: &mut dyn FnMut(Crossing)) {
        let ray = Ray::new(origin, direction);
        for triangle in fan.ahead(origin, direction) {
            let corners @ [a, b, c] = self.surface.corners(triangle);
            if let Some((t, _)) = ray.meets_triangle(corners).filter(|(t, _)| *t >= 0.0) {
                found(Crossing { t, normal: (b - a).cross(c - a).normalize_or_zero() });
            }
        }
    }

    fn first(&self, origin: DVec3, direction: DVec3, leaving: bool, within: f64) -> Option<Crossing> {
        let mut closest: Option<Crossing> = None;
        if self.is_composed {
            self.boundary(origin, direction, |crossing| {
                closest = Some(crossing).filter(|crossing| crossing.leaves(direction) == leaving);
                closest.is_none()
            });
            return closest.filter(|crossing| crossing.t <= within);
        }
        if self.grid.contains(origin) {
            return self.grid.first(self.surface, (origin, direction), leaving, within);
        }
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

/// Sets of triangles that share vertices.
fn pieces(surface: &Surface) -> usize {
    let mut parents: HashMap<[u64; 3], [u64; 3]> = HashMap::new();
    // Adding 0 makes one of the two zeros.
    let key = |vertex: u32| surface.positions[vertex as usize].map(|x| (x + 0.0).to_bits());
    fn root(parents: &mut HashMap<[u64; 3], [u64; 3]>, mut key: [u64; 3]) -> [u64; 3] {
        while let Some(&parent) = parents.get(&key).filter(|&&parent| parent != key) {
            let above = parents.get(&parent).copied().unwrap_or(parent);
            parents.insert(key, above);
            key = above;
        }
        parents.entry(key).or_insert(key);
        key
    }
    for triangle in &surface.triangles {
        let [a, b, c] = triangle.map(|vertex| root(&mut parents, key(vertex)));
        parents.insert(b, a);
        let c = root(&mut parents, c);
        parents.insert(c, a);
    }
    parents.iter().filter(|(key, parent)| key == parent).count()
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
    use super::super::grid::CELLS;
    use super::*;
    use crate::dice::Dice;
    use crate::testing::{octasphere, shell};

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

    /// Two balls that overlap are one body: the wall of either inside of the other is none.
    #[test]
    fn pieces_that_run_through_each_other_are_one() {
        let (mut positions, mut triangles) = octasphere(2.0, 4);
        let (more, others) = octasphere(2.0, 4);
        let count = positions.len() as u32;
        positions.extend(more.iter().map(|[x, y, z]| [x + 2.5, *y, *z]));
        triangles.extend(others.into_iter().map(|t| t.map(|v| v + count)));
        let surface = Surface::flat(positions, triangles);
        let both = Closed::new(&surface).unwrap();
        assert!(both.is_composed);
        let direction = DVec3::X;
        let ends = |x: f64| {
            let mut found = Vec::new();
            both.crossings(DVec3::new(x, 0.11, 0.13), direction, &mut |crossing| found.push(crossing.t + x));
            found
        };
        // Facets lie within 0.6 % of the radius.
        let near = |found: &[f64], wanted: &[f64]| {
            found.len() == wanted.len() && found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 0.03)
        };
        assert!(near(&ends(-5.0), &[-2.0, 4.5]), "{:?}", ends(-5.0));
        for x in [0.0, 1.3, 3.0] {
            assert!(near(&ends(x), &[4.5]), "from {x}: {:?}", ends(x));
            let at = DVec3::new(x, 0.11, 0.13);
            assert!((both.first(at, direction, true, 10.0).unwrap().t + x - 4.5).abs() < 0.03);
            assert!(both.first(at, direction, true, 1.0).is_none() && both.clearance(at) >= 0.0, "{x}");
        }
        let apart = Closed { is_composed: false, ..Closed::new(&surface).unwrap() };
        let mut walls = 0;
        apart.crossings(DVec3::new(-5.0, 0.11, 0.13), direction, &mut |_| walls += 1);
        assert_eq!(walls, 4, "taken one by one there are walls inside");
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
