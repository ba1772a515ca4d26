use super::*;
use glam::{EulerRot, Quat};
use translume_mesh::{Influence, MorphTarget, Skin, rig};

/// Numbers between −1 and 1 from the counter-based generator SplitMix64 (Steele, Lea, Flood 2014).
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 40) as f32 / (1_u32 << 23) as f32 - 1.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.roll(), self.roll(), self.roll())
    }
}

/// A cloud in a tall box: the lower half follows joint 0, the upper joint 1, with a soft change at half height.
fn cloud(dice: &mut Dice) -> Mesh {
    const VERTICES: usize = 90;
    let positions: Vec<_> =
        (0..VERTICES).map(|_| (dice.vector() * Vec3::new(2.0, 5.0, 1.0) + 1.0).to_array()).collect();
    let share = |p: &[f32; 3]| (0.5 + (p[1] - 1.0)).clamp(0.0, 1.0);
    let influences = positions.iter().flat_map(|p| {
        [(0, 1.0 - share(p)), (1, share(p))].map(|(joint, weight)| Influence { joint, weight })
    });
    let skin = Skin { joints: 2, per_vertex: 2, influences: influences.collect() };
    let targets = (0..2).map(|_| MorphTarget {
        position_deltas: (0..VERTICES).map(|_| dice.vector().to_array()).collect(),
        ..Default::default()
    });
    let targets = targets.collect();
    let triangles = (0..VERTICES as u32).step_by(3).map(|v| [v, v + 1, v + 2]).collect();
    Mesh { positions, triangles, targets, skin: Some(skin), ..Mesh::default() }
}

fn random_pose(dice: &mut Dice, skinned: bool) -> Pose {
    let joint = |dice: &mut Dice| {
        let [a, b, c] = (dice.vector() * 2.0).to_array();
        let turn = Quat::from_euler(EulerRot::XYZ, a, b, c);
        Mat4::from_scale_rotation_translation(Vec3::ONE + 0.4 * dice.vector(), turn, 3.0 * dice.vector())
            .to_cols_array_2d()
    };
    let angle = |dice: &mut Dice| 7.0 * dice.roll().powi(3);
    Pose {
        weights: (0..2).map(|_| 1.5 * dice.roll()).collect(),
        joints: if skinned { vec![joint(dice), joint(dice)] } else { Vec::new() },
        warp: Warp { twist: angle(dice), bend: angle(dice), inflate: 0.3 * dice.roll(), axis: None },
        adopted: None,
    }
}

fn true_bounds(mesh: &Mesh, pose: &Pose) -> Bounds {
    let rig_pose = rig::Pose { weights: pose.weights.clone(), joints: pose.joints.clone() };
    Bounds::around(pose.warp.posed(mesh, &rig_pose).unwrap().into_iter().map(Vec3::from))
}

/// How far random poses stick out of their boxes at worst, and how much longer those boxes' diagonals are on average; over
/// the size of the pose.
fn escape_and_excess(skinned: bool, change: impl Fn(&mut Pose)) -> (f32, f32) {
    const ROUNDS: usize = 2000;
    let mut dice = Dice(7);
    let mut mesh = cloud(&mut dice);
    if !skinned {
        mesh.skin = None;
    }
    let bounds = PoseBounds::new(&mesh);
    let (mut escape, mut excess) = (0.0_f32, 0.0);
    for _ in 0..ROUNDS {
        let pose = random_pose(&mut dice, skinned);
        let actual = true_bounds(&mesh, &pose);
        let mut other = pose.clone();
        change(&mut other);
        let expected = bounds.posed(&other);
        let size = actual.low.distance(actual.high);
        let out = (expected.low - actual.low).max(actual.high - expected.high).max_element();
        escape = escape.max(out / size);
        excess += (expected.low.distance(expected.high) / size - 1.0) / ROUNDS as f32;
    }
    (escape, excess)
}

#[test]
fn bounds_hold_random_poses_and_stay_near() {
    for skinned in [false, true] {
        let (escape, excess) = escape_and_excess(skinned, |_| ());
        // Roundings of 6e-8 in numbers up to ten times the size.
        assert!(escape < 2e-6, "skinned {skinned}: {escape}");
        // A box around a turned box is up to √3 times as long, and joints, twist and bend each put one around the last; measured
        // 0.42 and 1.10.
        assert!(excess < 1.3, "skinned {skinned}: {excess}");
    }
}

#[test]
fn bounds_of_another_pose_are_noticed() {
    type Change = fn(&mut Pose);
    let changes: [Change; 4] = [
        |pose| pose.weights[1] += 0.5,
        |pose| pose.joints.swap(0, 1),
        |pose| pose.warp.twist += 0.5,
        |pose| pose.warp.bend += 0.5,
    ];
    for change in changes {
        assert!(escape_and_excess(true, change).0 > 1e-3);
    }
}

#[test]
fn a_pose_that_is_a_box_has_a_tight_one() {
    let mut dice = Dice(3);
    let mesh = cloud(&mut dice);
    let bounds = PoseBounds::new(&mesh);
    let turned = Mat4::from_rotation_z(FRAC_PI_2).to_cols_array_2d();
    let rest = Pose { weights: vec![0.0; 2], joints: vec![turned; 2], ..Pose::default() };
    let target = Pose { weights: vec![0.0, 1.0], ..rest.clone() };
    for pose in [rest, target] {
        let (expected, actual) = (bounds.posed(&pose), true_bounds(&mesh, &pose));
        let apart = (expected.low - actual.low).abs().max((expected.high - actual.high).abs());
        // The slack of the weights: a thousandth of the 7 units that the cloud reaches from the origin.
        assert!(apart.max_element() < 8e-3, "{expected:?} {actual:?}");
    }
}

#[test]
fn inflation_grows_the_box() {
    let mesh = Mesh { skin: None, ..cloud(&mut Dice(3)) };
    let bounds = PoseBounds::new(&mesh);
    let pose = |inflate| Pose {
        weights: vec![0.0; 2],
        warp: Warp { inflate, ..Warp::default() },
        ..Pose::default()
    };
    for inflate in [0.5, -0.5] {
        let actual = true_bounds(&mesh, &pose(inflate));
        let out = |of: Bounds| (of.low - actual.low).max(actual.high - of.high).max_element();
        assert!(out(bounds.posed(&pose(inflate))) <= 0.0);
        assert!(out(bounds.posed(&pose(0.0))) > 0.1);
    }
}

/// Eight targets that each move another piece: a sum of whole boxes would be many times too large.
#[test]
fn many_small_targets_add_up_to_little() {
    let positions: Vec<[f32; 3]> = (0..9_u8).map(|k| [f32::from(k), 0.0, 1.0]).collect();
    let target = |moved: usize| MorphTarget {
        position_deltas: (0..9).map(|v| [0.0, if v == moved { 1.0 } else { 0.0 }, 0.0]).collect(),
        ..Default::default()
    };
    let mesh = Mesh { positions, targets: (1..9).map(target).collect(), ..Mesh::default() };
    let pose = Pose { weights: vec![0.5; 8], ..Pose::default() };
    assert_eq!(
        PoseBounds::new(&mesh).posed(&pose),
        Bounds { low: Vec3::new(0.0, 0.0, 1.0), high: Vec3::new(8.0, 4.0, 1.0) }
    );
}
