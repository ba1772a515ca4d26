//! Exact conservative raster: every texel square that a triangle overlaps, with the area of the overlap.

use glam::DVec2;

/// Overlaps below this many texel squares are rounding at a shared corner or edge, and cover nothing.
const MIN_OVERLAP: f64 = 1e-9;

/// Triangles below this many texel squares have no usable shape in UV; their surface counts, at their centre.
const MIN_UV_AREA: f64 = 1e-12;

/// What one triangle leaves in one texel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fragment {
    pub triangle: u32,
    /// Overlap of triangle and texel, texel squares.
    pub overlap: f32,
    /// The overlap's share of the whole triangle; a triangle's shares add up to 1.
    pub share: f32,
}

/// The fragments of every pixel, ascending by triangle.
pub(super) struct Fragments {
    offsets: Vec<u32>,
    fragments: Vec<Fragment>,
}

impl Fragments {
    /// Rasterises triangles given in texel units within [0, size]². The result does not depend on the number of threads.
    pub fn new(triangles: &[[DVec2; 3]], size: u32) -> Self {
        let chunks = in_chunks(triangles, |first, chunk| {
            let mut found = Vec::with_capacity(chunk.len() * 4);
            let mut cells = Vec::new();
            for (triangle, corners) in (first..).zip(chunk) {
                rasterise(triangle, corners, size, &mut cells, &mut found);
            }
            found
        });
        let mut offsets = vec![0_u32; (size * size) as usize + 1];
        for &(pixel, _) in chunks.iter().flatten() {
            offsets[pixel as usize + 1] += 1;
        }
        for pixel in 1..offsets.len() {
            offsets[pixel] += offsets[pixel - 1];
        }
        let empty = Fragment { triangle: 0, overlap: 0.0, share: 0.0 };
        let mut fragments = vec![empty; chunks.iter().map(Vec::len).sum()];
        let mut next = offsets.clone();
        for &(pixel, fragment) in chunks.iter().flatten() {
            fragments[next[pixel as usize] as usize] = fragment;
            next[pixel as usize] += 1;
        }
        Self { offsets, fragments }
    }

    /// The fragments of a pixel, row · size + column.
    pub fn at(&self, pixel: usize) -> &[Fragment] {
        &self.fragments[self.offsets[pixel] as usize..self.offsets[pixel + 1] as usize]
    }
}

/// Maps runs of triangles, in parallel where the feature brings threads; results come in order.
fn in_chunks<R: Send>(triangles: &[[DVec2; 3]], map: impl Fn(u32, &[[DVec2; 3]]) -> R + Sync) -> Vec<R> {
    const CHUNK: usize = 1024;
    let one = |(k, chunk): (usize, &[[DVec2; 3]])| map((k * CHUNK) as u32, chunk);
    #[cfg(feature = "unwrap")]
    {
        use rayon::prelude::*;
        triangles.par_chunks(CHUNK).enumerate().map(one).collect()
    }
    #[cfg(not(feature = "unwrap"))]
    triangles.chunks(CHUNK).enumerate().map(one).collect()
}

fn rasterise(
    triangle: u32,
    corners: &[DVec2; 3],
    size: u32,
    cells: &mut Vec<(u32, f64)>,
    found: &mut Vec<(u32, Fragment)>,
) {
    cells.clear();
    if signed_area(corners).abs() > MIN_UV_AREA {
        overlaps(&Polygon::new(corners), size, cells);
    }
    let largest = cells.iter().map(|(_, area)| *area).fold(0.0, f64::max);
    cells.retain(|(_, area)| *area >= largest.min(MIN_OVERLAP));
    let sum: f64 = cells.iter().map(|(_, area)| area).sum();
    found.extend(cells.iter().map(|&(pixel, area)| {
        (pixel, Fragment { triangle, overlap: area as f32, share: (area / sum) as f32 })
    }));
    if cells.is_empty() {
        let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        let pixel = cell(centre.y, size) * size + cell(centre.x, size);
        found.push((pixel, Fragment { triangle, overlap: 0.0, share: 1.0 }));
    }
}

/// Overlap of a polygon with every texel square it touches.
fn overlaps(polygon: &Polygon, size: u32, cells: &mut Vec<(u32, f64)>) {
    let (low, high) = polygon.range(1);
    for row in cell(low, size)..=cell(high, size) {
        let strip = polygon.clipped(1, f64::from(row), 1.0).clipped(1, f64::from(row + 1), -1.0);
        let (low, high) = strip.range(0);
        for column in cell(low, size)..=cell(high, size) {
            let piece = strip.clipped(0, f64::from(column), 1.0).clipped(0, f64::from(column + 1), -1.0);
            let area = piece.area();
            if area > 0.0 {
                cells.push((row * size + column, area));
            }
        }
    }
}

/// The row or column that holds a coordinate.
fn cell(coordinate: f64, size: u32) -> u32 {
    (coordinate as u32).min(size - 1)
}

/// Area of a triangle in UV, positive where it runs from u towards v.
pub(super) fn signed_area([a, b, c]: &[DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a) / 2.0
}

/// A convex polygon: a triangle cut by the four sides of a square has at most seven corners.
#[derive(Clone, Copy)]
struct Polygon {
    corners: [DVec2; 7],
    count: usize,
}

impl Polygon {
    fn new(triangle: &[DVec2; 3]) -> Self {
        let mut polygon = Self { corners: [DVec2::ZERO; 7], count: 0 };
        triangle.iter().for_each(|&p| polygon.push(p));
        polygon
    }

    fn push(&mut self, p: DVec2) {
        // Rounding may cross a side twice; an eighth corner then lies on the seventh.
        if let Some(corner) = self.corners.get_mut(self.count) {
            *corner = p;
            self.count += 1;
        }
    }

    fn corners(&self) -> &[DVec2] {
        &self.corners[..self.count]
    }

    /// Smallest and largest coordinate along an axis; an empty range for an empty polygon.
    fn range(&self, axis: usize) -> (f64, f64) {
        let mut along = self.corners().iter().map(|p| p[axis]);
        let Some(first) = along.next() else { return (1.0, 0.0) };
        along.fold((first, first), |(low, high), x| (low.min(x), high.max(x)))
    }

    /// The part above (`side` 1) or below (`side` −1) a limit along an axis. Sutherland and Hodgman 1974.
    fn clipped(&self, axis: usize, limit: f64, side: f64) -> Self {
        let mut kept = Self { count: 0, ..*self };
        let Some(&last) = self.corners().last() else { return kept };
        let mut from = last;
        for &to in self.corners() {
            let (before, after) = ((from[axis] - limit) * side, (to[axis] - limit) * side);
            if (before < 0.0) != (after < 0.0) {
                let mut crossing = from.lerp(to, before / (before - after));
                crossing[axis] = limit;
                kept.push(crossing);
            }
            if after >= 0.0 {
                kept.push(to);
            }
            from = to;
        }
        kept
    }

    fn area(&self) -> f64 {
        let corners = self.corners();
        let origin = self.corners[0];
        let double: f64 = corners.windows(2).map(|p| (p[0] - origin).perp_dot(p[1] - origin)).sum();
        double.abs() / 2.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn overlap(fragments: &Fragments, pixel: usize) -> f32 {
        fragments.at(pixel).iter().map(|f| f.overlap).sum()
    }

    #[test]
    fn half_a_square_covers_what_geometry_says() {
        let corners = [DVec2::new(1.0, 1.0), DVec2::new(5.0, 1.0), DVec2::new(1.0, 5.0)];
        let fragments = Fragments::new(&[corners], 8);
        for row in 0..8 {
            for column in 0..8 {
                let inside = (1..5).contains(&row) && (1..5).contains(&column);
                let expected = match row + column {
                    _ if !inside => 0.0,
                    ..=4 => 1.0,
                    5 => 0.5,
                    _ => 0.0,
                };
                assert_eq!(overlap(&fragments, row * 8 + column), expected, "row {row} column {column}");
            }
        }
        assert_eq!(fragments.at(9)[0].share, 1.0 / 8.0);
    }

    #[test]
    fn a_triangle_around_a_square_keeps_nearly_all_of_it() {
        let corners = [DVec2::new(0.2, 1.5), DVec2::new(2.6, -0.3), DVec2::new(2.1, 2.6)];
        let square = Polygon::new(&corners)
            .clipped(0, 1.0, 1.0)
            .clipped(0, 2.0, -1.0)
            .clipped(1, 1.0, 1.0)
            .clipped(1, 2.0, -1.0);
        assert!(square.count > 3 && square.area() > 0.9 && square.area() < 1.0, "{}", square.area());
    }

    #[test]
    fn the_border_of_the_texture_belongs_to_the_last_texel() {
        let corners = [DVec2::new(8.0, 8.0), DVec2::new(7.0, 8.0), DVec2::new(8.0, 7.0)];
        let fragments = Fragments::new(&[corners], 8);
        assert_eq!(overlap(&fragments, 63), 0.5);
    }
}
