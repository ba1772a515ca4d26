//! Positions and normals of poses.

use glam::{DVec3, Mat4, Quat, Vec3};
use translume_mesh::builtin;
use translume_tests::{Check, Fixture, Model, Pose, at_least, at_most, creature, holds, notices, sphere};

fn leaning() -> Mat4 {
    let rotation = Quat::from_axis_angle(Vec3::new(1.0, 2.0, 0.5).normalize(), 0.7);
    Mat4::from_scale_rotation_translation(Vec3::new(0.012, 0.009, 0.015), rotation, Vec3::new(0.3, -0.2, 0.1))
}

fn mirrored() -> Mat4 {
    leaning() * Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0))
}

/// The GPU in one pose against the twin in another, which should be the same.
fn agree(fixture: &mut Fixture, pose: &Pose, twin: &Pose) -> Check {
    fixture.run(&pose.frame(&[]));
    let expected = fixture.twin_positions(twin);
    let expected_normals = fixture.twin_normals(twin, &expected);
    let furthest = |a: &[[f64; 3]], b: &[[f64; 3]]| {
        a.iter().zip(b).map(|(a, b)| DVec3::from(*a).distance((*b).into())).fold(0.0, f64::max)
    };
    let size = expected.iter().map(|p| DVec3::from(*p).distance(expected[0].into())).fold(0.0, f64::max);
    // Five roundings of 6e-8 in numbers of the body's size and its distance from the origin; measured 1.3e-7.
    at_most("deform: position error over size", furthest(&fixture.positions(), &expected) / size, 1e-6)?;
    // An f32 rounding of 1e-5 mm against edges of 1 mm tilts a thin triangle by some 1e-4; measured 4e-6.
    at_most("deform: normal error", furthest(&fixture.normals(), &expected_normals), 2e-4)
}

fn melting(weight: f32, model: Mat4) -> Pose {
    Pose { model, weights: vec![weight] }
}

fn in_metres() -> Fixture {
    Fixture::new(&creature(), |d| d.mm_per_unit = 1000.0)
}

#[test]
fn poses_follow_the_twin() {
    let mut fixture = in_metres();
    for weight in [0.0, 0.5, 1.0] {
        for model in [Mat4::IDENTITY, leaning(), mirrored()] {
            let pose = melting(weight, model);
            holds(agree(&mut fixture, &pose, &pose));
        }
    }
}

#[test]
fn another_pose_is_noticed() {
    let mut fixture = in_metres();
    notices(agree(&mut fixture, &melting(0.5, leaning()), &melting(0.501, leaning())));
    notices(agree(&mut fixture, &melting(0.5, leaning()), &melting(0.5, mirrored())));
    let shifted = Mat4::from_translation(Vec3::splat(1e-5)) * leaning();
    notices(agree(&mut fixture, &melting(0.5, leaning()), &melting(0.5, shifted)));
}

#[test]
fn a_rigid_body_follows_the_twin() {
    let mut fixture = Fixture::new(&sphere(), |d| d.mm_per_unit = 10.0);
    for model in [leaning(), mirrored()] {
        let pose = Pose { model, weights: Vec::new() };
        holds(agree(&mut fixture, &pose, &pose));
    }
}

/// The least cosine between a normal and the way out from the middle of an ellipsoid.
fn outward(fixture: &mut Fixture, model: Mat4, sign: f64) -> Check {
    fixture.run(&Pose { model, weights: Vec::new() }.frame(&[]));
    let centre = (model.w_axis.truncate() * fixture.mm_per_unit as f32).as_dvec3();
    let normals = fixture.normals();
    let cosines = fixture
        .positions()
        .into_iter()
        .zip(&normals)
        .map(|(p, n)| sign * (DVec3::from(p) - centre).normalize().dot((*n).into()));
    // Axes within a ratio of 5:3 keep normal and radius within 29°, cosine 0.87; measured 0.88.
    at_least("deform: cosine to the outside", cosines.fold(1.0, f64::min), 0.85)
}

#[test]
fn mirrored_normals_point_outward() {
    let mut fixture = Fixture::new(&sphere(), |_| ());
    holds(outward(&mut fixture, leaning(), 1.0));
    holds(outward(&mut fixture, mirrored(), 1.0));
    notices(outward(&mut fixture, mirrored(), -1.0));
}

/// A sphere whose file says its normals lean.
fn leaning_normals() -> (Fixture, Vec<[f32; 3]>) {
    let mut mesh = builtin::sphere([0.0; 3], 50.0, 3);
    let turn = Quat::from_rotation_x(0.2);
    mesh.normals = mesh.normals.iter().map(|n| (turn * Vec3::from(*n)).to_array()).collect();
    let normals = mesh.normals.clone();
    (Fixture::new(&Model::new(mesh, 32), |_| ()), normals)
}

#[test]
fn a_rigid_body_keeps_the_normals_of_its_file() {
    let (mut fixture, expected) = leaning_normals();
    fixture.run(&Pose::rest(0).frame(&[]));
    let worst = |expected: &[[f32; 3]]| {
        let pairs = fixture.normals().into_iter().zip(expected);
        pairs.map(|(a, b)| DVec3::from(a).distance(Vec3::from(*b).as_dvec3())).fold(0.0, f64::max)
    };
    // One normalisation in f32; measured 1.4e-7.
    holds(at_most("deform: own normals", worst(&expected), 1e-6));
    let radial: Vec<_> = fixture.model.mesh.positions.iter().map(|p| p.map(|x| x / 50.0)).collect();
    notices(at_most("deform: recomputed normals", worst(&radial), 1e-6));
}
