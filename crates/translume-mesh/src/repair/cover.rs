//! Triangles over a loop of points in space.

use glam::DVec3;

/// Loops of up to this many points need no further point.
const SMALL: usize = 8;

/// The search for the least area takes time with the third power of the points; for so many about 0.2 s.
const LARGEST_SEARCH: usize = 500;

/// How much the squared length of edges counts beside area: enough to choose among triangulations of a flat loop, whose
/// areas are the same, and too little to fold one.
const COMPACTNESS: f64 = 1e-3;

/// Triangles that close a loop of points.
pub(super) struct Cover {
    /// Indices of the points; their number stands for the centre.
    pub triangles: Vec<[usize; 3]>,
    /// Each point's share in the centre, adding up to 1; empty where no triangle uses one.
    pub shares: Vec<f64>,
}

/// Covers a loop, counter-clockwise seen from the side that the triangles shall face. `free` tells whether an edge may be drawn
/// between two points. `None` where every choice has a triangle whose height is at most `min_height`.
pub(super) fn cover(points: &[DVec3], free: impl Fn(usize, usize) -> bool, min_height: f64) -> Option<Cover> {
    if points.len() < 3 {
        return None;
    }
    let (fan, centre) = fan(points);
    let corner = |k: usize| points.get(k).copied().unwrap_or(centre);
    let has_area = |t: &[usize; 3]| height(t.map(corner)) > min_height;
    let normal = vector_area(points);
    let upright = |t: &[usize; 3]| {
        let [a, b, c] = t.map(corner);
        (b - a).cross(c - a).dot(normal) > 0.0
    };
    let search = || {
        let triangles = least_area(points, &free, min_height)?;
        Some(Cover { triangles, shares: Vec::new() })
    };
    let solid = fan.triangles.iter().all(has_area);
    if points.len() > SMALL && solid && fan.triangles.iter().all(upright) {
        return Some(fan);
    }
    let searched = if points.len() <= LARGEST_SEARCH { search() } else { None };
    searched.or_else(|| solid.then_some(fan))
}

/// A fan around the mean of the loop's edges, and that mean as a mesh stores it.
fn fan(points: &[DVec3]) -> (Cover, DVec3) {
    let n = points.len();
    let lengths: Vec<f64> = (0..n).map(|k| points[k].distance(points[(k + 1) % n])).collect();
    let perimeter: f64 = lengths.iter().sum();
    let shares: Vec<f64> =
        (0..n).map(|k| (lengths[k] + lengths[(k + n - 1) % n]) / (2.0 * perimeter)).collect();
    let centre: DVec3 = points.iter().zip(&shares).map(|(&p, &share)| p * share).sum();
    let triangles = (0..n).map(|k| [k, (k + 1) % n, n]).collect();
    (Cover { triangles, shares }, centre.as_vec3().as_dvec3())
}

/// The triangulation of least area by dynamic programming.
///
/// Source: Barequet and Sharir 1995, "Filling Gaps in the Boundary of a Polyhedron", section 3.
fn least_area(
    points: &[DVec3],
    free: &impl Fn(usize, usize) -> bool,
    min_height: f64,
) -> Option<Vec<[usize; 3]>> {
    let n = points.len();
    // Cost of the best cover of the points i to j, and the point that makes a triangle with the edge between i and j.
    let mut best = vec![(0.0, 0); n * n];
    for span in 2..n {
        for i in 0..n - span {
            let j = i + span;
            let closing = span == n - 1;
            let split = |k: usize| {
                let cost =
                    best[i * n + k].0 + best[k * n + j].0 + cost([i, k, j].map(|p| points[p]), min_height);
                (cost, k)
            };
            best[i * n + j] = if closing || free(i, j) {
                (i + 1..j).map(split).min_by(|a, b| a.0.total_cmp(&b.0))?
            } else {
                (f64::INFINITY, 0)
            };
        }
    }
    best[n - 1].0.is_finite().then(|| {
        let mut triangles = Vec::with_capacity(n - 2);
        let mut pending = vec![(0, n - 1)];
        while let Some((i, j)) = pending.pop() {
            if j - i > 1 {
                let k = best[i * n + j].1;
                triangles.push([i, k, j]);
                pending.extend([(i, k), (k, j)]);
            }
        }
        triangles
    })
}

fn cost(corners: [DVec3; 3], min_height: f64) -> f64 {
    let [a, b, c] = corners;
    let squares = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    if height(corners) > min_height {
        (b - a).cross(c - a).length() / 2.0 + COMPACTNESS * squares
    } else {
        f64::INFINITY
    }
}

/// Half the sum of cross products around a loop: normal times area of a flat one.
pub(super) fn vector_area(points: &[DVec3]) -> DVec3 {
    let Some(&origin) = points.first() else { return DVec3::ZERO };
    points.windows(2).map(|pair| (pair[0] - origin).cross(pair[1] - origin)).sum::<DVec3>() / 2.0
}

/// Height over the longest edge; 0 for a point.
pub(super) fn height([a, b, c]: [DVec3; 3]) -> f64 {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    if longest > 0.0 { (b - a).cross(c - a).length() / longest } else { 0.0 }
}
