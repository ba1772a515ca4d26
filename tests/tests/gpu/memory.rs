//! What bodies take of the device's memory, what they share, and what they give back.

use translume::{
    AmbientLight, Body, BodyDescriptor, Config, DirectionalLight, Error, Evaluate, Frame, Levels, Light,
    Lighting, Medium, Method, PointLight, Profile, ShadowOptions, Stage, Translume, View, Work, wgpu,
};
use translume_tests::{
    Check, Fixture, Model, Pose, Shot, at_most, creature, gpu, holds, notices, relative_rmse, sphere,
};

fn lights() -> [Light; 3] {
    let sun = DirectionalLight { to_light: [0.3, 0.8, -0.6], ..Default::default() };
    let lamp = PointLight { position: [60.0, 120.0, 90.0], intensity: [9e3; 3], ..Default::default() };
    let sky = AmbientLight { shadow: true, ..Default::default() };
    [Light::Directional(sun), Light::Point(lamp), Light::Ambient(sky)]
}

fn lit(lights: &[Light]) -> Frame<'_> {
    Frame { lighting: Lighting::Lights(lights), ..Frame::default() }
}

/// Small maps of its own.
fn descriptor<'a>(model: &'a Model, shares_scratch: bool) -> BodyDescriptor<'a> {
    BodyDescriptor {
        mm_per_unit: 1.0,
        shares_scratch,
        profile: Profile::DipoleNormalised,
        shadows: ShadowOptions { resolution: 256, direction_resolution: 32, ..Default::default() },
        ..BodyDescriptor::new(&model.mesh, &model.atlas)
    }
}

fn exitance(body: &Body) -> Vec<[f64; 3]> {
    let texels: Vec<[f32; 4]> =
        translume::readback::buffer(&gpu().device, &gpu().queue, body.outputs().exitance).unwrap();
    texels.iter().map(|&[r, g, b, _]| [r, g, b].map(f64::from)).collect()
}

fn submit(record: impl FnOnce(&mut wgpu::CommandEncoder)) {
    let mut encoder = gpu().device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    record(&mut encoder);
    gpu().queue.submit([encoder.finish()]);
}

/// What bodies that take turns compute against bodies on their own, of several shapes, sizes and lights, all in one submission.
fn turns(translume: &Translume, change: impl Fn(&mut Body)) -> Check {
    let models = [creature(), sphere(), creature()];
    let all = lights();
    let lights = [&all[..], &all[..1], &all[1..]];
    let make = |shares| -> Vec<Body> {
        let body = |model| translume.create_body(&gpu().device, &descriptor(model, shares)).unwrap();
        models.iter().map(|model| body(model)).collect()
    };
    let [mut own, mut sharing] = [make(false), make(true)];
    for bodies in [&mut own, &mut sharing] {
        // Twice, for the second and third make the first one's scratch memory grow.
        for _ in 0..2 {
            bodies.iter_mut().zip(lights).for_each(|(body, lights)| {
                body.prepare(&gpu().device, &gpu().queue, &lit(lights)).unwrap();
            });
            submit(|encoder| bodies.iter_mut().for_each(|body| _ = body.encode(encoder)));
        }
        // The index of refraction gathers anew, without a light that moved.
        for (body, lights) in bodies.iter_mut().zip(lights) {
            body.set_medium(Medium { ior: 1.2, ..Medium::SKIN1 }).unwrap();
            body.prepare(&gpu().device, &gpu().queue, &lit(lights)).unwrap();
        }
    }
    submit(|encoder| own.iter_mut().for_each(|body| _ = body.encode(encoder)));
    sharing.iter_mut().for_each(change);
    // Stages of several bodies may alternate.
    submit(|encoder| sharing.iter_mut().for_each(|body| _ = body.encode_through(encoder, Stage::Shadow)));
    submit(|encoder| sharing.iter_mut().for_each(|body| _ = body.encode(encoder)));
    for (own, sharing) in own.iter().zip(&sharing) {
        // The same arithmetic on the same numbers; lists that run over are walked in another order.
        at_most("sharing scratch memory", relative_rmse(&exitance(sharing), &exitance(own)), 1e-5)?;
    }
    let [own, sharing] =
        [own, sharing].map(|bodies| bodies.iter().map(|body| body.memory().total()).sum::<u64>());
    at_most("memory of bodies that share, of what others have", sharing as f64 / own as f64, 0.8)
}

#[test]
fn bodies_that_take_turns_compute_the_same_in_less_memory() {
    let translume = Translume::new(&gpu().device, &Config::default()).unwrap();
    holds(turns(&translume, |_| ()));
    assert!(translume.memory() > 0, "scratch memory stays");
    notices(turns(&translume, |body| {
        body.set_medium(Medium::MARBLE).map(|()| body.trim(&gpu().device)).unwrap();
    }));
}

#[test]
fn memory_is_counted_and_given_back() {
    let translume = Translume::new(&gpu().device, &Config::default()).unwrap();
    assert_eq!(translume.memory(), 0);
    let (model, lights) = (creature(), lights());
    let mut body = translume.create_body(&gpu().device, &descriptor(&model, false)).unwrap();
    let created = body.memory();
    assert_eq!(translume.memory(), created.total());
    body.prepare(&gpu().device, &gpu().queue, &lit(&lights)).unwrap();
    submit(|encoder| _ = body.encode(encoder));
    let lit_once = body.memory();
    assert_eq!(translume.memory(), lit_once.total());
    // Two maps of 256² and one of (4·32)² for the sky; four bits for each texel and direction; lists of 32 words a texel.
    let texels = u64::from(body.texels());
    assert!(lit_once.shadows >= created.shadows + 4 * 256 * 256 + 64 / 2 * texels, "{lit_once:?}");
    assert!(lit_once.scatter >= created.scatter + 4 * 32 * texels, "{lit_once:?}");
    assert_eq!((lit_once.mesh, lit_once.atlas), (created.mesh, created.atlas));

    let before = exitance(&body);
    body.trim(&gpu().device);
    assert!(body.memory().total() < created.total(), "not even a first depth map");
    assert_eq!(translume.memory(), body.memory().total());
    submit(|encoder| assert_eq!(body.encode(encoder), Work::default()));
    assert_eq!(exitance(&body), before, "[{}] what is trimmed can be drawn", gpu().adapter_name);
    body.prepare(&gpu().device, &gpu().queue, &lit(&lights)).unwrap();
    submit(|encoder| _ = body.encode(encoder));
    holds(at_most("after trimming", relative_rmse(&exitance(&body), &before), 1e-5));
    assert_eq!(body.memory(), lit_once);
    drop(body);
    assert_eq!(translume.memory(), 0);
}

#[test]
fn a_budget_is_kept() {
    let device = &gpu().device;
    let model = creature();
    let body_alone = Fixture::new(&model, |d| *d = descriptor(&model, false)).body.memory().total();
    let budget = body_alone + 100_000;
    let translume = Translume::new(device, &Config { memory: Some(budget) }).unwrap();
    let mut body = translume.create_body(device, &descriptor(&model, false)).unwrap();
    let error = translume.create_body(device, &descriptor(&model, false)).map(|_| ()).unwrap_err();
    assert_eq!(error, Error::Memory { required: body_alone, available: 100_000, budget });
    assert!(error.to_string().contains("trim"), "{error}");

    // All pairs need no lists; the sky does need memory of its own, and the refused frame leaves the last as it was.
    body.set_method(Method::AllPairs).unwrap();
    let (all, frames) = (lights(), [lit(&[]), lit(&[])]);
    body.prepare(device, &gpu().queue, &Frame { lighting: Lighting::Lights(&all[..1]), ..frames[0] })
        .unwrap();
    submit(|encoder| _ = body.encode(encoder));
    let before = exitance(&body);
    let refused = body.prepare(device, &gpu().queue, &lit(&all));
    assert!(matches!(refused, Err(Error::Memory { .. })), "{refused:?}");
    submit(|encoder| assert_eq!(body.encode(encoder), Work::default()));
    assert_eq!(exitance(&body), before);
    assert!(translume.memory() <= budget);
    drop(body);
    translume.create_body(device, &descriptor(&model, false)).unwrap();
}

#[test]
fn a_body_that_shared_lists_may_ask_for_its_own() {
    // The larger body makes shared lists that outweigh all that the smaller one has.
    let (large, small) = (translume_tests::sphere_with(128), translume_tests::sphere_with(24));
    let translume = Translume::new(&gpu().device, &Config { memory: Some(1 << 30) }).unwrap();
    let mut bodies = [&large, &small].map(|model| {
        translume
            .create_body(&gpu().device, &BodyDescriptor { list_entries: 1024, ..descriptor(model, true) })
            .unwrap()
    });
    for body in &mut bodies {
        body.prepare(&gpu().device, &gpu().queue, &lit(&[])).unwrap();
    }
    let [_, small] = &mut bodies;
    let before = small.memory().scatter;
    small.set_evaluate(Evaluate::PerVertex).unwrap();
    small.prepare(&gpu().device, &gpu().queue, &lit(&[])).unwrap();
    assert!(small.memory().scatter > before + 4 * 1024 * u64::from(small.texels()), "lists of its own");
}

#[test]
fn levels_follow_the_size_in_the_picture() {
    let device = &gpu().device;
    let fine = translume_tests::sphere_with(64);
    let coarse = translume_tests::sphere_with(24);
    let body = |model| gpu().translume.create_body(device, &descriptor(model, true)).unwrap();
    let mut levels = Levels::new(vec![body(&coarse), body(&fine)]);
    assert!(levels.bodies()[0].texels() > levels.bodies()[1].texels(), "from fine to coarse");
    let view = |distance: f32, target: [f32; 3]| {
        let shot = Shot { eye: [0.0, 0.0, distance], target, fov: 0.6, size: 256 };
        View { camera: shot.camera(), pixels: [256; 2] }
    };
    let texels = |levels: &mut Levels, view: &View| levels.pick(view).map(|body| body.texels());
    let [near, far] = [view(300.0, [0.0; 3]), view(6000.0, [0.0; 3])];
    let [most, least] = [levels.bodies()[0].texels(), levels.bodies()[1].texels()];
    assert_eq!(texels(&mut levels, &near), Some(most));
    assert_eq!(texels(&mut levels, &far), Some(least));
    assert_eq!(texels(&mut levels, &near), Some(most));
    assert_eq!(texels(&mut levels, &view(300.0, [0.0, 0.0, 600.0])), None, "behind the eye");
    // 100 mm in a picture that is 186 mm wide at the body's near side, 250 mm away: 256² · (100/155)².
    let expected = 65_536.0 * (100.0_f32 / (2.0 * 250.0 * 0.3_f32.tan())).powi(2);
    let covered = levels.bodies()[0].covered(&near);
    assert!((covered / expected - 1.0).abs() < 1e-3, "{covered} against {expected}");
    assert!(Levels::new(Vec::new()).pick(&near).is_none());
}

#[test]
fn points_keep_their_lists() {
    let model = creature();
    let shot = Shot { eye: [60.0, 80.0, 240.0], target: [0.0, 50.0, 0.0], fov: 0.5, size: 64 };
    let all = lights();
    for evaluate in [Evaluate::PerVertex, Evaluate::PerFragment, Evaluate::PerTexel] {
        let picture = |shares| {
            let mut fixture = Fixture::new(&model, |d| {
                *d = BodyDescriptor { evaluate, ..descriptor(&model, shares) };
            });
            let mut other = Fixture::new(&model, |d| *d = descriptor(&model, shares));
            fixture.run(&Pose::rest(1).frame(&all));
            // Another body writes over what is shared before the picture is drawn.
            other.run(&Pose::rest(1).frame(&all[..1]));
            let pixels: Vec<_> =
                shot.take(&fixture).iter().map(|&[r, g, b, _]| [r, g, b].map(f64::from)).collect();
            pixels
        };
        assert_eq!(picture(true), picture(false), "[{}] {evaluate:?}", gpu().adapter_name);
    }
}
