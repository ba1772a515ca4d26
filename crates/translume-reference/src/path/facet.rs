//! Planes of triangles in single precision: most triangles near a ray need no closer look.

use glam::{DVec3, Vec3};

/// Roundings of a cosine, and of a height in cells: 2⁻²⁴ of some hundred cells, a few times.
const BLUR: f32 = 1e-6;
const FAR: f32 = 1e-3;

/// The plane of a triangle, in a grid's cells.
pub(super) struct Facet {
    /// Unit normal, outwards.
    normal: Vec3,
    /// Along it from the grid's lowest corner, in cells.
    height: f32,
}

impl Facet {
    /// Of corners in cells.
    pub fn new([a, b, c]: [DVec3; 3]) -> Self {
        let normal = (b - a).cross(c - a).normalize_or_zero();
        Self { normal: normal.as_vec3(), height: normal.dot(a) as f32 }
    }
}

/// A ray as facets need it, from a place in cells.
pub(super) struct Sight {
    place: Vec3,
    direction: Vec3,
    leaving: bool,
}

impl Sight {
    pub fn new(place: DVec3, direction: DVec3, leaving: bool) -> Self {
        Self { place: place.as_vec3(), direction: direction.as_vec3(), leaving }
    }

    /// Whether the ray crosses a facet's plane the right way within so many cells, as far as single precision can tell.
    #[inline]
    pub fn may_cross(&self, facet: &Facet, reach: f32) -> bool {
        let side = if self.leaving { 1.0 } else { -1.0 };
        let speed = side * facet.normal.dot(self.direction);
        let before = side * (facet.height - facet.normal.dot(self.place));
        speed > -BLUR && before > -FAR && before - speed * reach < FAR
    }
}
