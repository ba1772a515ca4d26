//! Triangles as they are seen from one place, so that a ray through that place meets a handful.

use glam::{DVec2, DVec3};

use super::lists::Lists;
use crate::Surface;
use crate::lights::strata::frame;

/// Cells for each triangle.
const DENSITY: f64 = 2.0;

/// Entries for each triangle that are not too many; long triangles take fewer cells.
const MOST: usize = 16;

/// Least cosine of the angle between the axis and a corner: 73°.
const NARROW: f64 = 0.3;

/// A hair of a cell, far more than numbers of cells are rounded by.
const HAIR: f64 = 1e-6;

/// What many rays have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Vantage {
    /// They run through a point, mm.
    Point(DVec3),
    /// They run along a unit vector, or against it.
    Direction(DVec3),
}

/// A surface's triangles in the cells of a picture taken from a vantage.
pub struct Fan {
    vantage: Vantage,
    /// Where it stands, mm; 0 of a direction.
    place: DVec3,
    /// Unit vectors to the right, up, and away from the vantage.
    axes: [DVec3; 3],
    low: DVec2,
    /// Cells per unit of the picture.
    scale: DVec2,
    size: [usize; 2],
    entries: Lists<Entry>,
}

/// A triangle in a cell.
#[derive(Clone, Copy, Default)]
struct Entry {
    triangle: u32,
    /// Within which it lies, from the vantage on, mm; rounded apart.
    depths: [f32; 2],
}

impl Fan {
    /// `None` from within a surface, or so close to it that no picture holds it.
    pub(super) fn new(surface: &Surface, [low, high]: [DVec3; 2], vantage: Vantage) -> Option<Self> {
        let (place, forward) = match vantage {
            Vantage::Point(point) => (point, (0.5 * (low + high) - point).normalize_or_zero()),
            Vantage::Direction(direction) => (DVec3::ZERO, direction),
        };
        let basis = frame(forward);
        let axes = [basis.x_axis, basis.y_axis, basis.z_axis];
        let (low, scale, entries) = (DVec2::ZERO, DVec2::ONE, Lists::new(0, |_| {}));
        let mut fan = Self { vantage, place, axes, low, scale, size: [1; 2], entries };
        let corners = || surface.positions.iter().map(|&corner| DVec3::from(corner));
        if !corners().all(|corner| fan.holds(corner)) {
            return None;
        }
        let places = || corners().map(|corner| fan.project(corner));
        let (low, high) =
            (places().fold(DVec2::INFINITY, DVec2::min), places().fold(DVec2::NEG_INFINITY, DVec2::max));
        fan.low = low;
        fan.divide(surface, high);
        fan.entries = Lists::new(fan.size[0] * fan.size[1], |each| fan.for_each_touched(surface, each));
        Some(fan)
    }

    fn holds(&self, corner: DVec3) -> bool {
        match self.vantage {
            Vantage::Point(point) => self.depth(corner) > NARROW * corner.distance(point),
            Vantage::Direction(_) => corner.is_finite(),
        }
    }

    /// Place of a point in the picture.
    fn project(&self, point: DVec3) -> DVec2 {
        match self.vantage {
            Vantage::Point(place) => self.image(point - place),
            Vantage::Direction(_) => DVec2::new(point.dot(self.axes[0]), point.dot(self.axes[1])),
        }
    }

    fn image(&self, offset: DVec3) -> DVec2 {
        DVec2::new(offset.dot(self.axes[0]), offset.dot(self.axes[1])) / offset.dot(self.axes[2])
    }

    /// Chooses cells about square, so many that few triangles share one.
    fn divide(&mut self, surface: &Surface, high: DVec2) {
        let extent = (high - self.low).max(DVec2::splat(f64::MIN_POSITIVE));
        let mut count = DENSITY * surface.triangles.len() as f64;
        loop {
            let edge = (extent.x * extent.y / count).sqrt().max(extent.max_element() / count);
            let sides = (extent / edge).ceil().max(DVec2::ONE);
            self.size = [sides.x as usize, sides.y as usize];
            self.scale = sides / extent;
            let entries: usize = (0..surface.triangles.len() as u32)
                .map(|triangle| {
                    let [first, last] = self.range(surface, triangle);
                    (last[0] - first[0] + 1) * (last[1] - first[1] + 1)
                })
                .sum();
            if entries <= MOST * surface.triangles.len() || count <= 1.0 {
                return;
            }
            count *= 0.5;
        }
    }

    /// Cells that a triangle's rectangle touches: the first and the last.
    fn range(&self, surface: &Surface, triangle: u32) -> [[usize; 2]; 2] {
        let [a, b, c] = surface.corners(triangle).map(|corner| self.cells(self.project(corner)));
        let cell = |place: DVec2| [0, 1].map(|axis| (place[axis].max(0.0) as usize).min(self.size[axis] - 1));
        [cell(a.min(b).min(c) - HAIR), cell(a.max(b).max(c) + HAIR)]
    }

    /// In cells.
    fn cells(&self, image: DVec2) -> DVec2 {
        (image - self.low) * self.scale
    }

    fn entry(&self, surface: &Surface, triangle: u32) -> Entry {
        let [a, b, c] = surface.corners(triangle).map(|corner| self.depth(corner));
        let depths = [(a.min(b).min(c) as f32).next_down(), (a.max(b).max(c) as f32).next_up()];
        Entry { triangle, depths }
    }

    fn depth(&self, point: DVec3) -> f64 {
        (point - self.place).dot(self.axes[2])
    }

    /// Calls `each` for cells that a triangle may reach into.
    fn for_each_touched(&self, surface: &Surface, each: &mut dyn FnMut(usize, Entry)) {
        for triangle in 0..surface.triangles.len() as u32 {
            let ([first, last], entry) = (self.range(surface, triangle), self.entry(surface, triangle));
            let corners = surface.corners(triangle).map(|corner| self.cells(self.project(corner)));
            for row in first[1]..=last[1] {
                for column in first[0]..=last[0] {
                    if touches(corners, DVec2::new(column as f64, row as f64) + 0.5) {
                        each(row * self.size[0] + column, entry);
                    }
                }
            }
        }
    }

    /// All triangles that a ray of the vantage may meet.
    pub(super) fn ahead(&self, origin: DVec3, direction: DVec3) -> impl Iterator<Item = u32> {
        let depth = self.depth(origin) as f32;
        let recedes = direction.dot(self.axes[2]) > 0.0;
        let is_ahead = move |entry: &&Entry| {
            if recedes { entry.depths[1] >= depth } else { entry.depths[0] <= depth }
        };
        self.seen(origin, direction).iter().filter(is_ahead).map(|entry| entry.triangle)
    }

    fn seen(&self, origin: DVec3, direction: DVec3) -> &[Entry] {
        let image = match self.vantage {
            Vantage::Point(_) => self.image(direction),
            Vantage::Direction(_) => self.project(origin),
        };
        let place = self.cells(image);
        let size = DVec2::new(self.size[0] as f64, self.size[1] as f64);
        if !(place.cmpge(DVec2::splat(-HAIR)).all() && place.cmple(size + HAIR).all()) {
            return &[];
        }
        let cell = place.clamp(DVec2::ZERO, size - 1.0);
        let cell = cell.y as usize * self.size[0] + cell.x as usize;
        self.entries.of(cell)
    }
}

/// Whether no edge of a triangle has all of a cell, and a hair more, on its far side.
fn touches([a, b, c]: [DVec2; 3], middle: DVec2) -> bool {
    let turn = (b - a).perp_dot(c - a);
    [[a, b], [b, c], [c, a]].into_iter().all(|[from, to]| {
        let edge = to - from;
        let reach = (0.5 + HAIR) * edge.abs().element_sum();
        edge.perp_dot(middle - from) * turn.signum() >= -reach
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dice::Dice;
    use crate::surface::Ray;
    use crate::testing::shell;

    const EXTENT: [DVec3; 2] = [DVec3::splat(-3.0), DVec3::splat(3.0)];

    const VANTAGES: [Vantage; 3] = [
        Vantage::Point(DVec3::new(1.0, 9.0, -4.0)),
        Vantage::Point(DVec3::new(0.2, -0.1, 3.7)),
        Vantage::Direction(DVec3::new(0.48, 0.6, -0.64)),
    ];

    fn random(dice: &mut Dice) -> DVec3 {
        DVec3::new(dice.roll(), dice.roll(), dice.roll()) * 7.0 - 3.5
    }

    /// Through a corner, the middle of an edge, a point of a triangle, or any point around.
    fn target(surface: &Surface, dice: &mut Dice) -> DVec3 {
        let triangle = (dice.roll() * surface.triangles.len() as f64) as u32;
        let weights = [[0.0, 0.0], [0.5, 0.0], [0.3, 0.3]];
        match weights.get((dice.roll() * 4.0) as usize) {
            Some(weights) => surface.point(triangle, *weights).into(),
            None => random(dice),
        }
    }

    /// To the vantage or from it.
    fn ray(vantage: Vantage, target: DVec3, dice: &mut Dice) -> [DVec3; 2] {
        match vantage {
            Vantage::Point(point) if dice.roll() < 0.5 => [point, (target - point).normalize()],
            Vantage::Point(point) => {
                let direction = (point - target).normalize();
                [target - direction * dice.roll(), direction]
            }
            Vantage::Direction(direction) => [target - direction * 7.0 * dice.roll(), direction],
        }
    }

    /// Rays whose crossings by the fan are not those by the tree, and crossings in all.
    fn differing(surface: &Surface, fan: &Fan) -> [usize; 2] {
        let mut dice = Dice::new([5; 4]);
        let (mut differing, mut count) = (0, 0);
        for _ in 0..4000 {
            let target = target(surface, &mut dice);
            let [origin, direction] = ray(fan.vantage, target, &mut dice);
            let mut tree = Vec::new();
            surface.every_hit(origin.to_array(), direction.to_array(), f64::INFINITY, |hit, _| {
                tree.push((hit.triangle, hit.t));
                f64::INFINITY
            });
            let prepared = Ray::new(origin, direction);
            let meets =
                |triangle: u32| Some((triangle, prepared.meets_triangle(surface.corners(triangle))?.0));
            let mut found: Vec<_> = fan.ahead(origin, direction).filter_map(meets).collect();
            found.retain(|hit| hit.1 >= 0.0);
            tree.sort_by_key(|hit| hit.0);
            found.sort_by_key(|hit| hit.0);
            differing += usize::from(tree != found);
            count += tree.len();
        }
        [differing, count]
    }

    /// To the last bit, also along edges and through corners.
    #[test]
    fn crossings_are_those_of_the_tree() {
        let surface = shell();
        for vantage in VANTAGES {
            let mut fan = Fan::new(&surface, EXTENT, vantage).unwrap();
            let [differing_rays, count] = differing(&surface, &fan);
            assert!(differing_rays == 0 && count > 5000, "{vantage:?}: {differing_rays} {count}");
            let longest = fan.entries.cells().map(|cell| fan.entries.of(cell).len()).max().unwrap();
            // Measured 34 to 44, along the rim.
            assert!(longest < 60, "{longest}: a handful of 4,096");
            fan.entries.damage(Entry::default());
            assert!(differing(&surface, &fan)[0] > 0, "damage must be noticed");
        }
    }

    #[test]
    fn none_from_within_or_too_near() {
        let surface = shell();
        for place in [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(3.05, 0.0, 0.0)] {
            assert!(Fan::new(&surface, EXTENT, Vantage::Point(place)).is_none(), "{place}");
        }
    }

    /// A body without width in the picture takes few cells all the same.
    #[test]
    fn flat_and_long_triangles_take_few_cells() {
        let needles = (0..100).flat_map(|k| {
            let x = f64::from(k);
            [[x, 0.0, 0.0], [x + 200.0, 200.0, 0.0], [x + 0.1, 0.0, 0.0]]
        });
        let triangles = (0..100).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let surface = Surface::flat(needles.collect(), triangles);
        let extent = [DVec3::ZERO, DVec3::new(300.0, 200.0, 0.0)];
        for direction in [DVec3::Z, DVec3::X, DVec3::Y] {
            let fan = Fan::new(&surface, extent, Vantage::Direction(direction)).unwrap();
            assert!(fan.entries.cells().len() < 1500 && fan.entries.len() <= MOST * 100, "{:?}", fan.size);
        }
    }
}
