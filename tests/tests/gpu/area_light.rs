//! Rectangle and sphere lights against the twin, which has them in closed form and casts rays for their shadows.

use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;
use translume::{DirectionalLight, Light, Medium, PointLight, RectangleLight, SphereLight};
use translume_reference::gather::Source;
use translume_tests::{
    Check, Fixture, Model, Pose, at_least, at_most, creature, gpu, holds, luminous, notices, relative_rmse,
    rmse_by_area, sphere,
};

fn rest(model: &Model) -> Pose {
    Pose::rest(model.mesh.targets.len())
}

fn lit_with(model: &Arc<Model>, ior: f32, area_points: u32, lights: &[Light]) -> Fixture {
    let mut fixture = Fixture::new(model, |d| {
        d.medium = Medium { ior, ..Medium::MARBLE };
        d.shadows.area_points = area_points;
        d.shadows.resolution = 1024;
    });
    fixture.light(&rest(model).frame(lights));
    fixture
}

fn lit(model: &Arc<Model>, ior: f32, lights: &[Light]) -> Vec<[f64; 3]> {
    lit_with(model, ior, 16, lights).irradiance()
}

/// A square that shines from `center` towards `target`.
fn facing(center: [f32; 3], target: [f32; 3], half: f32, shadow: bool) -> RectangleLight {
    let axis = (Vec3::from(target) - Vec3::from(center)).normalize();
    let right = axis.any_orthonormal_vector() * half;
    RectangleLight {
        center,
        half_right: right.to_array(),
        half_up: axis.cross(right).to_array(),
        radiance: [3.0, 2.0, 1.0],
        shadow,
    }
}

fn bulb(center: [f32; 3], radius: f32, shadow: bool) -> Light {
    Light::Sphere(SphereLight { center, radius, radiance: [1.0, 2.0, 3.0], shadow })
}

/// A window at some distance, a wall that most horizons cut, a bulb, and a balloon that is as large as the body.
fn lights(shadow: bool) -> [(&'static str, Light); 4] {
    let rectangle = |center, half| Light::Rectangle(facing(center, [0.0, 40.0, 0.0], half, shadow));
    [
        ("window", rectangle([60.0, 80.0, 110.0], 30.0)),
        ("wall", rectangle([10.0, 50.0, 90.0], 200.0)),
        ("bulb", bulb([-70.0, 90.0, 80.0], 15.0, shadow)),
        ("balloon", bulb([20.0, 160.0, 40.0], 50.0, shadow)),
    ]
}

fn follows(model: &Arc<Model>, ior: f32, (name, light): (&str, Light), twin: Light) -> Check {
    let fixture = lit_with(model, ior, 16, &[light]);
    let twin = luminous(&fixture.twin_sources(&rest(model), &[twin], 2));
    // The same closed form in single precision at η = 1. Fresnel's share comes from 16 points: where the horizon cuts a light, one by one.
    let bound = if ior == 1.0 { 1e-3 } else { 0.02 };
    at_most(
        &format!("area light: {name} on {}, η {ior}, relative RMSE", model.mesh.name),
        relative_rmse(&fixture.irradiance(), &twin),
        bound,
    )
}

#[test]
fn unshadowed_light_follows_the_twin() {
    for model in [creature(), sphere()] {
        for ior in [1.0, 1.3] {
            for light in lights(false) {
                holds(follows(&model, ior, light, light.1));
            }
        }
    }
    let larger = bulb([-70.0, 90.0, 80.0], 15.3, false);
    notices(follows(&sphere(), 1.3, lights(false)[2], larger));
    let Light::Rectangle(mut wall) = lights(false)[1].1 else { panic!("the wall is a rectangle") };
    wall.center[2] += 0.5;
    notices(follows(&sphere(), 1.0, lights(false)[1], Light::Rectangle(wall)));
}

/// Each texel's share of light that it must not have.
fn dark(values: &[[f64; 3]]) -> Check {
    at_most(
        "area light: light where there is none",
        values.iter().flatten().copied().fold(0.0, f64::max),
        0.0,
    )
}

#[test]
fn a_rectangle_is_dark_from_behind() {
    for shadow in [false, true] {
        let front = facing([0.0, 48.0, 150.0], [0.0, 48.0, 0.0], 40.0, shadow);
        let back = RectangleLight { half_right: front.half_right.map(|x| -x), ..front };
        holds(dark(&lit(&creature(), 1.3, &[Light::Rectangle(back)])));
        notices(dark(&lit(&creature(), 1.3, &[Light::Rectangle(front)])));
    }
}

#[test]
fn a_sphere_is_dark_inside() {
    for shadow in [false, true] {
        let around = |radius| lit(&sphere(), 1.3, &[bulb([0.0; 3], radius, shadow)]);
        holds(dark(&around(60.0)));
        // The part of the body that sticks out of it still sees none of it: its horizon is in the way.
        let beside = lit_with(&sphere(), 1.3, 16, &[bulb([0.0, 80.0, 0.0], 60.0, shadow)]);
        let sources = beside.sources();
        // Four points of a texel lie up to its width from its middle.
        let inside =
            |s: &&Source| DVec3::from(s.position).distance(DVec3::Y * 80.0) < 60.0 - 2.0 * s.area.sqrt();
        let within: Vec<_> = sources.iter().filter(inside).map(|s| s.irradiance).collect();
        assert!(within.len() > 20, "[{}] {} texels are inside", gpu().adapter_name, within.len());
        holds(dark(&within));
        notices(dark(&beside.irradiance()));
    }
}

/// From far away a light of some size is as good as parallel light or a point.
fn alike(what: &str, area: Light, plain: Light, bound: f64) -> Check {
    let [area, plain] = [area, plain].map(|light| lit(&sphere(), 1.3, &[light]));
    at_most(what, relative_rmse(&area, &plain), bound)
}

#[test]
fn far_lights_are_points_or_parallel() {
    let direction = Vec3::new(2.0, 3.0, 6.0) / 7.0;
    let sun = |distance: f32, area: f32, radiance: [f32; 3]| {
        Light::Directional(DirectionalLight {
            to_light: direction.to_array(),
            irradiance: radiance.map(|l| l * area / (distance * distance)),
            ..Default::default()
        })
    };
    for distance in [1e4_f32, 1e6] {
        let center = (direction * distance).to_array();
        let half = 0.01 * distance;
        let window = facing(center, [0.0; 3], half, true);
        let parallel = sun(distance, 4.0 * half * half, window.radiance);
        // Parts of the body are up to 50 mm nearer, twice that in the square; the light itself is 1/100 of the distance wide.
        let bound = 2.0 * 50.0 / f64::from(distance) + 1e-3;
        holds(alike("area light: far window", Light::Rectangle(window), parallel, bound));
        let disc = std::f32::consts::PI * half * half;
        let parallel = sun(distance, disc, [1.0, 2.0, 3.0]);
        holds(alike("area light: far bulb", bulb(center, half, true), parallel, bound));
        let other = sun(distance, 1.05 * disc, [1.0, 2.0, 3.0]);
        notices(alike("area light: another bulb", bulb(center, half, true), other, bound));
    }
    let point = |intensity: f32| {
        let intensity = [1.0, 2.0, 3.0].map(|l| l * intensity);
        Light::Point(PointLight { position: [90.0, 120.0, 0.0], intensity, shadow: false, region: None })
    };
    let small = bulb([90.0, 120.0, 0.0], 1.0, false);
    // The next term is of the order of (1/100)².
    holds(alike("area light: small bulb", small, point(std::f32::consts::PI), 2e-3));
    notices(alike("area light: stronger point", small, point(1.01 * std::f32::consts::PI), 2e-3));
}

/// Finite, not negative, and no brighter than a sky that is all light.
fn bounded(what: &str, values: &[[f64; 3]], radiance: f64) -> Check {
    let least = values.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let finite = values.iter().flatten().all(|x| x.is_finite());
    at_least(&format!("{what}: least"), if finite { least } else { f64::NAN }, 0.0)?;
    let most = values.iter().flatten().copied().fold(0.0, f64::max);
    // Closed forms in single precision; measured 2e-5 more than π times the radiance at most.
    at_most(&format!("{what}: most"), most / (PI * radiance), 1.0 + 1e-4)
}

#[test]
fn lights_at_and_in_the_body_stay_bounded() {
    for (ior, shadow) in [(1.0, false), (1.0, true), (1.3, true)] {
        for height in [50.0 + 1e-3, 50.0, 49.9, 0.0] {
            let window = facing([0.0, height, 0.0], [0.0, -100.0, 0.0], 30.0, shadow);
            let across = facing([0.0, height, 0.0], [100.0, height, 0.0], 30.0, shadow);
            let lights =
                [Light::Rectangle(window), Light::Rectangle(across), bulb([0.0, height, 0.0], 5.0, shadow)];
            for light in lights {
                holds(bounded(&format!("area light at {height}"), &lit(&sphere(), ior, &[light]), 3.0));
            }
        }
    }
    let near = facing([0.0, 51.0, 0.0], [0.0; 3], 30.0, false);
    notices(bounded("area light: too bright", &lit(&sphere(), 1.0, &[Light::Rectangle(near)]), 2.0));
}

/// The same scene in metres and in millimetres.
fn in_metres(change: f32, shadow: bool) -> Check {
    let mut metres = Fixture::new(&sphere(), |d| d.mm_per_unit = 1000.0);
    let mut millimetres = Fixture::new(&sphere(), |_| ());
    let window = facing([60.0, 80.0, 110.0], [0.0; 3], 30.0, shadow);
    let [one, other] = [1.0, change].map(|factor| {
        let window = RectangleLight { half_right: window.half_right.map(|x| x * factor), ..window };
        [Light::Rectangle(window), bulb([-70.0, 40.0, 60.0], 15.0 * factor, shadow)]
    });
    let pose = Pose::rest(0);
    metres.light(&pose.frame(&one));
    millimetres.light(&pose.frame(&other));
    // Roundings, and looks into a map that they push across an edge.
    at_most("area light: metres", relative_rmse(&metres.irradiance(), &millimetres.irradiance()), 1e-3)
}

#[test]
fn the_unit_of_length_does_not_matter() {
    for shadow in [false, true] {
        holds(in_metres(1.0, shadow));
        notices(in_metres(1.01, shadow));
    }
}

fn shadowed(light: Light, twin: &[Source], area_points: u32) -> f64 {
    rmse_by_area(&lit_with(&creature(), 1.3, area_points, &[light]).irradiance(), twin)
}

#[test]
fn shadows_follow_traced_rays() {
    for ((name, light), (_, open)) in lights(true).into_iter().zip(lights(false)) {
        let twin = lit_with(&creature(), 1.3, 16, &[open]).twin_sources_lit(
            &rest(&creature()),
            &[translume_tests::light(&light, 1.0)],
            [2, 8],
        );
        let check = |light, points| {
            let error = shadowed(light, &twin, points);
            at_most(&format!("area light: shadow of the {name}, {points} points, relative RMSE"), error, 0.1)
        };
        holds(check(light, 16));
        let [few, many] = [4, 16].map(|points| shadowed(light, &twin, points));
        holds(at_most(&format!("area light: {name}, 16 points over 4"), many / few, 1.0));
        notices(check(open, 16));
    }
}
