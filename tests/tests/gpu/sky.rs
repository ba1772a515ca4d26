//! Light of the sky: environments and ambient lights, open and occluded by the body.

use glam::{DVec3, Mat4, Quat, Vec3};
use std::sync::Arc;
use translume::{AmbientLight, EnvironmentLight, EnvironmentMap, Frame, Light, Lighting, Medium};
use translume_reference::gather::Source;
use translume_tests::{
    Check, Fixture, Model, Pose, at_least, at_most, creature, gpu, holds, luminous, notices, plane,
    relative_rmse, rmse_by_area, sphere,
};

const ETA: f32 = 1.3;

fn body(model: &Arc<Model>, directions: u32) -> Fixture {
    Fixture::new(model, |d| {
        d.medium = Medium { ior: ETA, ..Medium::MARBLE };
        d.shadows.resolution = 1024;
        d.shadows.directions = directions;
    })
}

fn lit(body: &mut Fixture, lights: &[Light]) -> Vec<[f64; 3]> {
    let targets = body.model.mesh.targets.len();
    body.light(&Pose::rest(targets).frame(lights));
    let irradiance = body.irradiance();
    // Comparisons of maxima pass over what is no number.
    assert!(irradiance.iter().flatten().all(|e| e.is_finite()), "[{}] {lights:?}", gpu().adapter_name);
    irradiance
}

/// The same radiance for the library and for the twin.
fn maps(
    [width, height]: [u32; 2],
    radiance: impl Fn(DVec3) -> [f64; 3],
) -> (EnvironmentMap, Arc<translume_reference::EnvironmentMap>) {
    let [columns, rows] = [width, height].map(|n| n as usize);
    let blank = vec![[0.0; 3]; columns * rows];
    let blank = translume_reference::EnvironmentMap::new(columns, rows, blank).unwrap();
    let pixels = (0..columns * rows).map(|k| radiance(blank.direction(k % columns, k / columns).into()));
    let pixels: Vec<[f32; 3]> = pixels.map(|rgb| rgb.map(|x| x as f32)).collect();
    let wide = pixels.iter().map(|rgb| rgb.map(f64::from)).collect();
    let twin = translume_reference::EnvironmentMap::new(columns, rows, wide).unwrap();
    (EnvironmentMap::new(width, height, pixels).unwrap(), Arc::new(twin))
}

/// Brightest towards one side in each colour, over a hundred degrees, with a dim ground.
fn dusk(direction: DVec3) -> [f64; 3] {
    let towards = |x, y, z| (1.2 * (direction.dot(DVec3::new(x, y, z).normalize()) - 1.0)).exp();
    [0.1 + 2.0 * towards(1.0, 0.4, 0.3), 0.1 + towards(0.2, 1.0, -0.5), 0.1 + 1.5 * towards(-0.6, 0.8, 0.6)]
}

fn environment(map: &EnvironmentMap, shadow: bool) -> Light {
    Light::Environment(EnvironmentLight { shadow, ..map.project() })
}

fn ambient(shadow: bool) -> Light {
    Light::Ambient(AmbientLight { radiance: [1.0, 0.8, 0.6], shadow, ..Default::default() })
}

fn open_sky(seen: &EnvironmentMap, twin: &translume_reference::EnvironmentMap) -> Check {
    let mut fixture = body(&sphere(), 64);
    fixture.light(&Pose::rest(0).frame(&[environment(seen, false)]));
    let sources = fixture.sources();
    let exact: Vec<_> = sources.iter().map(|s| twin.irradiance(f64::from(ETA), s.normal)).collect();
    // What lies above order 2, and a texel's four normals for that of its middle; measured .29 %.
    at_most("sky: open environment, relative RMSE", relative_rmse(&luminous(&sources), &exact), 0.01)
}

#[test]
fn a_smooth_sky_is_its_harmonics() {
    let (map, twin) = maps([64, 32], dusk);
    holds(open_sky(&map, &twin));
    let (other, _) = maps([64, 32], |d| dusk(DVec3::new(d.x, d.y, -d.z)));
    notices(open_sky(&other, &twin));
}

/// Irradiance of a plane turned in many ways, which has one normal each time.
fn turned_planes(light: &EnvironmentLight) -> Vec<([f32; 3], [f64; 3])> {
    let mut body = body(&plane(10.0, 16), 64);
    let lights = [Light::Environment(*light)];
    let turn = |k: u32| {
        let [s, c] = [(0.7 * k as f32).sin(), (1.1 * k as f32).cos()];
        Mat4::from_quat(Quat::from_axis_angle(Vec3::new(s, 0.3, c).normalize(), 0.8 * k as f32))
    };
    let look = |k: u32| {
        let (model, lighting) = (turn(k).to_cols_array_2d(), Lighting::Lights(&lights));
        body.light(&Frame { model, lighting, ..Frame::default() });
        (turn(k).transform_vector3(Vec3::Y).to_array(), body.irradiance()[9])
    };
    (0..20).map(look).collect()
}

#[test]
fn the_shader_sums_what_rust_sums() {
    let light = EnvironmentLight { shadow: false, ..maps([64, 32], dusk).0.project() };
    let found = turned_planes(&light);
    let check = |expected: &EnvironmentLight| {
        let errors = found.iter().flat_map(|(normal, found)| {
            let expected = expected.irradiance(ETA, *normal).map(f64::from);
            [0, 1, 2].map(|k| (found[k] / expected[k] - 1.0).abs())
        });
        // Nine products in single precision; measured 2.7e-7.
        at_most("sky: WGSL against Rust, sum of relative errors", errors.sum(), 1e-5)
    };
    holds(check(&light));
    for k in 0..9 {
        let mut other = light;
        other.coefficients[k][1] += 0.01;
        notices(check(&other));
    }
}

fn occluded(what: &str, light: Light, directions: u32, twin: &[Source]) -> Check {
    let error = rmse_by_area(&lit(&mut body(&creature(), directions), &[light]), twin);
    // Four directions above the horizon for each that is half hidden. Measured 3.2 % with 64, 3.0 % with 128; unoccluded 12 %.
    at_most(&format!("sky: occluded {what}, {directions} directions, relative RMSE"), error, 0.05)
}

fn twin_of(light: translume_reference::Light, samples: [u32; 2]) -> Vec<Source> {
    let mut fixture = body(&creature(), 64);
    fixture.light(&Pose::rest(1).frame(&[]));
    fixture.twin_sources_lit(&Pose::rest(1), &[light], samples)
}

#[test]
fn an_occluded_constant_sky_follows_traced_rays() {
    let twin = twin_of(translume_tests::light(&ambient(true), 1.0), [2, 12]);
    for directions in [64, 128] {
        holds(occluded("constant sky", ambient(true), directions, &twin));
    }
    notices(occluded("constant sky, left open,", ambient(false), 64, &twin));
}

#[test]
fn an_occluded_smooth_sky_follows_traced_rays() {
    let (map, twin) = maps([64, 32], dusk);
    let twin = twin_of(translume_reference::Light::Environment { map: twin, shadow: true }, [2, 12]);
    for directions in [64, 128] {
        holds(occluded("smooth sky", environment(&map, true), directions, &twin));
    }
    notices(occluded("smooth sky, left open,", environment(&map, false), 64, &twin));
}

/// Frames with one light each, added up, against a frame with all of them.
fn adds_up(body: &mut Fixture, lights: &[Light], joint: &[Light]) -> f64 {
    let mut sum = vec![[0.0; 3]; body.model.atlas.texels.len()];
    for light in lights {
        for (sum, one) in sum.iter_mut().zip(lit(body, &[*light])) {
            *sum = std::array::from_fn(|k| sum[k] + one[k]);
        }
    }
    relative_rmse(&lit(body, joint), &sum)
}

#[test]
fn open_and_shadowed_lights_of_the_sky_add_up() {
    let map = maps([64, 32], dusk).0;
    let cone = |shadow| {
        let axis = [0.3, 1.0, 0.4];
        Light::Ambient(AmbientLight { radiance: [0.3, 0.2, 0.9], axis, half_angle: 0.8, shadow })
    };
    let open = [environment(&map, false), cone(false)];
    let mut body = body(&creature(), 64);
    let mut check = |lights: &[Light], joint: &[Light]| {
        // Single precision; measured 4e-8.
        at_most("sky: sum of lights", adds_up(&mut body, lights, joint), 1e-5)
    };
    let one_shadowed = [open[0], ambient(true), open[1]];
    holds(check(&one_shadowed, &one_shadowed));
    notices(check(&one_shadowed, &[open[0], ambient(false), open[1]]));
    // All that is shadowed shares one visible share of it, which is why it does not quite add up. Measured .14 %.
    let shadowed = [environment(&map, true), ambient(true), cone(true)];
    holds(at_most("sky: sum of shadowed lights", adds_up(&mut body, &shadowed, &shadowed), 0.02));
    notices(at_most("sky: sum without the last", adds_up(&mut body, &shadowed, &shadowed[..2]), 0.02));
}

/// What a body keeps from itself.
fn occlusion(model: &Arc<Model>) -> Check {
    let mut body = body(model, 64);
    let [open, shadowed] = [false, true].map(|shadow| lit(&mut body, &[ambient(shadow)]));
    let darkest = open.iter().zip(&shadowed).map(|(open, shadowed)| 1.0 - shadowed[0] / open[0]);
    // A chord of the sphere's edges is a hair above its triangles. Measured .26 %: fifteenths of grazing directions.
    at_most("sky: occlusion, greatest", darkest.fold(0.0, f64::max), 0.005)
}

#[test]
fn a_convex_body_is_not_dark() {
    holds(occlusion(&sphere()));
    notices(occlusion(&creature()));
}

/// A cone of 34°, which 64 directions of the whole sky would see along five or six: it has sixteen of its own.
#[test]
fn a_narrow_cone_casts_a_soft_shadow() {
    let cone = |half_angle, shadow| {
        Light::Ambient(AmbientLight { axis: [0.5, 1.0, 0.2], half_angle, shadow, ..Default::default() })
    };
    let twin = twin_of(translume_tests::light(&cone(0.6, true), 1.0), [2, 12]);
    let check = |light| {
        let error = rmse_by_area(&lit(&mut body(&creature(), 64), &[light]), &twin);
        // Sixteen hard shadows in place of a soft one; measured 2.7 %, without a shadow 22 %, for the wider cone 32 %.
        at_most("sky: narrow cone, relative RMSE", error, 0.05)
    };
    holds(check(cone(0.6, true)));
    notices(check(cone(0.6, false)));
    notices(check(cone(0.7, true)));
}

#[test]
fn narrow_cones_stay_bounded() {
    let mut body = body(&creature(), 64);
    for half_angle in [0.0, 1e-4, 0.02, 0.1, 0.5, 2.0] {
        let cone = |shadow| {
            Light::Ambient(AmbientLight { axis: [0.2, 0.5, -0.7], half_angle, shadow, ..Default::default() })
        };
        let [open, shadowed] = [false, true].map(|shadow| lit(&mut body, &[cone(shadow)]));
        let excess = open
            .iter()
            .zip(&shadowed)
            .map(|(open, shadowed)| if shadowed[0] >= 0.0 { shadowed[0] - open[0] } else { f64::NAN });
        let worst = excess.reduce(|a, b| if a >= b { a } else { b }).unwrap();
        // The visible share is rounded.
        holds(at_most(&format!("sky: cone of {half_angle}, more than open"), worst, 1e-6));
        let total = |light: &[[f64; 3]]| light.iter().map(|e| e[0]).sum::<f64>();
        if half_angle > 0.0 {
            let share = total(&shadowed) / total(&open);
            holds(at_least(&format!("sky: cone of {half_angle}, visible"), share, 0.5));
            notices(at_least("sky: cone, as good as open", share, 0.99));
        } else {
            holds(at_most("sky: empty cone", total(&shadowed), 0.0));
        }
    }
}

/// Root mean square of the error over the mean, each texel by its area.
fn over_mean(measured: &[[f64; 3]], reference: &[Source]) -> f64 {
    let (mut squares, mut mean, mut area) = (0.0, 0.0, 0.0);
    for (measured, source) in measured.iter().zip(reference) {
        for (measured, expected) in measured.iter().zip(source.irradiance) {
            squares += source.area * (measured - expected).powi(2);
            mean += source.area * expected;
            area += source.area;
        }
    }
    (squares * area).sqrt() / mean
}

/// A disc of 1° around a direction near the zenith, 10⁴ times as bright as the sky.
#[test]
fn a_sun_has_to_be_split_off() {
    let to_sun = DVec3::new(0.1, 1.0, 0.1).normalize();
    let (map, twin) = maps([512, 256], |d| {
        if d.dot(to_sun) > 1_f64.to_radians().cos() { [1e4, 0.9e4, 0.7e4] } else { [0.7, 0.8, 1.0] }
    });
    let twin = twin_of(translume_reference::Light::Environment { map: twin, shadow: true }, [2, 12]);
    let (peaks, rest) = map.split_peaks();
    assert_eq!(peaks.len(), 1);
    let split = [Light::Directional(peaks[0]), Light::Environment(rest)];
    let mut body = body(&creature(), 64);
    let mut error = |lights: &[Light]| over_mean(&lit(&mut body, lights), &twin);
    let check = |error| at_most("sky: sun split off, RMSE over mean", error, 0.05);
    // Measured 3.2 %.
    holds(check(error(&split)));
    // Most of it is the sun's shadow, which 64 directions with smooth radiance blur. Measured 24 %, without any shadow 37 %. It takes a sun
    // whose shadow is seen: from the front measured 13 %, and half as wide 5 %.
    let alone = error(&[environment(&map, true)]);
    notices(check(alone));
    holds(at_least("sky: sun in harmonics alone, RMSE over mean", alone, 0.2));
    notices(check(error(&[split[1]])));
}
