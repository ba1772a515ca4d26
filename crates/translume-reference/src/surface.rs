//! Triangles that rays can find.
//!
//! `obvhs` builds the tree in single precision from boxes rounded outwards, so that no triangle leaves its box; boxes
//! are then read, and triangles intersected, in double precision with the watertight test of Woop, Benthin and Wald
//! 2013 ("Watertight Ray/Triangle Intersection", JCGT 2-1): a ray cannot slip through a shared edge.
//!
//! A ray that starts on the surface leaves out the triangle it starts from and every hit nearer than
//! 1e-9 of the bounding box's diagonal plus 1e-12 of the largest coordinate. The second term covers the rounding of
//! positions (2e-16) four thousandfold; the first keeps neighbours across an edge from shading a point on that edge.

use std::time::Duration;

use glam::{DVec3, Vec3A};
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::{BvhBuildParams, aabb::Aabb, bvh2::Bvh2};

use crate::deform;

/// A triangle surface in mm, with a bounding volume hierarchy.
pub struct Surface {
    /// Vertex positions, mm.
    pub positions: Vec<[f64; 3]>,
    /// Unit vertex normals, one per position; not read when `flat`.
    pub normals: Vec<[f64; 3]>,
    /// Triangles, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Shade with face normals instead of interpolated ones.
    pub flat: bool,
    nodes: Vec<Node>,
    /// Triangles in the order of the leaves.
    leaves: Vec<u32>,
    offset: f64,
}

/// A node of the tree: two children next to each other from `first` on, or `count` triangles of a leaf.
struct Node {
    low: DVec3,
    high: DVec3,
    first: u32,
    count: u32,
}

/// Where a ray meets the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance from the origin in lengths of the ray's direction.
    pub t: f64,
    /// The triangle.
    pub triangle: u32,
    /// Weights of its second and third corner.
    pub barycentric: [f64; 2],
}

impl Surface {
    /// A surface shaded with the given vertex normals, or with face normals if `flat`.
    ///
    /// Expects a clean mesh: every index in range, as `translume_mesh` loads it. Triangles with a corner that is not
    /// finite are never hit.
    #[must_use]
    pub fn new(
        positions: Vec<[f64; 3]>,
        normals: Vec<[f64; 3]>,
        triangles: Vec<[u32; 3]>,
        flat: bool,
    ) -> Self {
        let is_finite = |t: &u32| {
            triangles[*t as usize].iter().all(|&v| positions[v as usize].iter().all(|x| x.is_finite()))
        };
        let finite: Vec<u32> = (0..triangles.len() as u32).filter(is_finite).collect();
        let corners = |t: u32| triangles[t as usize].map(|v| DVec3::from(positions[v as usize]));
        let boxes: Vec<Aabb> = finite.iter().map(|&t| outward_box(corners(t))).collect();
        let bounds = boxes.iter().fold(Aabb::INVALID, |sum, each| sum.union(each));
        let offset = if boxes.is_empty() {
            0.0
        } else {
            let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
            1e-9 * (high - low).length() + 1e-12 * low.abs().max(high.abs()).max_element()
        };
        let bvh = build(&boxes);
        let leaves = bvh.primitive_indices.iter().map(|&slot| finite[slot as usize]).collect();
        let node = |node: &Bvh2Node| Node {
            low: node.aabb().min.as_dvec3(),
            high: node.aabb().max.as_dvec3(),
            first: node.first_index,
            count: if node.is_leaf() { node.prim_count } else { 0 },
        };
        let nodes = bvh.nodes.iter().map(node).collect();
        Self { positions, normals, triangles, flat, nodes, leaves, offset }
    }

    /// A surface with smooth normals computed from its triangles.
    #[must_use]
    pub fn smooth(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        let normals = deform::indexed_normals(&positions, &triangles);
        Self::new(positions, normals, triangles, false)
    }

    /// A surface with a constant normal on each triangle.
    #[must_use]
    pub fn flat(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        Self::new(positions, Vec::new(), triangles, true)
    }

    /// Area of a triangle, mm².
    #[must_use]
    pub fn area(&self, triangle: u32) -> f64 {
        triangle_area(self.corners(triangle))
    }

    /// Point of a triangle at the given weights of its second and third corner, which may lie outside it.
    #[must_use]
    pub fn point(&self, triangle: u32, barycentric: [f64; 2]) -> [f64; 3] {
        interpolate(self.corners(triangle), barycentric).to_array()
    }

    /// Unit shading normal of a triangle at the given weights; the zero vector where no direction exists.
    #[must_use]
    pub fn normal(&self, triangle: u32, barycentric: [f64; 2]) -> [f64; 3] {
        if self.flat {
            return self.face_normal(triangle);
        }
        let corners = self.triangles[triangle as usize].map(|v| DVec3::from(self.normals[v as usize]));
        interpolate(corners, barycentric).normalize_or_zero().to_array()
    }

    /// Unit normal of a triangle's plane; the zero vector if it has no area.
    #[must_use]
    pub fn face_normal(&self, triangle: u32) -> [f64; 3] {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a).normalize_or_zero().to_array()
    }

    /// The first hit along a ray from anywhere, on either side of a triangle.
    #[must_use]
    pub fn closest_hit(&self, origin: [f64; 3], direction: [f64; 3]) -> Option<Hit> {
        let mut closest: Option<Hit> = None;
        self.traverse(origin, direction, [0.0, f64::INFINITY], None, |hit| {
            closest = Some(hit);
            [0.0, hit.t]
        });
        closest
    }

    /// Whether anything lies between a point of `triangle` and the point `origin + distance · direction`; `distance`
    /// may be infinite. `direction` has unit length. What touches that far point does not count.
    #[must_use]
    pub fn occluded(&self, origin: [f64; 3], triangle: u32, direction: [f64; 3], distance: f64) -> bool {
        let mut any = false;
        let range = [self.offset, distance - self.offset];
        self.traverse(origin, direction, range, Some(triangle), |_| {
            any = true;
            [0.0, -1.0]
        });
        any
    }

    #[inline]
    pub(crate) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        let [a, b, c] = self.triangles[triangle as usize];
        [a, b, c].map(|v| DVec3::from_array(self.positions[v as usize]))
    }

    /// Calls `found` for every hit along a ray from anywhere and up to a distance, in no order, with the face's normal, not of unit
    /// length; it returns the distance for what follows.
    pub(crate) fn every_hit(
        &self,
        origin: [f64; 3],
        direction: [f64; 3],
        distance: f64,
        mut found: impl FnMut(Hit, DVec3) -> f64,
    ) {
        self.traverse(origin, direction, [0.0, distance], None, |hit| {
            let [a, b, c] = self.corners(hit.triangle);
            [0.0, found(hit, (b - a).cross(c - a))]
        });
    }

    /// Calls `found` for hits within `range`; it returns the range for what follows. Nearer boxes come first.
    fn traverse(
        &self,
        origin: [f64; 3],
        direction: [f64; 3],
        mut range: [f64; 2],
        excluded: Option<u32>,
        mut found: impl FnMut(Hit) -> [f64; 2],
    ) {
        let ray = Ray::new(origin.into(), direction.into());
        let mut pending = Pending::new();
        if let Some(root) = self.nodes.first()
            && let Some(enter) = ray.enters_box(root, range)
        {
            pending.push(0, enter);
        }
        while let Some((index, enter)) = pending.pop() {
            // What was found since may be nearer than the box.
            if enter > range[1] {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.count == 0 {
                let (left, right) = (node.first, node.first + 1);
                let enters = |child: u32| ray.enters_box(&self.nodes[child as usize], range);
                match (enters(left), enters(right)) {
                    (Some(a), Some(b)) if a < b => {
                        pending.push(right, b);
                        pending.push(left, a);
                    }
                    (Some(a), Some(b)) => {
                        pending.push(left, a);
                        pending.push(right, b);
                    }
                    (Some(a), None) => pending.push(left, a),
                    (None, Some(b)) => pending.push(right, b),
                    (None, None) => {}
                }
                continue;
            }
            for &triangle in &self.leaves[node.first as usize..(node.first + node.count) as usize] {
                if excluded == Some(triangle) {
                    continue;
                }
                if let Some((t, barycentric)) = ray.meets_triangle(self.corners(triangle))
                    && (range[0]..=range[1]).contains(&t)
                {
                    range = found(Hit { t, triangle, barycentric });
                }
            }
        }
    }
}

/// Two roundings on either side of a box (Ize 2013, "Robust BVH Ray Traversal").
const SLACK: f64 = 1.0 + 4.0 * f64::EPSILON;

/// Nodes still to visit, with where the ray enters them or a little before. The first ones need no memory of the heap: rays are many,
/// deep trees few.
struct Pending {
    first: [(u32, f32); 32],
    count: usize,
    rest: Vec<(u32, f32)>,
}

impl Pending {
    fn new() -> Self {
        Self { first: [(0, 0.0); 32], count: 0, rest: Vec::new() }
    }

    #[inline]
    fn push(&mut self, node: u32, enter: f64) {
        let node = (node, (enter * (1.0 - 1e-6)) as f32);
        if let Some(slot) = self.first.get_mut(self.count) {
            *slot = node;
            self.count += 1;
        } else {
            self.rest.push(node);
        }
    }

    #[inline]
    fn pop(&mut self) -> Option<(u32, f64)> {
        let (node, enter) = match self.rest.pop() {
            Some(node) => node,
            None => {
                self.count = self.count.checked_sub(1)?;
                self.first[self.count]
            }
        };
        Some((node, f64::from(enter)))
    }
}

/// A ray prepared for the watertight test: `axes` are permuted so that the last is the dominant one, and `shear` maps
/// the direction onto it.
pub(crate) struct Ray {
    origin: DVec3,
    inverse: DVec3,
    axes: [usize; 3],
    shear: [f64; 3],
}

impl Ray {
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        let size = direction.abs();
        let z = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let shear = [direction[x] / direction[z], direction[y] / direction[z], 1.0 / direction[z]];
        // A direction component of zero would make 0 · ∞ on the face of a box.
        let inverse =
            DVec3::from_array(direction.to_array().map(|d| 1.0 / if d == 0.0 { 1e-300 } else { d }));
        Self { origin, inverse, axes: [x, y, z], shear }
    }

    /// Where the ray enters a box that it meets within `range`.
    #[inline]
    fn enters_box(&self, node: &Node, range: [f64; 2]) -> Option<f64> {
        let [mut enter, mut leave] = range;
        for axis in 0..3 {
            let a = (node.low[axis] - self.origin[axis]) * self.inverse[axis];
            let b = (node.high[axis] - self.origin[axis]) * self.inverse[axis];
            // One instruction each, where `min` and `max` also look for what is not a number.
            let (near, far) = if a < b { (a, b) } else { (b, a) };
            enter = if near > enter { near } else { enter };
            leave = if far < leave { far } else { leave };
        }
        (enter <= leave * SLACK).then_some(enter)
    }

    /// How far away a triangle is met, also behind the origin, and the weights of its second and third corner there.
    #[inline]
    pub fn meets_triangle(&self, corners: [DVec3; 3]) -> Option<(f64, [f64; 2])> {
        let [x, y, z] = self.axes;
        let sheared = |corner: DVec3| {
            let p = (corner - self.origin).to_array();
            [p[x] - self.shear[0] * p[z], p[y] - self.shear[1] * p[z], self.shear[2] * p[z]]
        };
        let [a, b, c] = [sheared(corners[0]), sheared(corners[1]), sheared(corners[2])];
        let edge = |p: [f64; 3], q: [f64; 3]| p[0] * q[1] - p[1] * q[0];
        let weights @ [u, v, w] = [edge(c, b), edge(a, c), edge(b, a)];
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let sum = u + v + w;
        if sum == 0.0 {
            return None;
        }
        let t = (weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2]) / sum;
        Some((t, [weights[1] / sum, weights[2] / sum]))
    }
}

fn build(boxes: &[Aabb]) -> Bvh2 {
    // The builder asserts on nothing to build.
    if boxes.is_empty() {
        return Bvh2::default();
    }
    build_bvh2(boxes, BvhBuildParams::medium_build(), &mut Duration::default())
}

fn outward_box(corners: [DVec3; 3]) -> Aabb {
    let low = corners[0].min(corners[1]).min(corners[2]).to_array();
    let high = corners[0].max(corners[1]).max(corners[2]).to_array();
    Aabb::new(
        Vec3A::from_array(low.map(|x| (x as f32).next_down())),
        Vec3A::from_array(high.map(|x| (x as f32).next_up())),
    )
}

pub(crate) fn triangle_area([a, b, c]: [DVec3; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
}

pub(crate) fn interpolate([a, b, c]: [DVec3; 3], [u, v]: [f64; 2]) -> DVec3 {
    a * (1.0 - u - v) + b * u + c * v
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{octasphere, square};

    /// A floor of half side 2 at y = 0 and a roof of half side 1 at `roof`.
    fn floor_and_roof(roof: f64) -> Surface {
        let (mut positions, mut triangles) = square(2.0, 0.0);
        let (above, _) = square(1.0, roof);
        positions.extend(above);
        triangles.extend([[4, 5, 6], [4, 6, 7]]);
        Surface::flat(positions, triangles)
    }

    #[test]
    fn roof_shades_the_floor_below_it_only() {
        for height in [1.0, 0.01] {
            let scene = floor_and_roof(height);
            let up = [0.0, 1.0, 0.0];
            assert!(scene.occluded([0.5, 0.0, 0.2], 0, up, f64::INFINITY));
            assert!(!scene.occluded([1.5, 0.0, 0.2], 0, up, f64::INFINITY));
            assert!(
                !scene.occluded([0.5, height, 0.2], 2, up, f64::INFINITY),
                "the roof must not shade itself"
            );
            // A light below, on and above the roof.
            assert!(!scene.occluded([0.5, 0.0, 0.2], 0, up, 0.9 * height));
            assert!(!scene.occluded([0.5, 0.0, 0.2], 0, up, height));
            assert!(scene.occluded([0.5, 0.0, 0.2], 0, up, 1.1 * height));
        }
    }

    #[test]
    fn neighbours_do_not_shade_a_point_on_their_edge() {
        let (positions, triangles) = octasphere(1e3, 3);
        let sphere = Surface::flat(positions, triangles);
        for (t, weights) in (0..sphere.triangles.len() as u32).flat_map(|t| {
            [[0.0, 0.5], [0.5, 0.0], [0.5, 0.5], [0.0, 0.0], [0.3, 0.3]].map(|weights| (t, weights))
        }) {
            let point = sphere.point(t, weights);
            let out = sphere.face_normal(t);
            assert!(!sphere.occluded(point, t, out, f64::INFINITY));
            assert!(sphere.occluded(point, t, out.map(|x| -x), f64::INFINITY), "inwards the far side is hit");
        }
    }

    #[test]
    fn rays_through_edges_and_corners_hit() {
        let (positions, triangles) = octasphere(1.0, 3);
        let sphere = Surface::flat(positions.clone(), triangles);
        for target in positions {
            let origin = target.map(|x| 3.0 * x);
            let hit = sphere.closest_hit(origin, target.map(|x| -x)).expect("watertight");
            assert!((hit.t - 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn tree_finds_what_brute_force_finds() {
        let (positions, triangles) = octasphere(1.0, 3);
        let sphere = Surface::flat(positions, triangles);
        let (mut hits, mut misses) = (0, 0);
        for k in 0..2000 {
            let angle = f64::from(k) * 2.399_963;
            let origin = DVec3::new(2.0 * angle.cos(), f64::from(k % 37) / 18.0 - 1.0, 2.0 * angle.sin());
            let target = DVec3::new((1.3 * angle).sin(), (0.7 * angle).cos(), (2.1 * angle).sin()) * 0.9;
            let ray = Ray::new(origin, target - origin);
            let brute = (0..sphere.triangles.len() as u32)
                .filter_map(|t| ray.meets_triangle(sphere.corners(t)))
                .map(|(t, _)| t)
                .filter(|&t| t >= 0.0)
                .fold(f64::INFINITY, f64::min);
            let hit = sphere.closest_hit(origin.to_array(), (target - origin).to_array());
            assert_eq!(hit.map_or(f64::INFINITY, |hit| hit.t), brute);
            if let Some(hit) = hit {
                let there = DVec3::from(sphere.point(hit.triangle, hit.barycentric));
                assert!((there - origin - (target - origin) * hit.t).length() < 1e-14);
                hits += 1;
            } else {
                misses += 1;
            }
        }
        assert!(hits > 100 && misses > 100, "{hits} {misses}: both outcomes must be exercised");
    }

    #[test]
    fn empty_and_broken_surfaces_are_never_hit() {
        let empty = Surface::flat(Vec::new(), Vec::new());
        assert_eq!(empty.closest_hit([0.0; 3], [0.0, 0.0, 1.0]), None);
        let broken = Surface::flat(vec![[f64::NAN; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
        assert_eq!(broken.closest_hit([0.1, 0.1, -1.0], [0.0, 0.0, 1.0]), None);
        assert_eq!(Surface::flat(vec![[0.0; 3]; 3], vec![[0, 1, 2]]).face_normal(0), [0.0; 3]);
    }
}
