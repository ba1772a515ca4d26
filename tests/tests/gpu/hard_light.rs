//! Hard cases of light: whatever shines, from wherever, irradiance is finite, not negative, and bounded.

use glam::{Mat4, Vec3};
use std::f32::consts::PI;
use std::sync::Arc;
use translume::{
    AmbientLight, DirectionalLight, EnvironmentLight, Light, Medium, PointLight, RectangleLight, SphereLight,
    SpotLight,
};
use translume_mesh::{MorphTarget, builtin};
use translume_tests::{
    Check, Fixture, Model, Pose, at_most, cuboids, gpu, holds, notices, relative_rmse, sphere_with,
};

/// A light of each kind, for a body of radius 50 around the origin, with the most that it may bring anywhere.
fn kinds() -> Vec<(&'static str, Light, f64)> {
    let pi = std::f64::consts::PI;
    let sun = DirectionalLight { to_light: [0.3, 0.8, 0.5], irradiance: [2.0; 3], ..Default::default() };
    // 70 mm from the surface.
    let lamp = PointLight { position: [0.0, 0.0, 120.0], intensity: [4900.0; 3], ..Default::default() };
    let spot = SpotLight { position: [0.0, 120.0, 0.0], intensity: [4900.0; 3], ..Default::default() };
    let window = RectangleLight {
        center: [0.0, 0.0, -90.0],
        half_right: [60.0, 0.0, 0.0],
        half_up: [0.0, 60.0, 0.0],
        ..Default::default()
    };
    let bulb = SphereLight { center: [90.0, 10.0, 0.0], radius: 35.0, ..Default::default() };
    let sky = |half_angle| {
        Light::Ambient(AmbientLight { half_angle, axis: [0.1, 1.0, 0.2], shadow: true, ..Default::default() })
    };
    let mut environment = EnvironmentLight::default();
    // Radiance from 0.2 to 1.8.
    (environment.coefficients[0], environment.coefficients[2]) = ([1.0 / 0.282_095; 3], [0.8 / 0.488_603; 3]);
    vec![
        ("sun", Light::Directional(sun), 2.0),
        ("lamp", Light::Point(lamp), 1.0),
        ("spot", Light::Spot(spot), 1.0),
        ("window", Light::Rectangle(window), pi),
        ("bulb", Light::Sphere(bulb), pi),
        ("sky", sky(PI), pi),
        ("part of the sky", sky(0.3), pi),
        ("environment", Light::Environment(environment), 1.8 * pi),
    ]
}

fn lit(model: &Arc<Model>, ior: f32, pose: &Pose, lights: &[Light]) -> Vec<[f64; 3]> {
    let mut fixture = Fixture::new(model, |d| {
        d.medium = Medium { ior, ..Medium::MARBLE };
        (d.shadows.resolution, d.shadows.direction_resolution) = (128, 64);
    });
    fixture.light(&pose.frame(lights));
    fixture.irradiance()
}

/// Finite, not negative and at most so much.
fn bounded(what: &str, values: &[[f64; 3]], most: f64) -> Check {
    let wrong = values.iter().flatten().filter(|x| !(0.0..=1e30).contains(*x)).count();
    at_most(&format!("{what}: values that are negative or not finite"), wrong as f64, 0.0)?;
    // Closed forms and tables in single precision.
    at_most(
        &format!("{what}: most"),
        values.iter().flatten().copied().fold(0.0, f64::max),
        most * (1.0 + 1e-4),
    )
}

#[test]
fn every_kind_through_every_surface() {
    for size in [16, 32] {
        let model = sphere_with(size);
        for ior in [0.7, 1.0, 2.4] {
            for (name, light, most) in kinds() {
                let values = lit(&model, ior, &Pose::rest(0), &[light]);
                holds(bounded(&format!("hard light: {name}, η {ior}, {size}²"), &values, most));
                // A small part of the sky brings a twelfth of the whole.
                notices(bounded("hard light: too much", &values, 0.05 * most));
            }
        }
    }
}

fn dark(light: Light) -> Light {
    match light {
        Light::Directional(light) => Light::Directional(DirectionalLight { irradiance: [0.0; 3], ..light }),
        Light::Point(light) => Light::Point(PointLight { intensity: [0.0; 3], ..light }),
        Light::Spot(light) => Light::Spot(SpotLight { intensity: [0.0; 3], ..light }),
        Light::Rectangle(light) => Light::Rectangle(RectangleLight { radiance: [0.0; 3], ..light }),
        Light::Sphere(light) => Light::Sphere(SphereLight { radiance: [0.0; 3], ..light }),
        Light::Ambient(light) => Light::Ambient(AmbientLight { radiance: [0.0; 3], ..light }),
        Light::Environment(light) => {
            Light::Environment(EnvironmentLight { coefficients: [[0.0; 3]; 9], ..light })
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn darkness_is_dark() {
    let model = sphere_with(16);
    let all: Vec<Light> = kinds().into_iter().map(|(_, light, _)| light).collect();
    let none: Vec<Light> = all.iter().copied().map(dark).collect();
    holds(bounded("hard light: no intensity", &lit(&model, 1.3, &Pose::rest(0), &none), 0.0));
    notices(bounded("hard light: some intensity", &lit(&model, 1.3, &Pose::rest(0), &all), 0.0));
}

/// Lamps in and at the body. A lamp on the surface shines as from the rim of the square of a quarter texel.
#[test]
fn lamps_at_and_in_the_body() {
    let model = sphere_with(32);
    // The least triangle has 20 mm² and a texel more: the square's half side is 1.1 mm.
    let nearest = 0.25 * 20.0_f64.sqrt();
    for position in [[0.0; 3], [1.0, 2.0, 3.0], [0.0, 50.0, 0.0], [0.0, 49.9, 0.0], [20.0, 44.0, 14.0]] {
        for shadow in [false, true] {
            let lamp = PointLight { position, intensity: [1.0; 3], shadow, region: None };
            let spot = SpotLight {
                position,
                direction: [0.1, -1.0, 0.0],
                outer_angle: 1.5,
                shadow,
                ..Default::default()
            };
            for ior in [0.7, 1.0, 1.3] {
                for light in [Light::Point(lamp), Light::Spot(spot)] {
                    let values = lit(&model, ior, &Pose::rest(0), &[light]);
                    holds(bounded(&format!("hard light: lamp at {position:?}"), &values, nearest.powi(-2)));
                }
            }
        }
    }
    let lamp = PointLight { position: [0.0, 50.5, 0.0], shadow: false, ..Default::default() };
    let values = lit(&model, 1.0, &Pose::rest(0), &[Light::Point(lamp)]);
    notices(bounded("hard light: lamp close by", &values, 0.01));
}

/// Nothing gets brighter by what is in its way, and the sheets' inner sides are dark.
fn between_sheets(gap: f32) -> Check {
    let model = cuboids(&[
        ([-50.0, 0.0, -50.0], [50.0, 10.0, 50.0]),
        ([-50.0, 10.0 + gap, -50.0], [50.0, 20.0 + gap, 50.0]),
    ]);
    let sun = |shadow| {
        Light::Directional(DirectionalLight { to_light: [0.2, 1.0, 0.3], shadow, ..Default::default() })
    };
    let sky = |shadow| Light::Ambient(AmbientLight { shadow, ..Default::default() });
    for (name, light) in [("sun", [sun(false), sun(true)]), ("sky", [sky(false), sky(true)])] {
        let mut fixture = Fixture::new(&model, |d| d.medium = Medium { ior: 1.0, ..Medium::MARBLE });
        let [open, shadowed] = light.map(|light| {
            fixture.light(&Pose::rest(0).frame(&[light]));
            fixture.irradiance()
        });
        let (mut inside, mut excess) = (0.0_f64, 0.0_f64);
        for ((open, shadowed), source) in open.iter().zip(&shadowed).zip(fixture.sources()) {
            excess = excess.max(if shadowed[0] >= 0.0 { shadowed[0] - open[0] } else { f64::NAN });
            let [x, y, z] = source.position.map(f64::abs);
            if source.area > 0.0 && (y - 10.0).abs() < 0.1 + f64::from(gap) && x.max(z) < 40.0 {
                inside = inside.max(shadowed[0]);
            }
        }
        holds(at_most(&format!("hard light: {name} on sheets, more than open"), excess, 1e-6));
        // A hair above the surface the map's texel of the sheet's rim may be missed; measured nothing.
        at_most(&format!("hard light: {name} between sheets {gap} mm apart"), inside, 0.05)?;
    }
    Ok(())
}

#[test]
fn between_sheets_it_is_dark() {
    holds(between_sheets(0.01));
    notices(between_sheets(20.0));
}

/// A body of 1 mm, of 100 mm and of 100 m, with lights to scale: a unit of the scene is what grows.
#[test]
fn size_does_not_matter() {
    let model = sphere_with(32);
    for (name, light, _) in kinds() {
        let at = |mm_per_unit: f32, light: Light| {
            let mut fixture = Fixture::new(&model, |d| d.mm_per_unit = mm_per_unit);
            fixture.light(&Pose::rest(0).frame(&[light]));
            fixture.irradiance()
        };
        let usual = at(1.0, light);
        for mm_per_unit in [0.01, 1000.0] {
            let error = relative_rmse(&at(mm_per_unit, light), &usual);
            holds(at_most(&format!("hard light: {name}, {mm_per_unit} mm per unit"), error, 1e-3));
        }
        notices(at_most("hard light: in the dark", relative_rmse(&at(1.0, dark(light)), &usual), 1e-3));
    }
}

/// A sphere that a morph target gathers in one point, and another that presses it flat.
fn collapsing() -> Arc<Model> {
    let mut mesh = builtin::sphere([0.0; 3], 50.0, 3);
    let deltas = |f: fn(&[f32; 3]) -> [f32; 3]| mesh.positions.iter().map(f).collect();
    let (point, flat) = (deltas(|p| p.map(|x| -x)), deltas(|p| [0.0, -p[1], 0.0]));
    mesh.targets = vec![
        MorphTarget { name: "point".to_owned(), position_deltas: point },
        MorphTarget { name: "flat".to_owned(), position_deltas: flat },
    ];
    Model::new(mesh, 16)
}

#[test]
fn bodies_without_area_stay_bounded() {
    let model = collapsing();
    let poses = [
        Pose { model: Mat4::from_scale(Vec3::new(1.0, 1e-6, 1.0)), ..Pose::rest(2) },
        Pose { weights: vec![1.0, 0.0], ..Pose::rest(2) },
        Pose { weights: vec![0.0, 1.0], ..Pose::rest(2) },
    ];
    for (k, pose) in poses.iter().enumerate() {
        for (name, light, most) in kinds() {
            let values = lit(&model, 1.3, pose, &[light]);
            holds(bounded(&format!("hard light: {name} on crushed body {k}"), &values, most));
        }
        // Right at the point that gathers all of it: as bright as one likes, on no area.
        let within = lit(&model, 1.3, pose, &[Light::Point(PointLight::default())]);
        holds(bounded(&format!("hard light: lamp in crushed body {k}"), &within, 1e30));
        let everything: Vec<Light> = kinds().into_iter().map(|(_, light, _)| light).collect();
        let mut fixture = Fixture::new(&model, |d| d.shadows.resolution = 128);
        fixture.run(&pose.frame(&everything));
        // All together bring up to 15; two sheets in one plane light each other. Measured 25.
        holds(bounded(&format!("hard light: exitance of crushed body {k}"), &fixture.exitance(), 30.0));
        fixture.run(&Pose::rest(2).frame(&everything));
        let mut fresh = Fixture::new(&model, |d| d.shadows.resolution = 128);
        fresh.run(&Pose::rest(2).frame(&everything));
        assert_eq!(fixture.irradiance(), fresh.irradiance(), "[{}] it does not recover", gpu().adapter_name);
    }
}
