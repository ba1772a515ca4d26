//! A closed mesh as a body, with a grid that tells how far away its surface is at least.

use std::collections::HashMap;

use glam::{DVec3, IVec3};

use super::{Crossing, PathError, Shape};
use crate::Surface;

/// Cells along the longest side of the grid.
const CELLS: f64 = 128.0;

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
        self.surface.every_hit(origin.to_array(), direction.to_array(), |hit, normal| {
            found(Crossing { t: hit.t, normal: normal.normalize_or_zero() });
            [0.0, f64::INFINITY]
        });
    }

    fn first(&self, origin: DVec3, direction: DVec3, leaving: bool) -> Option<Crossing> {
        let mut closest: Option<Crossing> = None;
        self.surface.every_hit(origin.to_array(), direction.to_array(), |hit, normal| {
            if (normal.dot(direction) > 0.0) == leaving {
                closest = Some(Crossing { t: hit.t, normal });
            }
            [0.0, closest.map_or(f64::INFINITY, |crossing| crossing.t)]
        });
        closest.map(|crossing| Crossing { normal: crossing.normal.normalize_or_zero(), ..crossing })
    }

    fn clearance(&self, point: DVec3) -> f64 {
        self.grid.clearance(point)
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

/// Cubic cells around the surface. Each tells in how many steps, diagonal ones too, the next cell is reached that the surface may
/// touch: more than 0 inside the body, less outside.
struct Grid {
    low: DVec3,
    edge: f64,
    size: IVec3,
    steps: Vec<i8>,
}

impl Grid {
    fn new(surface: &Surface) -> Self {
        let corners = || surface.positions.iter().map(|&p| DVec3::from(p));
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
        let edge = (high - low).max_element() / CELLS;
        // One cell more on each side stays empty, so that the outside is connected.
        let low = low - 1.5 * edge;
        let size = ((high - low) / edge).as_ivec3() + 3;
        let mut grid = Self { low, edge, size, steps: Vec::new() };
        let mut touched = vec![false; size.element_product() as usize];
        for triangle in 0..surface.triangles.len() as u32 {
            let [a, b, c] = surface.corners(triangle);
            // A hair wider, for the rounding of cell numbers.
            let hair = 1e-9 * edge;
            let first = grid.cell(a.min(b).min(c) - hair);
            let last = grid.cell(a.max(b).max(c) + hair);
            for_each_cell(first, last, |cell| touched[grid.index(cell)] = true);
        }
        grid.steps = grid.distances(&touched);
        grid.tell_sides(surface);
        grid
    }

    fn cell(&self, point: DVec3) -> IVec3 {
        ((point - self.low) / self.edge).floor().as_ivec3()
    }

    fn index(&self, cell: IVec3) -> usize {
        ((cell.z * self.size.y + cell.y) * self.size.x + cell.x) as usize
    }

    fn holds(&self, cell: IVec3) -> bool {
        cell.cmpge(IVec3::ZERO).all() && cell.cmplt(self.size).all()
    }

    fn clearance(&self, point: DVec3) -> f64 {
        let place = (point - self.low) / self.edge;
        let cell = place.floor();
        if !self.holds(cell.as_ivec3()) {
            return -1.0;
        }
        let steps = f64::from(self.steps[self.index(cell.as_ivec3())]);
        if steps <= 0.0 {
            return steps;
        }
        let inset = (place - cell).min(cell + 1.0 - place).min_element();
        (steps - 1.0 + inset) * self.edge
    }

    /// Steps from each cell to a touched one: a pass in the order of the cells and one back, each from half of the neighbours
    /// (Rosenfeld and Pfaltz 1966).
    fn distances(&self, touched: &[bool]) -> Vec<i8> {
        let mut steps: Vec<i8> = touched.iter().map(|&touched| if touched { 0 } else { i8::MAX }).collect();
        let neighbours: Vec<IVec3> =
            (0..13).map(|k| IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)).collect();
        let cells: Vec<IVec3> = self.cells().collect();
        let mut relax = |cell: &IVec3, sign: i32| {
            let near =
                neighbours.iter().map(|offset| *cell + *offset * sign).filter(|&other| self.holds(other));
            let least = near.map(|other| steps[self.index(other)]).min().unwrap_or(i8::MAX);
            let own = &mut steps[self.index(*cell)];
            *own = (*own).min(least.saturating_add(1));
        };
        cells.iter().for_each(|cell| relax(cell, 1));
        cells.iter().rev().for_each(|cell| relax(cell, -1));
        steps
    }

    fn cells(&self) -> impl Iterator<Item = IVec3> + use<> {
        let IVec3 { x, y, z } = self.size;
        (0..z).flat_map(move |k| (0..y).flat_map(move |j| (0..x).map(move |i| IVec3::new(i, j, k))))
    }

    /// Makes the steps of connected cells negative where one of them is outside.
    fn tell_sides(&mut self, surface: &Surface) {
        let mut seen = vec![false; self.steps.len()];
        for start in self.cells() {
            if seen[self.index(start)] || self.steps[self.index(start)] == 0 {
                continue;
            }
            let outside = !contains(surface, self.low + (start.as_dvec3() + 0.5) * self.edge);
            let mut pending = vec![start];
            seen[self.index(start)] = true;
            while let Some(cell) = pending.pop() {
                if outside {
                    let index = self.index(cell);
                    self.steps[index] = -self.steps[index];
                }
                for other in IVec3::AXES.into_iter().flat_map(|axis| [cell + axis, cell - axis]) {
                    if self.holds(other) && !seen[self.index(other)] && self.steps[self.index(other)] != 0 {
                        seen[self.index(other)] = true;
                        pending.push(other);
                    }
                }
            }
        }
    }
}

fn for_each_cell(first: IVec3, last: IVec3, mut each: impl FnMut(IVec3)) {
    for z in first.z..=last.z {
        for y in first.y..=last.y {
            (first.x..=last.x).for_each(|x| each(IVec3::new(x, y, z)));
        }
    }
}

/// Whether rays leave the surface from here more often than they enter it. The direction is one that edges seldom lie along.
fn contains(surface: &Surface, point: DVec3) -> bool {
    let direction = DVec3::new(0.563_1, 0.687_3, 0.458_9).normalize();
    let mut sum = 0;
    surface.every_hit(point.to_array(), direction.to_array(), |_, normal| {
        sum += if normal.dot(direction) > 0.0 { 1 } else { -1 };
        [0.0, f64::INFINITY]
    });
    sum > 0
}
