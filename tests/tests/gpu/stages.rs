//! Which stages a frame runs.

use glam::{Mat4, Vec3};
use translume::{Frame, Light, Medium, PointLight, Profile, Stage};
use translume_mesh::Warp;
use translume_tests::{Fixture, Pose, Shot, creature, gpu, limb};

fn lamp(x: f32) -> [Light; 1] {
    [Light::Point(PointLight { position: [x, 60.0, 150.0], intensity: [1e4; 3], ..Default::default() })]
}

fn pending(fixture: &mut Fixture, frame: &Frame<'_>) -> Vec<Stage> {
    fixture.prepare(frame).unwrap();
    let stages = fixture.body.pending();
    let list = Stage::ALL.into_iter().filter(|stage| stages.contains(*stage)).collect();
    fixture.encode();
    assert!(fixture.body.pending().is_empty(), "[{}] encode left stages behind", gpu().adapter_name);
    list
}

/// A stage and everything after it.
#[track_caller]
fn runs_from(stages: &[Stage], first: Stage) {
    let later = Stage::ALL.into_iter().filter(|stage| *stage as u8 >= first as u8);
    // None of these frames has a shadowed light of the sky.
    let expected: Vec<Stage> = later.filter(|stage| *stage != Stage::Visibility).collect();
    assert_eq!(stages, expected, "[{}]", gpu().adapter_name);
}

#[test]
fn a_frame_runs_what_its_inputs_changed() {
    let mut fixture = Fixture::new(&creature(), |_| ());
    let pose = Pose::rest(1);
    let lights = lamp(0.0);
    runs_from(&pending(&mut fixture, &pose.frame(&lights)), Stage::Deform);
    assert_eq!(pending(&mut fixture, &pose.frame(&lights)), []);

    let moved = lamp(10.0);
    runs_from(&pending(&mut fixture, &pose.frame(&moved)), Stage::Shadow);
    let melted = Pose { weights: vec![0.4], ..Pose::rest(1) };
    runs_from(&pending(&mut fixture, &melted.frame(&moved)), Stage::Deform);
    let elsewhere = Pose { model: Mat4::from_translation(Vec3::X), ..melted };
    runs_from(&pending(&mut fixture, &elsewhere.frame(&moved)), Stage::Deform);
    assert_eq!(pending(&mut fixture, &elsewhere.frame(&moved)), []);
}

#[test]
fn joints_and_warps_run_everything_once() {
    let mut fixture = Fixture::new(&limb(), |_| ());
    let lights = lamp(0.0);
    let joints = |turn| vec![Mat4::from_rotation_z(turn).to_cols_array_2d(); 3];
    let bend = |bend| Warp { bend, ..Warp::default() };
    let poses = [
        Pose::rest(1),
        Pose { joints: joints(0.1), ..Pose::rest(1) },
        Pose { joints: joints(0.2), ..Pose::rest(1) },
        Pose { joints: joints(0.2), warp: bend(0.1), ..Pose::rest(1) },
        Pose { joints: joints(0.2), warp: bend(0.2), ..Pose::rest(1) },
    ];
    for pose in &poses {
        runs_from(&pending(&mut fixture, &pose.frame(&lights)), Stage::Deform);
        assert_eq!(pending(&mut fixture, &pose.frame(&lights)), [], "{pose:?} once more");
    }
    runs_from(&pending(&mut fixture, &poses[0].frame(&lights)), Stage::Deform);
    let at_rest = Pose { joints: joints(0.0), ..Pose::rest(1) };
    assert_eq!(
        pending(&mut fixture, &at_rest.frame(&lights)),
        [],
        "joints at the identity are the rest pose"
    );
}

/// A medium needs the scatter, another index of refraction the gather too, a profile that leaves B alone nothing.
#[test]
fn a_medium_runs_what_reads_it() {
    let mut fixture = Fixture::new(&creature(), |_| ());
    let (pose, lights) = (Pose::rest(1), lamp(0.0));
    pending(&mut fixture, &pose.frame(&lights));
    fixture.body.set_medium(Medium { ior: Medium::MARBLE.ior, ..Medium::WAX }).unwrap();
    runs_from(&pending(&mut fixture, &pose.frame(&lights)), Stage::Scatter);
    fixture.body.set_medium(Medium::SKIN1).unwrap();
    let stages = pending(&mut fixture, &pose.frame(&lights));
    assert!(stages.contains(&Stage::Gather) && !stages.contains(&Stage::Deform), "{stages:?}");
    fixture.body.set_medium(Medium::SKIN1).unwrap();
    assert_eq!(pending(&mut fixture, &pose.frame(&lights)), [], "the same medium once more");
    fixture.body.set_profile(Profile::Dipole).unwrap();
    assert_eq!(pending(&mut fixture, &pose.frame(&lights)), [], "only the way to the eye changed");
}

/// Another camera is none of the body's business: a picture leaves nothing pending.
#[test]
fn a_camera_runs_nothing() {
    let mut fixture = Fixture::new(&creature(), |_| ());
    let (pose, lights) = (Pose::rest(1), lamp(0.0));
    pending(&mut fixture, &pose.frame(&lights));
    for x in [0.0, 50.0] {
        let shot = Shot { eye: [x, 80.0, 240.0], target: [0.0, 48.0, 0.0], fov: 0.5, size: 16 };
        assert!(shot.take(&fixture).iter().any(|pixel| pixel[3] > 0.0));
        assert_eq!(pending(&mut fixture, &pose.frame(&lights)), []);
    }
}

/// A frame in steps gives the bits of the same frame at once, and encoding it again changes nothing.
#[test]
fn a_kept_stage_is_as_good_as_a_new_one() {
    let melted = Pose { weights: vec![0.4], ..Pose::rest(1) };
    let (first, second) = (lamp(0.0), lamp(25.0));
    let mut in_steps = Fixture::new(&creature(), |_| ());
    in_steps.run(&Pose::rest(1).frame(&first));
    in_steps.run(&melted.frame(&first));
    let before = in_steps.exitance();
    in_steps.run(&melted.frame(&second));
    in_steps.body.set_medium(Medium::WAX).unwrap();
    in_steps.run(&melted.frame(&second));
    let mut at_once = Fixture::new(&creature(), |d| d.medium = Medium::WAX);
    at_once.run(&melted.frame(&second));
    let after = in_steps.exitance();
    // The kernel table's range remembers the first pose, so that its interpolation differs a little.
    let error = translume_tests::relative_rmse(&after, &at_once.exitance());
    translume_tests::holds(translume_tests::at_most("stages: in steps against at once", error, 5e-3));
    assert_ne!(before, after, "[{}] another lamp and medium change the light", gpu().adapter_name);
    in_steps.run(&melted.frame(&second));
    in_steps.encode();
    assert_eq!(after, in_steps.exitance(), "[{}]", gpu().adapter_name);
}
