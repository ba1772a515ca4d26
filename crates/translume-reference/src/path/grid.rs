//! Cells around a mesh that tell how far away its surface is at least.

use glam::{DVec3, IVec3};

use super::Crossing;
use super::facet::{Facet, Sight};
use super::lists::Lists;
use crate::Surface;
use crate::surface::Ray;

/// Cells along the longest side of the grid.
pub(super) const CELLS: f64 = 128.0;

/// Cubic cells around the surface. Each tells in how many steps, diagonal ones too, the next cell is reached that the surface may
/// touch: more than 0 inside the body, less outside.
pub(super) struct Grid {
    /// Lowest and highest coordinates of the surface.
    pub extent: [DVec3; 2],
    low: DVec3,
    edge: f64,
    /// Cells per mm.
    scale: f64,
    size: IVec3,
    /// Cells are kept in blocks of 4³, so many along each side, as who asks for one soon asks for its neighbours.
    blocks: IVec3,
    /// The size as a place.
    end: DVec3,
    steps: Vec<i8>,
    /// Which triangles touch each cell.
    triangles: Lists<u32>,
    /// Of every triangle.
    facets: Vec<Facet>,
}

/// A hair of a cell's edge, far more than numbers of cells are rounded by: cells hold what is so near.
const HAIR: f64 = 1e-6;

impl Grid {
    pub fn new(surface: &Surface) -> Self {
        let extent @ [low, high] = extent(surface);
        let edge = (high - low).max_element() / CELLS;
        // One cell more on each side stays empty, so that the outside is connected.
        let low = low - 1.5 * edge;
        let size = ((high - low) / edge).as_ivec3() + 3;
        let (steps, triangles, facets) = (Vec::new(), Lists::new(0, |_| {}), Vec::new());
        let (scale, end, blocks) = (1.0 / edge, size.as_dvec3(), (size + 3) / 4);
        let count = 64 * blocks.element_product() as usize;
        let mut grid = Self { extent, low, edge, scale, size, blocks, end, steps, triangles, facets };
        grid.triangles = Lists::new(count, |each| grid.for_each_touched(surface, each));
        let facet = |triangle| Facet::new(surface.corners(triangle).map(|corner| grid.place(corner)));
        grid.facets = (0..surface.triangles.len() as u32).map(facet).collect();
        grid.steps = grid.distances();
        grid.tell_sides(surface);
        grid
    }

    /// Calls `each` for cells that a triangle's box and its plane pass through.
    fn for_each_touched(&self, surface: &Surface, each: &mut dyn FnMut(usize, u32)) {
        let hair = HAIR * self.edge;
        for triangle in 0..surface.triangles.len() as u32 {
            let [a, b, c] = surface.corners(triangle);
            let normal = (b - a).cross(c - a);
            let reach = normal.abs().element_sum() * (0.5 * self.edge + hair);
            let first = self.cell(a.min(b).min(c) - hair);
            let last = self.cell(a.max(b).max(c) + hair);
            for_each_cell(first, last, |cell| {
                if normal.dot(self.middle(cell) - a).abs() <= reach {
                    each(self.index(cell), triangle);
                }
            });
        }
    }

    fn middle(&self, cell: IVec3) -> DVec3 {
        self.low + (cell.as_dvec3() + 0.5) * self.edge
    }

    fn cell(&self, point: DVec3) -> IVec3 {
        self.place(point).floor().as_ivec3()
    }

    fn index(&self, cell: IVec3) -> usize {
        let (block, within): (IVec3, IVec3) = (cell >> 2, cell & 3);
        let IVec3 { x, y, z } = within;
        let block = (block.z * self.blocks.y + block.y) * self.blocks.x + block.x;
        (block << 6 | z << 4 | y << 2 | x) as usize
    }

    fn holds(&self, cell: IVec3) -> bool {
        cell.cmpge(IVec3::ZERO).all() && cell.cmplt(self.size).all()
    }

    /// In cells.
    fn place(&self, point: DVec3) -> DVec3 {
        (point - self.low) * self.scale
    }

    /// The cell of a place; `None` beside the grid.
    #[inline]
    fn cell_at(&self, place: DVec3) -> Option<IVec3> {
        // Where nothing is negative, rounding towards zero is rounding down.
        let is_inside = place.cmpge(DVec3::ZERO).all() && place.cmplt(self.end).all();
        is_inside.then(|| IVec3::new(place.x as i32, place.y as i32, place.z as i32))
    }

    pub fn contains(&self, point: DVec3) -> bool {
        self.cell_at(self.place(point)).is_some()
    }

    /// As that of the body.
    pub fn clearance(&self, point: DVec3) -> f64 {
        let place = self.place(point);
        let Some(cell) = self.cell_at(place) else {
            return -1.0;
        };
        let steps = f64::from(self.steps[self.index(cell)]);
        if steps <= 0.0 {
            return steps;
        }
        let inset = place - cell.as_dvec3();
        let inset = inset.min(1.0 - inset).min_element();
        (steps - 1.0 + inset) * self.edge
    }

    /// The first crossing towards the outside (`leaving`) or towards the inside, no further than `within`, from a point that the grid
    /// holds: from cell to cell, and over as many at a time as are not touched.
    pub fn first(
        &self,
        surface: &Surface,
        (origin, direction): (DVec3, DVec3),
        leaving: bool,
        within: f64,
    ) -> Option<Crossing> {
        let mut ray = None;
        let sight = Sight::new(self.place(origin), direction, leaving);
        let (place, step) = (self.place(origin), direction * self.scale);
        let rising = direction.cmpge(DVec3::ZERO);
        let inverse = 1.0 / DVec3::select(step.cmpeq(DVec3::ZERO), DVec3::splat(f64::MIN_POSITIVE), step);
        let (mut closest, mut limit, mut t) = (None, within, 0.0);
        while t <= limit {
            let Some(cell) = self.cell_at(place + step * t) else {
                break;
            };
            let index = self.index(cell);
            let steps = i32::from(self.steps[index]).abs();
            let touching = if steps == 0 { self.triangles.of(index) } else { &[] };
            // Far enough, as the grid is smaller.
            let reach = (limit * self.scale).min(4.0 * CELLS) as f32;
            let may_cross = |triangle: &&u32| sight.may_cross(&self.facets[**triangle as usize], reach);
            for &triangle in touching.iter().filter(may_cross) {
                let corners @ [a, b, c] = surface.corners(triangle);
                // Most rays need none.
                let ray = ray.get_or_insert_with(|| Ray::new(origin, direction));
                let Some((t, _)) = ray.meets_triangle(corners).filter(|(t, _)| (0.0..=limit).contains(t))
                else {
                    continue;
                };
                let normal = (b - a).cross(c - a);
                if (normal.dot(direction) > 0.0) == leaving {
                    (closest, limit) = (Some(Crossing { t, normal }), t);
                }
            }
            // Beyond all cells that are as near as this without being touched.
            let around = (steps - 1).max(0);
            let end = DVec3::select(rising, (cell + 1 + around).as_dvec3(), (cell - around).as_dvec3());
            t = t.max(((end - place) * inverse).min_element()) + 0.1 * HAIR * self.edge;
        }
        closest.map(|crossing| Crossing { normal: crossing.normal.normalize_or_zero(), ..crossing })
    }

    /// Steps from each cell to a touched one: a pass in the order of the cells and one back, each from half of the neighbours
    /// (Rosenfeld and Pfaltz 1966).
    fn distances(&self) -> Vec<i8> {
        let from = |cell| if self.triangles.of(cell).is_empty() { i8::MAX } else { 0 };
        let mut steps: Vec<i8> = self.triangles.cells().map(from).collect();
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
            let outside = !contains(surface, self.middle(start));
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

fn extent(surface: &Surface) -> [DVec3; 2] {
    let corners = || surface.positions.iter().map(|&p| DVec3::from(p));
    [corners().fold(DVec3::INFINITY, DVec3::min), corners().fold(DVec3::NEG_INFINITY, DVec3::max)]
}

/// Whether rays leave the surface from here more often than they enter it. The direction is one that edges seldom lie along.
fn contains(surface: &Surface, point: DVec3) -> bool {
    let direction = DVec3::new(0.563_1, 0.687_3, 0.458_9).normalize();
    let mut sum = 0;
    surface.every_hit(point.to_array(), direction.to_array(), f64::INFINITY, |_, normal| {
        sum += if normal.dot(direction) > 0.0 { 1 } else { -1 };
        f64::INFINITY
    });
    sum > 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dice::Dice;
    use crate::testing::octasphere;

    /// The first crossing by the tree.
    fn by_tree(
        surface: &Surface,
        [origin, direction]: [DVec3; 2],
        leaving: bool,
        within: f64,
    ) -> Option<f64> {
        let mut closest = None;
        surface.every_hit(origin.to_array(), direction.to_array(), within, |hit, normal| {
            if (normal.dot(direction) > 0.0) == leaving {
                closest = Some(hit.t);
            }
            closest.unwrap_or(within)
        });
        closest
    }

    /// Rays whose first crossing from cell to cell is not that by the tree, and those that have one.
    fn differing(surface: &Surface, grid: &Grid) -> [usize; 2] {
        let mut dice = Dice::new([3; 4]);
        let mut random = || DVec3::new(dice.roll(), dice.roll(), dice.roll()) * 6.0 - 3.0;
        let (mut differing, mut count) = (0, 0);
        for k in 0..6000 {
            let origin = random();
            // Through a corner every other time, which six triangles share.
            let corner = DVec3::from(surface.positions[k * 31 % surface.positions.len()]);
            let target = if k % 2 == 0 { corner } else { random() };
            let (direction, leaving) = ((target - origin).normalize(), k % 3 == 0);
            let within = if k % 5 == 0 { f64::INFINITY } else { random().length() };
            let tree = by_tree(surface, [origin, direction], leaving, within);
            let found = grid.first(surface, (origin, direction), leaving, within).map(|crossing| crossing.t);
            differing += usize::from(tree != found);
            count += usize::from(tree.is_some());
        }
        [differing, count]
    }

    /// To the last bit.
    #[test]
    fn first_crossings_are_those_of_the_tree() {
        let (positions, triangles) = octasphere(3.0, 5);
        let surface = Surface::flat(positions, triangles);
        let mut grid = Grid::new(&surface);
        let [differing_rays, count] = differing(&surface, &grid);
        assert!(differing_rays == 0 && count > 1000, "{differing_rays} {count}");
        // Every hundredth triangle another.
        grid.triangles.damage(0);
        assert!(differing(&surface, &grid)[0] > 0, "damage must be noticed");
    }
}
