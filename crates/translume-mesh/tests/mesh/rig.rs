//! Rigs made by hand, also impossible ones.

use proptest::prelude::*;
use translume_mesh::rig::{
    self, Animation, Channel, Interpolation, Joint, Local, Node, Pose, PoseError, Rig, Target,
};
use translume_mesh::{Influence, Mesh, MorphTarget, Skin};

use crate::fixtures::tetrahedron;

const IDENTITY: [[f32; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

fn rigged() -> (Mesh, Pose) {
    let influences = vec![Influence { joint: 0, weight: 1.0 }; 4];
    let mut mesh = tetrahedron();
    mesh.targets = vec![MorphTarget { name: "out".into(), position_deltas: mesh.positions.clone() }];
    mesh.skin = Some(Skin { joints: 1, per_vertex: 1, influences });
    let mut shifted = IDENTITY;
    shifted[3] = [0.0, 0.0, 5.0, 1.0];
    (mesh, Pose { weights: vec![0.5], joints: vec![shifted] })
}

#[test]
fn morph_comes_before_skin() {
    let (mesh, pose) = rigged();
    assert_eq!(rig::posed(&mesh, &pose).unwrap()[1], [1.5, -1.5, 3.5]);
    let mut again = vec![[9.0; 3]; 100];
    rig::posed_into(&mesh, &pose, &mut again).unwrap();
    assert_eq!(again, rig::posed(&mesh, &pose).unwrap(), "a list is used again from its beginning");
}

#[test]
fn what_does_not_fit_is_named() {
    let refused = |change: &dyn Fn(&mut Mesh, &mut Pose)| {
        let (mut mesh, mut pose) = rigged();
        change(&mut mesh, &mut pose);
        rig::posed(&mesh, &pose).unwrap_err()
    };
    let error = refused(&|_, pose| pose.weights.clear());
    assert!(matches!(error, PoseError::Weights { weights: 0, targets: 1, .. }), "{error}");
    assert!(error.to_string().starts_with("tetrahedron: the pose has 0 morph weights"), "{error}");
    let error = refused(&|_, pose| pose.joints.push(IDENTITY));
    assert!(matches!(error, PoseError::Joints { matrices: 2, joints: 1, .. }), "{error}");
    let error = refused(&|mesh, _| mesh.skin = None);
    assert!(matches!(error, PoseError::Joints { matrices: 1, joints: 0, .. }), "{error}");
    let told = |change: &dyn Fn(&mut Mesh, &mut Pose), what: &str| {
        let error = refused(change).to_string();
        assert!(error.contains(what), "{error}");
    };
    told(&|mesh, _| mesh.targets[0].position_deltas.truncate(3), "morph target 0 (from 0) has 3 deltas");
    told(&|mesh, _| mesh.skin.as_mut().unwrap().influences.truncate(3), "its skin has 3 influences");
    told(&|mesh, _| mesh.skin.as_mut().unwrap().per_vertex = 0, "0 a vertex");
    told(&|mesh, _| mesh.skin.as_mut().unwrap().per_vertex = usize::MAX, "influences");
    told(&|mesh, _| mesh.skin.as_mut().unwrap().influences[2].joint = 7, "vertex 2 (from 0) follows a joint");
    let none = |mesh: &mut Mesh, pose: &mut Pose| {
        mesh.skin.as_mut().unwrap().joints = 0;
        pose.joints.clear();
    };
    told(&none, "vertex 0 (from 0) follows a joint that is not among its 0");
}

#[test]
fn a_joint_without_its_node_keeps_the_rest_position() {
    let joint = Joint { node: 3, inverse_bind: [[2.0; 4]; 4] };
    let rig = Rig { joints: vec![joint], ..Rig::default() };
    assert_eq!(rig.rest_pose().joints, [IDENTITY]);
}

fn channels() -> impl Strategy<Value = Channel> {
    let target = prop_oneof![
        (0_u32..4).prop_map(Target::Translation),
        (0_u32..4).prop_map(Target::Rotation),
        (0_u32..4).prop_map(Target::Scale),
        (any::<u32>(), any::<u32>()).prop_map(|(first, count)| Target::Weights { first, count }),
        (0_u32..3, 0_u32..3).prop_map(|(first, count)| Target::Weights { first, count }),
    ];
    let mode =
        prop_oneof![Just(Interpolation::Step), Just(Interpolation::Linear), Just(Interpolation::CubicSpline)];
    let numbers = || prop::collection::vec(any::<f32>(), 0..12);
    (target, mode, numbers(), numbers()).prop_map(|(target, interpolation, times, values)| Channel {
        target,
        interpolation,
        times,
        values,
    })
}

proptest! {
    /// Unsorted and missing numbers, nodes and weights that are not there, parents after their children.
    #[test]
    fn no_rig_panics(
        channels in prop::collection::vec(channels(), 0..6),
        parents in prop::collection::vec(prop::option::of(any::<u32>()), 0..3),
        seconds: f32,
    ) {
        let local = Local::Trs { translation: [0.0; 3], rotation: [0.0; 4], scale: [1.0; 3] };
        let node = |parent| Node { name: String::new(), parent, local };
        let rig = Rig {
            nodes: parents.into_iter().map(node).collect(),
            joints: vec![Joint { node: 1, inverse_bind: IDENTITY }],
            weights: vec![0.25, 0.5],
            animations: vec![Animation { channels, ..Animation::default() }],
        };
        let pose = rig.pose(rig.animations.first(), seconds);
        prop_assert_eq!((pose.weights.len(), pose.joints.len()), (2, 1));
    }
}
