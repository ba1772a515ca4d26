//! The surface of a pose.

use glam::DVec3;
use translume_mesh::rig::Pose;
use translume_mesh::{Mesh, Warp};
use translume_reference::{Surface, deform};

/// Triangles in millimetres. A mesh that nothing deforms keeps the normals of its file, which `flat` leaves unread.
#[must_use]
pub fn surface(mesh: &Mesh, pose: &Pose, warp: Warp, mm_per_unit: f64, flat: bool) -> Surface {
    let weights: Vec<f64> = pose.weights.iter().copied().map(f64::from).collect();
    let joints: Vec<_> = pose.joints.iter().map(|joint| joint.map(|column| column.map(f64::from))).collect();
    let posed = deform::Pose { weights: &weights, joints: &joints, warp };
    let positions = deform::posed(mesh, &posed, mm_per_unit);
    let rigid = mesh.targets.is_empty() && mesh.skin.is_none() && warp.is_identity();
    let normals = if rigid {
        mesh.normals.iter().map(|n| DVec3::from(n.map(f64::from)).normalize().to_array()).collect()
    } else {
        deform::normals(mesh, &positions)
    };
    Surface::new(positions, normals, mesh.triangles.clone(), flat)
}
