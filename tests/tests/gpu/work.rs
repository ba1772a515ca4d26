//! How much a frame records, and what shadows of other fineness or renewed bit by bit amount to.

use glam::{Mat4, Vec3};
use translume::{
    AmbientLight, DirectionalLight, EnvironmentLight, Light, PointLight, RectangleLight, ShadowOptions,
    SphereLight, SpotLight, Stage, Work,
};
use translume_tests::{Fixture, Pose, at_most, creature, gpu, holds, notices, relative_rmse};

fn sun(x: f32) -> Light {
    Light::Directional(DirectionalLight { to_light: [x, 0.8, 0.6], ..Default::default() })
}

fn lamp(x: f32) -> Light {
    Light::Point(PointLight { position: [x, 60.0, 150.0], intensity: [1e4; 3], ..Default::default() })
}

fn window(x: f32) -> Light {
    Light::Rectangle(RectangleLight {
        center: [x, 60.0, 150.0],
        half_right: [-20.0, 0.0, 0.0],
        half_up: [0.0, 20.0, 0.0],
        ..Default::default()
    })
}

fn bulb(x: f32) -> Light {
    Light::Sphere(SphereLight { center: [x, 160.0, 90.0], radius: 10.0, ..Default::default() })
}

fn spot(x: f32) -> Light {
    Light::Spot(SpotLight { position: [x, 220.0, 30.0], intensity: [3e4; 3], ..Default::default() })
}

fn sky(shadow: bool) -> Light {
    Light::Ambient(AmbientLight { shadow, ..Default::default() })
}

fn environment(tilt: f32) -> Light {
    let mut light = EnvironmentLight { shadow: false, ..Default::default() };
    (light.coefficients[0], light.coefficients[3]) = ([2.0, 1.5, 1.0], [tilt; 3]);
    Light::Environment(light)
}

fn melted(weight: f32) -> Pose {
    Pose { weights: vec![weight], ..Pose::rest(1) }
}

fn fixture() -> Fixture {
    // Small maps: what counts here is how many.
    Fixture::new(&creature(), |d| (d.shadows.resolution, d.shadows.direction_resolution) = (128, 64))
}

#[test]
fn a_frame_records_what_changed_and_no_more() {
    let mut fixture = fixture();
    let pose = melted(0.0);
    let mut work = |pose: &Pose, lights: &[Light]| {
        let work = fixture.light(&pose.frame(lights));
        assert_eq!(fixture.light(&pose.frame(lights)), Work::default(), "{lights:?} once more");
        work
    };
    let deform = work(&pose, &[]).dispatches - 1;
    assert!(deform > 0, "[{}] {deform}", gpu().adapter_name);
    let relit = |draws| Work { draws, dispatches: 1 };
    // One dispatch gathers whatever there is, and a light draws its own views only.
    assert_eq!(work(&pose, &[sun(0.3)]), relit(1));
    assert_eq!(work(&pose, &[sun(0.4)]), relit(1));
    assert_eq!(work(&pose, &[lamp(0.0)]), relit(1));
    assert_eq!(work(&pose, &[window(0.0)]), relit(16));
    assert_eq!(work(&pose, &[window(0.0), bulb(0.0), sun(0.3)]), relit(33));
    assert_eq!(work(&pose, &[sky(false)]), relit(0));
    assert_eq!(work(&pose, &[sky(false), environment(0.1)]), relit(0));
    // The sky is looked at from 64 directions, eight to a dispatch, when it is first needed and when the body has moved.
    let looked = Work { draws: 64 + 1, dispatches: 8 + 1 };
    assert_eq!(work(&pose, &[sky(true), sun(0.3)]), looked);
    assert_eq!(work(&pose, &[sky(true), sun(0.4)]), relit(1));
    assert_eq!(work(&pose, &[sun(0.3)]), relit(1));
    assert_eq!(work(&pose, &[sky(true)]), relit(0), "nothing has moved since");
    let moved = Work { draws: 64, dispatches: deform + 8 + 1 };
    assert_eq!(work(&melted(0.3), &[sky(true)]), moved);
    let elsewhere = Pose { model: Mat4::from_translation(Vec3::X), ..melted(0.3) };
    assert_eq!(work(&elsewhere, &[sky(true)]), moved);
    // A move in other light is made up for when the sky is shadowed again.
    assert_eq!(work(&pose, &[sun(0.3)]), Work { draws: 1, dispatches: deform + 1 });
    assert_eq!(work(&pose, &[sky(true), sun(0.3)]), looked);
}

/// Sixteen lights of every kind, one of them shadowed light of the sky.
fn sixteen() -> Vec<Light> {
    let x = |k: u32| 30.0 * k as f32 - 40.0;
    let mut lights = vec![sky(true), sky(false), environment(0.2), environment(-0.1)];
    for k in 0..3 {
        lights.extend([sun(0.4 * k as f32 - 0.3), lamp(x(k)), spot(x(k))]);
    }
    lights.extend([window(0.0), bulb(-40.0), bulb(40.0)]);
    lights
}

#[test]
fn sixteen_lights_add_up() {
    let (pose, mut fixture, lights) = (melted(0.0), fixture(), sixteen());
    assert_eq!(lights.len(), 16);
    let mut show = |lights: &[Light]| {
        fixture.light(&pose.frame(lights));
        fixture.irradiance()
    };
    let mut sum = vec![[0.0; 3]; creature().atlas.texels.len()];
    for light in &lights {
        for (sum, one) in sum.iter_mut().zip(show(&[*light])) {
            *sum = std::array::from_fn(|k| sum[k] + one[k]);
        }
    }
    let mut check = |joint: &[Light]| {
        // Single precision; measured 6e-8.
        at_most("work: sixteen lights against each alone", relative_rmse(&show(joint), &sum), 1e-5)
    };
    holds(check(&lights));
    for without in 0..16 {
        let rest: Vec<_> =
            lights.iter().enumerate().filter(|(k, _)| *k != without).map(|(_, l)| *l).collect();
        notices(check(&rest));
    }
}

fn mixed() -> [Light; 4] {
    [sun(0.3), window(0.0), bulb(30.0), sky(true)]
}

/// Any option may change from frame to frame, and leaves nothing of the former behind.
#[test]
fn other_options_are_as_good_as_new() {
    let usual = *fixture().body.shadows();
    let others = [
        ShadowOptions { resolution: 64, ..usual },
        ShadowOptions { filter: 1, ..usual },
        ShadowOptions { area_points: 4, ..usual },
        ShadowOptions { area_points: 25, resolution: 512, ..usual },
        ShadowOptions { directions: 16, ..usual },
        ShadowOptions { direction_resolution: 32, ..usual },
        usual,
    ];
    let (pose, lights) = (melted(0.2), mixed());
    let mut changed = fixture();
    changed.light(&pose.frame(&lights));
    let mut before = changed.irradiance();
    for options in others {
        changed.body.set_shadows(options).unwrap();
        assert_eq!(*changed.body.shadows(), options);
        assert_ne!(changed.light(&pose.frame(&lights)), Work::default(), "{options:?}");
        let mut fresh = Fixture::new(&creature(), |d| d.shadows = options);
        fresh.light(&pose.frame(&lights));
        assert_eq!(changed.irradiance(), fresh.irradiance(), "[{}] {options:?}", gpu().adapter_name);
        assert_ne!(changed.irradiance(), before, "[{}] {options:?} change nothing", gpu().adapter_name);
        before = changed.irradiance();
    }
    changed.body.set_shadows(usual).unwrap();
    assert_eq!(changed.light(&pose.frame(&lights)), Work::default(), "the same options once more");
    let bad = changed.body.set_shadows(ShadowOptions { directions: 12, ..usual }).unwrap_err().to_string();
    assert!(bad.contains("directions is 12"), "[{}] {bad}", gpu().adapter_name);
    assert_eq!(*changed.body.shadows(), usual);
}

/// A body that renews 8 of 32 directions in a frame.
fn thrifty() -> Fixture {
    Fixture::new(&creature(), |d| {
        (d.shadows.directions, d.shadows.directions_per_frame) = (32, 8);
        d.shadows.direction_resolution = 64;
    })
}

fn looks(fixture: &mut Fixture, pose: &Pose, lights: &[Light]) -> bool {
    fixture.prepare(&pose.frame(lights)).unwrap();
    fixture.body.pending().contains(Stage::Visibility)
}

#[test]
fn the_sky_may_be_renewed_over_several_frames() {
    let (first, second, lights) = (melted(0.0), melted(0.8), [sky(true)]);
    let whole = |pose: &Pose| {
        let mut fixture = Fixture::new(&creature(), |d| {
            (d.shadows.directions, d.shadows.direction_resolution) = (32, 64);
        });
        fixture.light(&pose.frame(&lights));
        fixture.irradiance()
    };
    let mut fixture = thrifty();
    // The first frame has nothing to keep.
    assert_eq!(fixture.light(&first.frame(&lights)).draws, 32);
    assert_eq!(fixture.irradiance(), whole(&first), "[{}]", gpu().adapter_name);
    assert!(!looks(&mut fixture, &first, &lights));

    let expected = whole(&second);
    for frame in 0..4 {
        assert!(looks(&mut fixture, &second, &lights), "frame {frame} has something left to renew");
        let work = fixture.light(&second.frame(&lights));
        assert_eq!(work.draws, 8, "frame {frame}");
        assert_eq!(fixture.irradiance() == expected, frame == 3, "[{}] frame {frame}", gpu().adapter_name);
    }
    assert!(!looks(&mut fixture, &second, &lights));
    assert_eq!(fixture.light(&second.frame(&lights)), Work::default());

    // A move in between starts again with what is oldest, and other light does not.
    fixture.light(&first.frame(&lights));
    fixture.light(&second.frame(&lights));
    for frame in 0..3 {
        let other = [sky(true), sun(0.1 * frame as f32)];
        assert_eq!(fixture.light(&second.frame(&other)).draws, 8 + 1, "frame {frame}");
    }
    assert_eq!(fixture.light(&second.frame(&lights)).draws, 0);
    assert_eq!(fixture.irradiance(), expected, "[{}]", gpu().adapter_name);
}

/// What is left to renew stays so while the sky is out of sight.
#[test]
fn what_is_left_to_renew_waits() {
    let (first, second, lights) = (melted(0.0), melted(0.8), [sky(true)]);
    let mut fixture = thrifty();
    fixture.light(&first.frame(&lights));
    fixture.light(&second.frame(&lights));
    assert_eq!(fixture.light(&second.frame(&[sun(0.3)])).draws, 1);
    assert_eq!(fixture.light(&second.frame(&[sun(0.3)])), Work::default());
    // A frame that is prepared but not encoded renews nothing.
    for _ in 0..5 {
        assert!(looks(&mut fixture, &second, &lights));
    }
    for frame in 0..3 {
        assert_eq!(fixture.light(&second.frame(&lights)).draws, 8, "frame {frame}");
    }
    assert_eq!(fixture.light(&second.frame(&lights)), Work::default());
    // A camera that shows parts of a frame may leave the rest for later.
    fixture.run(&first.frame(&lights));
    let pending = fixture.body.pending();
    assert!(pending.is_empty(), "[{}] {pending:?}", gpu().adapter_name);
}
