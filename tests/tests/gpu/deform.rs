//! Positions and normals of poses.

use glam::{DVec3, Mat4, Quat, Vec3};
use translume_mesh::warp::Axis;
use translume_mesh::{Warp, builtin};
use translume_tests::{
    Check, Fixture, Model, Pose, at_least, at_most, creature, cuboids, holds, limb, notices, sphere,
};

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
    // Five roundings of 6e-8 in numbers of the body's size and its distance from the origin; measured 1.3e-7. An angle of many
    // radians is itself rounded.
    let rounding = 1e-6 * f64::from(pose.warp.twist.abs().max(pose.warp.bend.abs()).max(1.0));
    at_most("deform: position error over size", furthest(&fixture.positions(), &expected) / size, rounding)?;
    // An f32 rounding of 1e-5 mm against edges of 1 mm tilts a thin triangle by some 1e-4; measured 4e-6.
    at_most("deform: normal error", furthest(&fixture.normals(), &expected_normals), 2e-4)
}

fn melting(weight: f32, model: Mat4) -> Pose {
    Pose { model, weights: vec![weight], ..Pose::rest(1) }
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
        let pose = Pose { model, ..Pose::rest(0) };
        holds(agree(&mut fixture, &pose, &pose));
    }
}

/// The least cosine between a normal and the way out from the middle of an ellipsoid.
fn outward(fixture: &mut Fixture, model: Mat4, sign: f64) -> Check {
    fixture.run(&Pose { model, ..Pose::rest(0) }.frame(&[]));
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

/// Joints that stretch, turn and shear the limb.
fn bent_joints(turn: f32) -> Vec<[[f32; 4]; 4]> {
    let middle = Mat4::from_translation(Vec3::new(5.0, 10.0, 0.0)) * Mat4::from_rotation_x(0.5 * turn);
    let end = Mat4::from_scale_rotation_translation(
        Vec3::new(1.1, 0.7, 0.9),
        Quat::from_rotation_z(turn),
        Vec3::new(-30.0, 20.0, 3.0),
    );
    [Mat4::IDENTITY, middle, end].map(|joint| joint.to_cols_array_2d()).to_vec()
}

fn skinned(weight: f32, turn: f32, model: Mat4) -> Pose {
    Pose { joints: bent_joints(turn), ..melting(weight, model) }
}

#[test]
fn skinned_poses_follow_the_twin() {
    let mut fixture = Fixture::new(&limb(), |d| d.mm_per_unit = 1000.0);
    for (weight, turn) in [(0.0, 0.9), (0.7, 0.9), (1.0, -2.0)] {
        for model in [Mat4::IDENTITY, mirrored()] {
            let pose = skinned(weight, turn, model);
            holds(agree(&mut fixture, &pose, &pose));
        }
    }
    let at_rest = melting(0.7, leaning());
    holds(agree(&mut fixture, &at_rest, &at_rest));
    let pose = skinned(0.7, 0.9, leaning());
    notices(agree(&mut fixture, &pose, &skinned(0.7, 0.9001, leaning())));
    notices(agree(&mut fixture, &pose, &skinned(0.7001, 0.9, leaning())));
    let mut swapped = pose.clone();
    swapped.joints.swap(1, 2);
    notices(agree(&mut fixture, &pose, &swapped));
}

/// What has no skin and no warp is computed to the same bits, however that is said.
#[test]
fn a_mesh_without_a_skin_is_none_the_wiser() {
    let mut fixture = in_metres();
    let pose = melting(0.3, leaning());
    fixture.run(&pose.frame(&[]));
    let expected = (fixture.positions(), fixture.normals());
    fixture.run(&Pose { warp: Warp { bend: 1.0, ..Warp::default() }, ..pose.clone() }.frame(&[]));
    assert!(fixture.positions() != expected.0 && fixture.normals() != expected.1, "a warp changes the bits");
    let elsewhere = Some(Axis { foot: [7.0; 3], height: 3.0 });
    fixture.run(&Pose { warp: Warp { axis: elsewhere, ..Warp::default() }, ..pose }.frame(&[]));
    assert!((fixture.positions(), fixture.normals()) == expected, "an axis alone changes nothing");
}

fn warped(twist: f32, bend: f32, inflate: f32) -> Pose {
    Pose { warp: Warp { twist, bend, inflate, axis: None }, ..Pose::rest(0) }
}

#[test]
fn warps_follow_the_twin() {
    let mut fixture = Fixture::new(&cuboids(&[([-20.0, -50.0, -10.0], [20.0, 50.0, 10.0])]), |_| ());
    for angle in [1e-30, 1e-7, 1e-4, 3e-3, 0.1, 1.6, -7.0, 100.0] {
        for pose in [warped(angle, 0.0, 0.0), warped(0.0, angle, 0.0), warped(0.3, angle, 2.0)] {
            holds(agree(&mut fixture, &pose, &pose));
        }
    }
    let beyond = Some(Axis { foot: [3.0, -20.0, 1.0], height: 40.0 });
    let pose = Pose { warp: Warp { axis: beyond, ..warped(2.0, -1.0, -3.0).warp }, ..Pose::rest(0) };
    holds(agree(&mut fixture, &pose, &pose));
    notices(agree(&mut fixture, &pose, &warped(2.0, -1.0, -3.0)));
    notices(agree(&mut fixture, &warped(0.5, 0.0, 0.0), &warped(0.500_01, 0.0, 0.0)));
    notices(agree(&mut fixture, &warped(0.0, 0.5, 0.0), &warped(0.0, 0.500_01, 0.0)));
    notices(agree(&mut fixture, &warped(0.0, 0.5, 1.0), &warped(0.0, 0.5, 1.001)));
}

#[test]
fn morph_skin_and_warp_follow_the_twin_together() {
    let mut fixture = Fixture::new(&limb(), |d| d.mm_per_unit = 10.0);
    let all = |bend| Pose { warp: warped(1.2, bend, 3.0).warp, ..skinned(0.6, 0.8, leaning()) };
    holds(agree(&mut fixture, &all(-0.9), &all(-0.9)));
    notices(agree(&mut fixture, &all(-0.9), &all(-0.901)));
    // The same warps in another order are another shape.
    let mut late = skinned(0.6, 0.8, leaning());
    late.model *= Mat4::from_translation(Vec3::new(0.0, 3.0, 0.0));
    notices(agree(&mut fixture, &all(0.0), &Pose { warp: warped(1.2, 0.0, 0.0).warp, ..late }));
}

/// How far the vertices of an inflated sphere are from a sphere of this radius, and their normals from its radii.
fn still_a_sphere(inflate: f32, radius: f64) -> Check {
    let mut fixture = Fixture::new(&sphere(), |_| ());
    fixture.run(&warped(0.0, 0.0, inflate).frame(&[]));
    let positions = fixture.positions().into_iter().map(DVec3::from);
    let (mut away, mut tilt) = (0.0_f64, 0.0_f64);
    for (position, normal) in positions.zip(fixture.normals()) {
        away = away.max((position.length() - radius).abs() / radius);
        tilt = tilt.max(position.normalize().distance(normal.into()));
    }
    // A normal made of triangles unlike each other tilts by a fraction of an edge's angle, 0.1: measured 0.015, and a displacement
    // along it is off by the cosine.
    at_most("deform: radius of an inflated sphere", away, 1e-4)?;
    at_most("deform: tilt of its normals", tilt, 0.02)
}

#[test]
fn an_inflated_sphere_is_a_sphere() {
    holds(still_a_sphere(10.0, 60.0));
    holds(still_a_sphere(-10.0, 40.0));
    notices(still_a_sphere(10.0, 60.1));
}

/// No vertices that were one point at rest are apart.
fn closed(fixture: &Fixture, positions: &[[f64; 3]]) -> Check {
    let rest = &fixture.model.mesh.positions;
    let pairs =
        (0..rest.len()).flat_map(|v| (0..v).map(move |w| (v, w))).filter(|&(v, w)| rest[v] == rest[w]);
    let gap = pairs.map(|(v, w)| DVec3::from(positions[v]).distance(positions[w].into())).fold(0.0, f64::max);
    at_most("deform: gap at edges, mm", gap, 0.0)
}

#[test]
fn hard_edges_do_not_tear() {
    let mut fixture = Fixture::new(&cuboids(&[([-20.0; 3], [20.0; 3])]), |_| ());
    fixture.run(&warped(1.0, 0.5, 5.0).frame(&[]));
    let positions = fixture.positions();
    holds(closed(&fixture, &positions));
    let own = positions.iter().zip(fixture.normals());
    let along_own: Vec<_> = own.map(|(p, n)| (DVec3::from(*p) + DVec3::from(n)).to_array()).collect();
    notices(closed(&fixture, &along_own));
}
