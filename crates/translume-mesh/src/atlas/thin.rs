//! Where a body is thin, and texels are finer.

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;
use rayon::prelude::*;
use std::time::Duration;

use crate::mesh::Mesh;

/// A texel holds no less than this share of what it holds where the body is thick.
const MOST: f32 = 6.0;
/// Thickness is one ray's: weights are evened out across so many rings of triangles.
const ROUNDS: usize = 3;

/// How many times as many texels each triangle gets for its surface as one that is as thick as `below` or thicker, which is in units of the mesh.
pub(super) fn weights(mesh: &Mesh, below: f32) -> Vec<f64> {
    let triangles: Vec<Triangle> = (0..mesh.triangles.len())
        .map(|t| {
            let [v0, v1, v2] = mesh.corners(t).map(Vec3A::from);
            Triangle { v0, v1, v2 }
        })
        .collect();
    let tree = build_bvh2(&triangles, BvhBuildParams::medium_build(), &mut Duration::default());
    let thickness = |triangle: &Triangle| {
        let middle = (triangle.v0 + triangle.v1 + triangle.v2) / 3.0;
        let inwards = (triangle.v2 - triangle.v0).cross(triangle.v1 - triangle.v0).normalize_or_zero();
        if inwards == Vec3A::ZERO {
            return f32::INFINITY;
        }
        let mut hit = RayHit::none();
        let ray = Ray::new(middle, inwards, 1e-4 * below, f32::INFINITY);
        tree.ray_traverse(ray, &mut hit, |ray, slot| {
            triangles[tree.primitive_indices[slot] as usize].intersect(ray)
        });
        hit.t
    };
    let mut logarithms: Vec<f32> =
        triangles.par_iter().map(|each| (below / thickness(each)).clamp(1.0, MOST).ln()).collect();
    for _ in 0..ROUNDS {
        even_out(mesh, &mut logarithms);
    }
    logarithms.into_iter().map(|x| f64::from(x).exp()).collect()
}

/// To the mean of what triangles around the corners have.
fn even_out(mesh: &Mesh, values: &mut [f32]) {
    let mut sums = vec![(0.0, 0.0); mesh.positions.len()];
    for (triangle, &value) in mesh.triangles.iter().zip(&*values) {
        for &v in triangle {
            let (sum, count) = &mut sums[v as usize];
            (*sum, *count) = (*sum + value, *count + 1.0);
        }
    }
    for (triangle, value) in mesh.triangles.iter().zip(values) {
        *value = triangle.iter().map(|&v| sums[v as usize].0 / sums[v as usize].1).sum::<f32>() / 3.0;
    }
}

#[cfg(all(test, feature = "builtin"))]
mod tests {
    use super::*;
    use crate::builtin;

    #[test]
    fn weights_go_with_how_thin_it_is() {
        let sheet = builtin::cuboid([0.0; 3], [40.0, 2.0, 40.0], [20, 1, 20]);
        let middle: Vec<f64> = weights(&sheet, 8.0)
            .into_iter()
            .enumerate()
            .filter(|(t, _)| {
                let corners = sheet.corners(*t);
                corners.iter().all(|p| p[0] > 8.0 && p[0] < 32.0 && p[2] > 8.0 && p[2] < 32.0)
            })
            .map(|(_, weight)| weight)
            .collect();
        assert!(!middle.is_empty() && middle.iter().all(|w| (w - 4.0).abs() < 1e-3), "{middle:?}");
        assert!(weights(&sheet, 1.0).iter().all(|w| (w - 1.0).abs() < 1e-6), "it is thicker than that");
        assert!(weights(&sheet, 100.0).iter().all(|w| *w < f64::from(MOST) + 1e-3));
    }
}
