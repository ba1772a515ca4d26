//! Deform: positions and normals of a pose.

use std::collections::HashMap;

use glam::{DMat4, DVec3};
use translume_mesh::warp::Axis;
use translume_mesh::{Mesh, Skin, Warp};

use crate::Surface;

/// Cosine above which rest normals at one position are one normal, about 1.15°.
const SAME_NORMAL: f64 = 0.9998;

/// Everything that deforms a mesh. The default is the rest pose.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pose<'a> {
    /// One weight per morph target; missing ones count as 0.
    pub weights: &'a [f64],
    /// One matrix per joint, column-major; missing ones count as the identity.
    pub joints: &'a [[[f64; 4]; 4]],
    /// Inflation before the targets, twist and bend after the joints.
    pub warp: Warp,
}

/// Vertex positions of the pose `rest + Σ weight · delta`, in mm. Missing weights count as 0.
#[must_use]
pub fn positions(mesh: &Mesh, weights: &[f64], mm_per_unit: f64) -> Vec<[f64; 3]> {
    posed(mesh, &Pose { weights, ..Pose::default() }, mm_per_unit)
}

/// Vertex positions of a pose, in mm: inflated, morphed, skinned, twisted, bent.
#[must_use]
pub fn posed(mesh: &Mesh, pose: &Pose<'_>, mm_per_unit: f64) -> Vec<[f64; 3]> {
    let mut positions: Vec<DVec3> = mesh.positions.iter().copied().map(double).collect();
    if pose.warp.inflate != 0.0 {
        for (position, outward) in positions.iter_mut().zip(outward(mesh)) {
            *position += outward * f64::from(pose.warp.inflate);
        }
    }
    for (target, &weight) in mesh.targets.iter().zip(pose.weights) {
        for (position, &delta) in positions.iter_mut().zip(&target.position_deltas) {
            *position += weight * double(delta);
        }
    }
    if let Some(skin) = &mesh.skin {
        follow_joints(&mut positions, skin, pose.joints);
    }
    let axis = pose.warp.axis.unwrap_or_else(|| middle_axis(mesh));
    let warped = |p| bent(twisted(p, axis, pose.warp.twist.into()), axis, pose.warp.bend.into());
    positions.into_iter().map(|p| (mm_per_unit * warped(p)).to_array()).collect()
}

/// Linear blend skinning: the mean of the joints' matrices, applied.
fn follow_joints(positions: &mut [DVec3], skin: &Skin, joints: &[[[f64; 4]; 4]]) {
    let joint = |j: u32| joints.get(j as usize).map_or(DMat4::IDENTITY, DMat4::from_cols_array_2d);
    for (position, influences) in positions.iter_mut().zip(skin.influences.chunks(skin.per_vertex)) {
        let sum = |sum, i: &translume_mesh::Influence| sum + joint(i.joint) * f64::from(i.weight);
        *position = influences.iter().fold(DMat4::ZERO, sum).transform_point3(*position);
    }
}

/// The upright axis through the middle of the box around all triangles at rest.
fn middle_axis(mesh: &Mesh) -> Axis {
    let corners = || mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize]);
    let low = corners().reduce(|a, b| [0, 1, 2].map(|k| a[k].min(b[k]))).unwrap_or_default();
    let high = corners().reduce(|a, b| [0, 1, 2].map(|k| a[k].max(b[k]))).unwrap_or_default();
    Axis { foot: [0.5 * (low[0] + high[0]), low[1], 0.5 * (low[2] + high[2])], height: high[1] - low[1] }
}

/// How far up its axis a point is, 0 to 1. Barr's twist and bend go on rigidly beyond.
fn along(point: DVec3, axis: Axis) -> f64 {
    ((point.y - double(axis.foot).y) / f64::from(axis.height)).clamp(0.0, 1.0)
}

/// Barr's twist, written as a rotation about the axis.
fn twisted(point: DVec3, axis: Axis, angle: f64) -> DVec3 {
    if angle == 0.0 || axis.height == 0.0 {
        return point;
    }
    let foot = double(axis.foot);
    foot + (point - foot).rotate_y(angle * along(point, axis))
}

/// Barr's bend, written as a rotation about the middle of the circle that the axis becomes.
fn bent(point: DVec3, axis: Axis, angle: f64) -> DVec3 {
    // Below this angle nothing moves by more than 1e-9 of the height.
    if angle.abs() < 1e-9 || axis.height == 0.0 {
        return point;
    }
    let foot = double(axis.foot);
    let along = along(point, axis);
    let middle = foot + DVec3::X * (f64::from(axis.height) / angle);
    // A slice of the body at the foot is carried along the circle.
    let slice = point - DVec3::Y * (along * f64::from(axis.height));
    middle + (slice - middle).rotate_z(-angle * along)
}

/// Unit normals at rest that all vertices at one position share: the direction of inflation. Where they cancel each vertex has its own.
fn outward(mesh: &Mesh) -> Vec<DVec3> {
    let rest: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
    let own = area_vectors(&rest, &mesh.triangles);
    let mut shared: HashMap<[u32; 3], DVec3> = HashMap::new();
    for (v, sum) in own.iter().enumerate() {
        *shared.entry(position_key(mesh, v)).or_default() += *sum;
    }
    let outward = |v: usize| shared[&position_key(mesh, v)].normalize_or(own[v].normalize_or(DVec3::Y));
    (0..own.len()).map(outward).collect()
}

/// Adding 0 makes −0 and 0 one position.
fn position_key(mesh: &Mesh, v: usize) -> [u32; 3] {
    mesh.positions[v].map(|x| (x + 0.0).to_bits())
}

fn double(vector: [f32; 3]) -> DVec3 {
    DVec3::from(vector.map(f64::from))
}

/// Unit vertex normals of a pose: the sum of the adjacent triangles' normals weighted by their areas. Vertices that are one
/// point of the surface at rest, with the same position bit for bit and rest normals within about 1°, share their
/// triangles, so that seams stay smooth and hard edges hard. `[0, 1, 0]` where the triangles cancel or none exist.
#[must_use]
pub fn normals(mesh: &Mesh, pose: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let sums = area_vectors(pose, &mesh.triangles);
    let mut copies: HashMap<[u32; 3], Vec<usize>> = HashMap::new();
    for v in 0..pose.len() {
        copies.entry(position_key(mesh, v)).or_default().push(v);
    }
    let rest_normal = |v: usize| double(mesh.normals[v]);
    let normal = |v: usize| {
        let alike = |&&w: &&usize| w == v || rest_normal(v).dot(rest_normal(w)) > SAME_NORMAL;
        copies[&position_key(mesh, v)].iter().filter(alike).map(|&w| sums[w]).sum::<DVec3>()
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
    use translume_mesh::{Influence, MorphTarget};

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

    /// The identity, and a half turn about x that lifts by 1.
    fn two_joints() -> [[[f64; 4]; 4]; 2] {
        let turn = DMat4::from_translation(DVec3::Y) * DMat4::from_rotation_x(std::f64::consts::PI);
        [DMat4::IDENTITY, turn].map(|joint| joint.to_cols_array_2d())
    }

    #[test]
    fn joints_carry_what_targets_made() {
        let mut mesh = morphing();
        let influence = |joint, weight| Influence { joint, weight };
        let influences = [
            [influence(0, 1.0), influence(1, 0.0)],
            [influence(1, 1.0); 2],
            [influence(0, 0.5), influence(1, 0.5)],
        ];
        let mut influences = influences.concat();
        influences[3].weight = 0.0;
        mesh.skin = Some(Skin { joints: 2, per_vertex: 2, influences });
        let pose = Pose { weights: &[1.0], joints: &two_joints(), ..Pose::default() };
        let expected = [[0.0, 0.0, 1.0], [1.0, 1.0, -1.0], [0.0, 0.5, 0.0]];
        let near = |posed: Vec<[f64; 3]>| {
            posed.iter().zip(expected).all(|(a, b)| DVec3::from(*a).distance(b.into()) < 1e-12)
        };
        assert!(near(posed(&mesh, &pose, 1.0)));
        assert!(!near(posed(&mesh, &Pose { joints: &[], ..pose }, 1.0)), "joints at rest");
        mesh.skin = None;
        assert_eq!(posed(&mesh, &pose, 1.0), positions(&mesh, &[1.0], 1.0), "no skin, no joints");
    }

    #[test]
    fn warps_turn_about_the_middle_of_the_box() {
        // The box is the unit square in z = 0; its axis rises from (0.5, 0, 0).
        let at = |warp: Warp| posed(&morphing(), &Pose { warp, ..Pose::default() }, 1.0);
        let near = |a: [f64; 3], b: [f64; 3]| DVec3::from(a).distance(b.into()) < 1e-7;
        let half = std::f32::consts::PI;
        let twisted = at(Warp { twist: half, ..Warp::default() });
        assert!(near(twisted[2], [1.0, 1.0, 0.0]) && near(twisted[1], [1.0, 0.0, 0.0]), "{twisted:?}");
        // A quarter circle of length 1 has the radius 2/π; the top left corner is half a unit further out.
        let radius = 2.0 / std::f64::consts::PI;
        let bent = at(Warp { bend: half / 2.0, ..Warp::default() });
        assert!(near(bent[2], [0.5 + radius, radius + 0.5, 0.0]), "{bent:?}");
        assert_eq!(at(Warp { inflate: 0.25, ..Warp::default() })[1], [1.0, 0.0, 0.25]);
        let elsewhere = Axis { foot: [0.0; 3], height: 1.0 };
        assert!(near(at(Warp { twist: half, axis: Some(elsewhere), ..Warp::default() })[2], [0.0, 1.0, 0.0]));
    }

    #[test]
    fn an_inflated_edge_stays_closed() {
        let mesh = translume_mesh::builtin::cuboid([0.0; 3], [1.0; 3], [1; 3]);
        let warp = Warp { inflate: 0.5, ..Warp::default() };
        let inflated = posed(&mesh, &Pose { warp, ..Pose::default() }, 1.0);
        for (v, p) in mesh.positions.iter().enumerate() {
            let step = DVec3::from(inflated[v]) - double(*p);
            let outwards = p.map(|x| f64::from(2.0 * x - 1.0));
            assert!((step * DVec3::from(outwards)).min_element() > 0.1, "{p:?} {step}");
            assert!((step.length() - 0.5).abs() < 1e-12);
            let copies = (0..v).filter(|&w| mesh.positions[w] == *p);
            assert!(copies.into_iter().all(|w| inflated[w] == inflated[v]), "the edge at {p:?} tears");
        }
        assert!(mesh.positions.len() > 8, "this box has copies to tear apart");
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
