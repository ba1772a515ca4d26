//! Deform: positions and normals of a morphed pose.

use std::collections::HashMap;

use glam::DVec3;
use translume_mesh::Mesh;

use crate::Surface;

/// Cosine above which rest normals at one position are one normal, about 1.15°.
const SAME_NORMAL: f64 = 0.9998;

/// Vertex positions of the pose `rest + Σ weight · delta`, in mm. Missing weights count as 0.
#[must_use]
pub fn positions(mesh: &Mesh, weights: &[f64], mm_per_unit: f64) -> Vec<[f64; 3]> {
    let mut pose: Vec<[f64; 3]> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
    for (target, &weight) in mesh.targets.iter().zip(weights) {
        for (position, delta) in pose.iter_mut().zip(&target.position_deltas) {
            crate::rgb::accumulate(position, delta.map(f64::from), weight);
        }
    }
    pose.into_iter().map(|position| crate::rgb::scale(position, mm_per_unit)).collect()
}

/// Unit vertex normals of a pose: the sum of the adjacent triangles' normals weighted by their areas. Vertices that are one
/// point of the surface at rest, with the same position bit for bit and rest normals within about 1°, share their
/// triangles, so that seams stay smooth and hard edges hard. `[0, 1, 0]` where the triangles cancel or none exist.
#[must_use]
pub fn normals(mesh: &Mesh, pose: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let sums = area_vectors(pose, &mesh.triangles);
    let mut copies: HashMap<[u32; 3], Vec<usize>> = HashMap::new();
    // Adding 0 makes −0 and 0 one position.
    let key = |v: usize| mesh.positions[v].map(|x| (x + 0.0).to_bits());
    for v in 0..pose.len() {
        copies.entry(key(v)).or_default().push(v);
    }
    let rest_normal = |v: usize| DVec3::from(mesh.normals[v].map(f64::from));
    let normal = |v: usize| {
        let alike = |&&w: &&usize| w == v || rest_normal(v).dot(rest_normal(w)) > SAME_NORMAL;
        copies[&key(v)].iter().filter(alike).map(|&w| sums[w]).sum::<DVec3>()
    };
    (0..pose.len()).map(|v| normal(v).normalize_or(DVec3::Y).to_array()).collect()
}

/// Unit vertex normals by index alone: vertices at one position stay apart. `[0, 1, 0]` as for [`normals`].
#[must_use]
pub fn indexed_normals(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<[f64; 3]> {
    area_vectors(positions, triangles).into_iter().map(|sum| sum.normalize_or(DVec3::Y).to_array()).collect()
}

/// The surface of a pose, in mm, shaded with [`normals`] or with face normals.
#[must_use]
pub fn surface(mesh: &Mesh, weights: &[f64], mm_per_unit: f64, flat: bool) -> Surface {
    let pose = positions(mesh, weights, mm_per_unit);
    let normals = if flat { Vec::new() } else { normals(mesh, &pose) };
    Surface::new(pose, normals, mesh.triangles.clone(), flat)
}

/// For every vertex, twice the area vectors of the triangles that index it.
fn area_vectors(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; positions.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| DVec3::from(positions[v as usize]));
        let cross = (b - a).cross(c - a);
        for &v in triangle {
            sums[v as usize] += cross;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use translume_mesh::MorphTarget;

    fn morphing() -> Mesh {
        Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            normals: vec![[0.0, 0.0, 1.0]; 3],
            triangles: vec![[0, 1, 2]],
            targets: vec![
                MorphTarget { name: "lift".into(), position_deltas: vec![[0.0, 0.0, 1.0]; 3] },
                MorphTarget {
                    name: "tip".into(),
                    position_deltas: vec![[0.0; 3], [0.0; 3], [0.0, -1.0, 1.0]],
                },
            ],
            ..Mesh::default()
        }
    }

    #[test]
    fn pose_adds_weighted_deltas_then_scales() {
        let pose = positions(&morphing(), &[0.5, 2.0], 10.0);
        assert_eq!(pose, [[0.0, 0.0, 5.0], [10.0, 0.0, 5.0], [0.0, -10.0, 25.0]]);
        assert_eq!(positions(&morphing(), &[], 1.0)[1], [1.0, 0.0, 0.0]);
        assert_ne!(positions(&morphing(), &[0.5, 1.9], 10.0), pose);
    }

    #[test]
    fn normals_follow_the_pose() {
        let mesh = morphing();
        assert_eq!(normals(&mesh, &positions(&mesh, &[], 1.0)), [[0.0, 0.0, 1.0]; 3]);
        // Fully tipped, the triangle stands in the plane y = 0 and faces −y.
        assert_eq!(normals(&mesh, &positions(&mesh, &[0.0, 1.0], 1.0)), [[0.0, -1.0, 0.0]; 3]);
    }

    /// Two triangles folded along an edge whose vertices are doubled: one surface if the rest normals agree.
    fn folded(rest_normals: [[f32; 3]; 2]) -> Vec<[f64; 3]> {
        let mesh = Mesh {
            positions: vec![
                [0.0; 3],
                [0.0, 0.0, 1.0],
                [1.0, 0.0, 0.0],
                [0.0; 3],
                [0.0, 1.0, 0.0],
                [-0.0, 0.0, 1.0],
            ],
            normals: [[rest_normals[0]; 3], [rest_normals[1]; 3]].concat(),
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            ..Mesh::default()
        };
        normals(&mesh, &positions(&mesh, &[], 1.0))
    }

    #[test]
    fn seams_stay_smooth_and_creases_hard() {
        let smooth = folded([[0.6, 0.8, 0.0]; 2]);
        assert_eq!((smooth[0], smooth[1]), (smooth[3], smooth[5]));
        let (right, up) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        assert_eq!(folded([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]), [up, up, up, right, right, right]);
        assert_ne!(smooth[0], up);
    }

    #[test]
    fn normals_of_a_sphere_point_outwards() {
        let (positions, triangles) = crate::testing::octasphere(3.0, 4);
        for (position, normal) in positions.iter().zip(indexed_normals(&positions, &triangles)) {
            let cos = DVec3::from(*position).normalize().dot(DVec3::from(normal));
            // Vertices where the split pattern is uneven tilt by less than half an edge's angle, 0.05.
            assert!(cos > 1.0 - 0.5 * 0.05 * 0.05, "{cos}");
        }
    }
}
