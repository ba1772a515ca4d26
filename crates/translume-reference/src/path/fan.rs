//! Triangles as they are seen from one place, so that a ray through that place meets a handful.

use glam::{DVec2, DVec3};

use crate::Surface;
use crate::lights::strata::frame;

/// Cells for each triangle.
const DENSITY: f64 = 4.0;

/// Entries for each triangle that are not too many; long triangles take fewer cells.
const MOST: usize = 32;

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
    /// Unit vectors to the right, up, and away from the vantage.
    axes: [DVec3; 3],
    low: DVec2,
    /// Cells per unit of the picture.
    scale: DVec2,
    size: [usize; 2],
    /// Where each cell's triangles begin.
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Fan {
    /// `None` from within a surface, or so close to it that no picture holds it.
    pub(super) fn new(surface: &Surface, [low, high]: [DVec3; 2], vantage: Vantage) -> Option<Self> {
        let forward = match vantage {
            Vantage::Point(point) => (0.5 * (low + high) - point).normalize_or_zero(),
            Vantage::Direction(direction) => direction,
        };
        let basis = frame(forward);
        let axes = [basis.x_axis, basis.y_axis, basis.z_axis];
        let mut fan = Self {
            vantage,
            axes,
            low: DVec2::ZERO,
            scale: DVec2::ONE,
            size: [1; 2],
            starts: Vec::new(),
            triangles: Vec::new(),
        };
        let corners = || surface.positions.iter().map(|&corner| DVec3::from(corner));
        if !corners().all(|corner| fan.holds(corner)) {
            return None;
        }
        let places = || corners().map(|corner| fan.project(corner));
        let (low, high) =
            (places().fold(DVec2::INFINITY, DVec2::min), places().fold(DVec2::NEG_INFINITY, DVec2::max));
        fan.low = low;
        fan.divide(surface, high);
        fan.fill(surface);
        Some(fan)
    }

    fn holds(&self, corner: DVec3) -> bool {
        match self.vantage {
            Vantage::Point(point) => {
                let offset = corner - point;
                offset.dot(self.axes[2]) > NARROW * offset.length()
            }
            Vantage::Direction(_) => corner.is_finite(),
        }
    }

    /// Place of a point in the picture.
    fn project(&self, point: DVec3) -> DVec2 {
        match self.vantage {
            Vantage::Point(vantage) => self.image(point - vantage),
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
        let [a, b, c] = surface.corners(triangle).map(|corner| self.place(self.project(corner)));
        let cell = |place: DVec2| [0, 1].map(|axis| (place[axis].max(0.0) as usize).min(self.size[axis] - 1));
        [cell(a.min(b).min(c) - HAIR), cell(a.max(b).max(c) + HAIR)]
    }

    /// In cells.
    fn place(&self, image: DVec2) -> DVec2 {
        (image - self.low) * self.scale
    }

    fn fill(&mut self, surface: &Surface) {
        let mut counts = vec![0u32; self.size[0] * self.size[1] + 1];
        self.for_each_touched(surface, |cell, _| counts[cell] += 1);
        let mut sum = 0;
        for count in &mut counts {
            sum += *count;
            *count = sum;
        }
        let mut triangles = vec![0; sum as usize];
        // From the end of each cell's list to its start.
        self.for_each_touched(surface, |cell, triangle| {
            counts[cell] -= 1;
            triangles[counts[cell] as usize] = triangle;
        });
        (self.starts, self.triangles) = (counts, triangles);
    }

    /// Calls `each` for cells that a triangle may reach into.
    fn for_each_touched(&self, surface: &Surface, mut each: impl FnMut(usize, u32)) {
        for triangle in 0..surface.triangles.len() as u32 {
            let [first, last] = self.range(surface, triangle);
            let corners = surface.corners(triangle).map(|corner| self.place(self.project(corner)));
            for row in first[1]..=last[1] {
                for column in first[0]..=last[0] {
                    if touches(corners, DVec2::new(column as f64, row as f64) + 0.5) {
                        each(row * self.size[0] + column, triangle);
                    }
                }
            }
        }
    }

    /// All triangles that a ray of the vantage may meet.
    pub(super) fn ahead(&self, origin: DVec3, direction: DVec3) -> &[u32] {
        let image = match self.vantage {
            Vantage::Point(_) => self.image(direction),
            Vantage::Direction(_) => self.project(origin),
        };
        let place = self.place(image);
        let size = DVec2::new(self.size[0] as f64, self.size[1] as f64);
        if !(place.cmpge(DVec2::splat(-HAIR)).all() && place.cmple(size + HAIR).all()) {
            return &[];
        }
        let cell = place.clamp(DVec2::ZERO, size - 1.0);
        let cell = cell.y as usize * self.size[0] + cell.x as usize;
        &self.triangles[self.starts[cell] as usize..self.starts[cell + 1] as usize]
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
