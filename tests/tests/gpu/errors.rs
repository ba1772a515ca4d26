//! What is refused, in words, and that it leaves the body as it was.

use glam::{Mat4, Vec3};
use std::sync::Arc;
use translume::{
    BodyDescriptor, Config, DirectionalLight, Error, Frame, Light, Lighting, Medium, PointLight, Translume,
    required_limits, wgpu,
};
use translume_mesh::warp::Axis;
use translume_mesh::{Skin, Warp};
use translume_tests::{Fixture, Model, Pose, creature, gpu, limb, sphere};

fn lamp() -> Light {
    Light::Point(PointLight {
        position: [0.0, 60.0, 150.0],
        intensity: [1e4; 3],
        shadow: false,
        ..Default::default()
    })
}

/// The text names the element, and the next good frame finds nothing changed.
#[track_caller]
fn refused(fixture: &mut Fixture, bad: &Frame<'_>, words: &[&str]) {
    let pose = Pose { warp: Warp { twist: 0.3, ..Warp::default() }, ..Pose::rest(1) };
    let lights = [lamp()];
    let good = pose.frame(&lights);
    fixture.run(&good);
    let before = fixture.exitance();
    let message = fixture.prepare(bad).expect_err(&format!("{words:?} was accepted")).to_string();
    assert!(words.iter().all(|word| message.contains(word)), "[{}] {message}", gpu().adapter_name);
    assert!(fixture.body.pending().is_empty(), "[{}] a refused frame left work", gpu().adapter_name);
    fixture.run(&good);
    assert_eq!(before, fixture.exitance(), "[{}] after: {message}", gpu().adapter_name);
}

#[test]
fn bad_frames_are_refused_by_name() {
    let mut fixture = Fixture::new(&creature(), |_| ());
    let pose = |weights: &[f32]| Pose { weights: weights.to_vec(), ..Pose::rest(1) };
    let lights = [lamp()];
    refused(&mut fixture, &pose(&[0.1, 0.2]).frame(&lights), &["2 morph weights", "1 target"]);
    refused(&mut fixture, &pose(&[f32::NAN]).frame(&lights), &["morph weight 0", "NaN"]);
    let flat = Pose { model: Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0)), ..Pose::rest(1) };
    refused(&mut fixture, &flat.frame(&lights), &["model matrix"]);
    let lost = Pose { model: Mat4::from_translation(Vec3::new(f32::NAN, 0.0, 0.0)), ..Pose::rest(1) };
    refused(&mut fixture, &lost.frame(&lights), &["model matrix"]);

    let black_hole = Light::Point(PointLight { intensity: [1.0, -1.0, 1.0], ..Default::default() });
    refused(&mut fixture, &pose(&[0.3]).frame(&[lamp(), black_hole]), &["light 1", "colour"]);
    let nowhere = Light::Point(PointLight { position: [f32::NAN; 3], ..Default::default() });
    refused(&mut fixture, &pose(&[0.3]).frame(&[nowhere]), &["light 0", "finite"]);
    let aimless = Light::Directional(DirectionalLight { to_light: [0.0; 3], ..Default::default() });
    refused(&mut fixture, &pose(&[0.3]).frame(&[aimless]), &["light 0", "direction"]);
    refused(&mut fixture, &pose(&[0.3]).frame(&[lamp(); 65]), &["65", "64"]);
    let near = Light::Point(PointLight { position: [0.0, 60.0, 60.0], ..Default::default() });
    refused(&mut fixture, &pose(&[0.3]).frame(&[near; 43]), &["258 depth maps", "256"]);
}

#[test]
fn bad_joints_and_warps_are_refused_by_name() {
    let mut fixture = Fixture::new(&limb(), |_| ());
    let joints = |joints: &[Mat4]| Pose {
        joints: joints.iter().map(Mat4::to_cols_array_2d).collect(),
        ..Pose::rest(1)
    };
    let warp = |change: fn(&mut Warp)| {
        let mut pose = Pose::rest(1);
        change(&mut pose.warp);
        pose
    };
    let lost = Mat4::from_translation(Vec3::new(0.0, f32::NAN, 0.0));
    let far = Mat4::from_scale(Vec3::splat(3e37));
    let bad: [(Pose, &[&str]); 9] = [
        (joints(&[Mat4::IDENTITY; 2]), &["2 joint matrices", "3 joints"]),
        (joints(&[Mat4::IDENTITY, lost, Mat4::IDENTITY]), &["joint 1", "NaN"]),
        (joints(&[Mat4::IDENTITY, Mat4::IDENTITY, far]), &["pose", "further"]),
        (warp(|warp| warp.twist = f32::NAN), &["warp.twist", "NaN"]),
        (warp(|warp| warp.twist = -1001.0), &["warp.twist", "-1001", "1000"]),
        (warp(|warp| warp.bend = f32::INFINITY), &["warp.bend", "inf"]),
        (warp(|warp| warp.inflate = f32::NAN), &["warp.inflate", "NaN"]),
        (warp(|warp| warp.axis = Some(Axis { foot: [0.0; 3], height: -1.0 })), &["warp.axis", "-1"]),
        (warp(|warp| warp.axis = Some(Axis { foot: [f32::NAN; 3], height: 1.0 })), &["warp.axis", "NaN"]),
    ];
    for (pose, words) in &bad {
        refused(&mut fixture, &pose.frame(&[lamp()]), words);
    }
    // The deformation is already made when the lights are refused.
    let black_hole = Light::Point(PointLight { intensity: [-1.0; 3], ..Default::default() });
    refused(&mut fixture, &warp(|warp| warp.bend = 1.0).frame(&[black_hole]), &["light 0"]);
    let near = Light::Point(PointLight { position: [0.0, 0.0, 60.0], ..Default::default() });
    refused(&mut fixture, &warp(|warp| warp.bend = 1.0).frame(&[near; 43]), &["258 depth maps"]);

    let mut rigid = Fixture::new(&creature(), |_| ());
    refused(&mut rigid, &joints(&[Mat4::IDENTITY]).frame(&[]), &["1 joint matrices", "0 joints"]);
}

#[test]
fn bad_skins_are_refused_by_name() {
    let refusal = |change: fn(&mut Skin)| {
        let mut model = (*limb()).clone();
        model.mesh.skin.iter_mut().for_each(change);
        Fixture::try_new(&Arc::new(model), |_| ()).err().map(|error| error.to_string())
    };
    assert_eq!(refusal(|_| ()), None);
    type Case = (fn(&mut Skin), &'static [&'static str]);
    let cases: [Case; 6] = [
        (|skin| skin.per_vertex = 0, &["0 for each"]),
        (|skin| skin.influences.truncate(9), &["9 influences", "2 for each of 642"]),
        (|skin| skin.influences[7].joint = 3, &["vertex 3", "joint 3", "there are 3"]),
        (|skin| skin.influences[7].weight = f32::NAN, &["vertex 3", "shares"]),
        (|skin| skin.influences[7].weight += 0.1, &["vertex 3", "shares"]),
        (
            |skin| {
                skin.influences[6].weight += 1.0;
                skin.influences[7].weight -= 1.0;
            },
            &["vertex 3", "shares"],
        ),
    ];
    for (change, words) in cases {
        let message = refusal(change).unwrap_or_default();
        assert!(words.iter().all(|word| message.contains(word)), "[{}] {message}", gpu().adapter_name);
    }
}

#[test]
fn sixty_four_lights_are_accepted() {
    let mut fixture = Fixture::new(&creature(), |_| ());
    let frame = Frame { lighting: Lighting::Lights(&[lamp(); 64]), ..Frame::default() };
    fixture.prepare(&frame).unwrap();
}

#[test]
fn a_bad_medium_is_refused_and_the_old_one_stays() {
    let mut fixture = Fixture::new(&creature(), |d| d.medium = Medium::JADE);
    let bad = Medium { sigma_a: [0.1, f32::NAN, 0.1], ..Medium::JADE };
    let message = fixture.body.set_medium(bad).unwrap_err().to_string();
    assert!(message.contains("sigma_a (green)"), "[{}] {message}", gpu().adapter_name);
    assert_eq!(*fixture.body.medium(), Medium::JADE);
    let message = Fixture::try_new(&creature(), |d| d.medium = bad).err().unwrap().to_string();
    assert!(message.contains("sigma_a (green)"), "[{}] {message}", gpu().adapter_name);
}

#[test]
fn bad_bodies_are_refused_by_name() {
    let stranger = Arc::new(Model { mesh: creature().mesh.clone(), atlas: sphere().atlas.clone() });
    let message = Fixture::try_new(&stranger, |_| ()).err().unwrap().to_string();
    assert!(
        message.contains("creature") && message.contains("another mesh"),
        "[{}] {message}",
        gpu().adapter_name
    );
    for scale in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let message = Fixture::try_new(&sphere(), |d| d.mm_per_unit = scale).err().unwrap().to_string();
        assert!(message.contains("mm per unit"), "[{}] {message}", gpu().adapter_name);
    }
    let message = Fixture::try_new(&sphere(), |d| d.shadows.resolution = 8).err().unwrap().to_string();
    assert!(message.contains("resolution is 8"), "[{}] {message}", gpu().adapter_name);
    Fixture::try_new(&sphere(), |d| d.shadows.resolution = 16).map(|_| ()).unwrap();
}

/// A device of the adapter under test with these limits and no feature.
fn device_with(required_limits: wgpu::Limits) -> wgpu::Device {
    let adapter = pollster::block_on(wgpu::util::initialize_adapter_from_env(&gpu().instance, None))
        .or_else(|_| {
            pollster::block_on(gpu().instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
        })
        .unwrap();
    let descriptor = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
    pollster::block_on(adapter.request_device(&descriptor)).unwrap().0
}

#[test]
fn a_device_is_told_all_that_it_lacks() {
    let poor = wgpu::Limits {
        max_storage_buffers_per_shader_stage: 4,
        max_uniform_buffer_binding_size: 16 << 10,
        ..wgpu::Limits::default()
    };
    let error = Translume::new(&device_with(poor), &Config::default()).map(|_| ()).unwrap_err();
    let text = error.to_string();
    for words in [
        "max_storage_buffers_per_shader_stage ≥ 8 (it has 4)",
        "max_uniform_buffer_binding_size ≥ ",
        "(it has 16384)",
    ] {
        assert!(text.contains(words), "{text}");
    }
    let Error::Device { missing } = error else { panic!("{error:?}") };
    assert_eq!(missing.len(), 2, "{missing:?}");
}

#[test]
fn the_least_device_that_is_asked_for_does() {
    let device = device_with(required_limits());
    let translume = Translume::new(&device, &Config::default()).unwrap();
    let model = creature();
    translume.create_body(&device, &BodyDescriptor::new(&model.mesh, &model.atlas)).unwrap();
}
