//! The boundary solver against its dense twin, whose rays are cast through the mesh.

use std::sync::Arc;
use translume::{
    AmbientLight, Camera, DirectionalLight, Error, Frame, Light, LookAt, Medium, Method, Profile, Transport,
    View, readback,
};
use translume_reference::composite::{Camera as TwinCamera, Exit, look_up, render};
use translume_reference::fresnel::hemispherical_transmittance;
use translume_reference::gather::Source;
use translume_reference::path::{Closed, Volume};
use translume_reference::transport::{Body, Solution, Tier, picture, sites};
use translume_tests::{
    Check, Fixture, Model, Pose, at_least, at_most, creature, gpu, holds, light, notices, rmse_by_area,
    sphere_with,
};

/// A radius of the sphere is 5, 25 and 80 mean free paths.
const MEDIUM: Medium = Medium { sigma_s_prime: [0.1, 0.5, 1.5], sigma_a: [0.0, 0.01, 0.1], ior: 1.0, g: 0.0 };
/// A mean free path is a texel of the creature or more, and its ears are thin.
const THIN: Medium =
    Medium { sigma_s_prime: [0.1, 0.2, 0.35], sigma_a: [0.0, 0.001, 0.02], ior: 1.0, g: 0.0 };

fn sun(to_light: [f32; 3]) -> Light {
    Light::Directional(DirectionalLight { to_light, irradiance: [3.0; 3], ..Default::default() })
}

fn fixture(model: &Arc<Model>, medium: Medium, transport: Transport) -> Fixture {
    Fixture::new(model, |d| (d.medium, d.transport, d.method) = (medium, transport, Method::default()))
}

/// RMS difference by area, over the RMS of what is exact.
fn apart(fixture: &Fixture, found: &[[f64; 3]], exact: &[[f64; 3]]) -> f64 {
    let exact: Vec<Source> = fixture
        .sources()
        .into_iter()
        .zip(exact)
        .map(|(source, exact)| Source { irradiance: *exact, ..source })
        .collect();
    rmse_by_area(found, &exact)
}

/// The same body is solved by dense sums for `twin`.
fn agrees(model: &Arc<Model>, twin: Medium, medium: Medium, bound: f64) -> Check {
    let lights = [sun([0.3, 0.5, -0.8])];
    let mut fixture = fixture(model, medium, Transport::Boundary);
    let pose = Pose::rest(model.mesh.targets.len());
    fixture.run(&pose.frame(&lights));
    let wide = |values: [f32; 3]| values.map(f64::from);
    let volume = Volume {
        sigma_s: wide(twin.sigma_s_prime),
        sigma_a: wide(twin.sigma_a),
        g: 0.0,
        ior: twin.ior.into(),
    };
    let surface = fixture.twin_surface(&pose);
    let shape = Closed::new(&surface).map_err(|problem| format!("{problem}"))?;
    let twins: Vec<_> = lights.iter().map(|each| light(each, 1.0)).collect();
    let body = Body { shape: &shape, volume, lights: &twins };
    let solution = Solution::new(body, sites(&model.atlas, &surface, &fixture.sources()), 6);
    let exact: Vec<[f64; 3]> = (0..solution.fluence().len()).map(|k| solution.exitance(k)).collect();
    let what = format!("{}: boundary against dense sums", model.mesh.name);
    at_most(&what, apart(&fixture, &fixture.exitance(), &exact), bound)
}

/// Measured 2.1 % on the sphere, whose texels are up to nine mean free paths wide and the twin's discs of another form; and 5.0 % on the creature, whose
/// thickness and chords come from rays through discs in place of triangles.
#[test]
fn exitance_is_that_of_dense_sums() {
    holds(agrees(&sphere_with(48), MEDIUM, MEDIUM, 0.03));
    holds(agrees(&creature(), THIN, THIN, 0.055));
    let darker = Medium { sigma_a: [0.01, 0.02, 0.2], ..MEDIUM };
    notices(agrees(&sphere_with(48), darker, MEDIUM, 0.03));
}

/// Measured 1.0 %.
#[test]
fn exitance_through_a_surface_that_refracts_is_that_of_dense_sums() {
    let glassy = Medium { ior: 1.4, ..MEDIUM };
    holds(agrees(&sphere_with(48), glassy, glassy, 0.03));
    notices(agrees(&sphere_with(48), Medium { ior: 1.3, ..glassy }, glassy, 0.03));
}

const RINGS: usize = 48;

/// On a ball the same everywhere at the same height towards the light: mean exitance in so many rings.
fn rings(fixture: &Fixture, to_light: [f64; 3]) -> Vec<[f64; 3]> {
    let mut sums = vec![([0.0; 3], 0.0); RINGS];
    for (source, exitance) in fixture.sources().iter().zip(fixture.exitance()) {
        let (sum, area) = &mut sums[height(source, to_light) as usize];
        (0..3).for_each(|k| sum[k] += source.area * exitance[k]);
        *area += source.area;
    }
    sums.into_iter().map(|(sum, area)| sum.map(|value| value / area.max(1e-30))).collect()
}

/// In rings.
fn height(source: &Source, to_light: [f64; 3]) -> f64 {
    let cosine: f64 = (0..3).map(|k| source.normal[k] * to_light[k]).sum();
    (0.5 * (1.0 + cosine) * RINGS as f64).clamp(0.0, RINGS as f64 - 0.5)
}

/// A ball of 25,000 texels, four to a site, against one whose texels are as many as those sites.
fn sites_stand_for_texels(seen_from: [f64; 3], bound: f64) -> Check {
    let to_light = [0.48, 0.6, 0.64];
    let solved = |atlas: u32| {
        let mut fixture = fixture(&sphere_with(atlas), THIN, Transport::Boundary);
        fixture.run(&Pose::rest(0).frame(&[sun(to_light.map(|x| x as f32))]));
        fixture
    };
    let (coarse, fine) = (solved(192), solved(96));
    let rings = rings(&fine, to_light);
    let expected: Vec<[f64; 3]> = coarse
        .sources()
        .iter()
        .map(|source| {
            let at = (height(source, seen_from) - 0.5).clamp(0.0, RINGS as f64 - 1.001);
            let part = at.fract();
            let [below, above] = [rings[at as usize], rings[at as usize + 1]];
            std::array::from_fn(|k| below[k] * (1.0 - part) + above[k] * part)
        })
        .collect();
    at_most("four texels to a site", apart(&coarse, &coarse.exitance(), &expected), bound)
}

/// Measured .7 %, and 14 % where light is taken to come from 10° beside.
#[test]
fn a_site_stands_for_its_texels() {
    holds(sites_stand_for_texels([0.48, 0.6, 0.64], 0.02));
    notices(sites_stand_for_texels([0.6, 0.48, 0.64], 0.02));
}

fn pose(frame: f32) -> (Pose, [Light; 1]) {
    let mut pose = Pose::rest(1);
    pose.warp.twist = (2.0 * frame).to_radians();
    let (sin, cos) = (3.0 * frame).to_radians().sin_cos();
    (pose, [sun([sin, 0.3, cos])])
}

/// How far a body that moved on for a few frames is from one that is solved from nothing.
fn lags(warm_frames: [f32; 4], bound: f64) -> Check {
    let model = creature();
    let mut warm = fixture(&model, THIN, Transport::Boundary);
    for frame in warm_frames {
        let (pose, lights) = pose(frame);
        warm.run(&pose.frame(&lights));
    }
    let mut cold = fixture(&model, THIN, Transport::Boundary);
    let (pose, lights) = pose(3.0);
    cold.run(&pose.frame(&lights));
    at_most("lag of a turning light and a twist", apart(&cold, &warm.exitance(), &cold.exitance()), bound)
}

/// What the library promises; measured 1.0 %, and 2.5 % for a frame that is left out.
#[test]
fn a_frame_goes_on_from_the_last() {
    holds(lags([0.0, 1.0, 2.0, 3.0], 0.02));
    notices(lags([0.0, 1.0, 2.0, 2.0], 0.02));
}

/// How far a body that melted by steps and then stood still for so many frames is from one that always was so.
fn comes_to_rest(steps: &[f32], still: u32, bound: f64) -> Check {
    let model = creature();
    let mut pose = Pose::rest(model.mesh.targets.len());
    let lights =
        [sun([0.3, 0.5, -0.8]), Light::Ambient(AmbientLight { radiance: [0.1; 3], ..Default::default() })];
    let mut moved = fixture(&model, Medium::JADE, Transport::BoundaryLayers);
    for weight in steps {
        pose.weights[0] = *weight;
        moved.run(&seen_from(EYE, &pose, &lights));
    }
    let mut stood = fixture(&model, Medium::JADE, Transport::BoundaryLayers);
    for frame in 0..6 {
        stood.run(&seen_from(EYE, &pose, &lights));
        if frame < still {
            moved.run(&seen_from(EYE, &pose, &lights));
        }
    }
    at_most("after it moved", apart(&stood, &moved.exitance(), &stood.exitance()), bound)
}

fn seen_from<'a>(eye: [f32; 3], pose: &'a Pose, lights: &'a [Light]) -> Frame<'a> {
    let mut frame = pose.frame(lights);
    frame.view = Some(view_from(eye));
    frame
}

/// Measured .02 %, and 1.8 % in the frame that jumped.
#[test]
fn a_body_that_moved_comes_to_rest() {
    holds(comes_to_rest(&[0.0, 0.05, 0.1, 0.15, 0.2], 3, 0.0005));
    let jump = [0.0, 0.0, 0.0, 0.0002, 0.67];
    holds(comes_to_rest(&jump, 3, 0.0005));
    notices(comes_to_rest(&jump, 0, 0.0005));
}

/// Figures: `TRANSLUME_MODELS=… cargo test --release -p translume-tests --test gpu -- --ignored --nocapture sixty_frames`.
#[test]
#[ignore = "minutes on a software rasteriser; for reading"]
fn sixty_frames_in_figures() {
    const MILK: Medium =
        Medium { sigma_s_prime: [0.7, 1.22, 1.9], sigma_a: [0.0014, 0.0025, 0.0142], ior: 1.0, g: 0.0 };
    let Some(folder) = std::env::var_os("TRANSLUME_MODELS") else { return };
    let mesh = translume_mesh::load::load(&std::path::Path::new(&folder).join("stanford-bunny.obj"))
        .expect("the bunny")
        .mesh;
    let along = |axis: usize| mesh.positions.iter().map(move |p| p[axis]);
    let height = along(1).fold(f32::MIN, f32::max) - along(1).fold(f32::MAX, f32::min);
    let model = Model::new(mesh, 256);
    let made = || {
        Fixture::new(&model, |d| {
            (d.medium, d.transport, d.method) = (MILK, Transport::Boundary, Method::default());
            d.mm_per_unit = 50.0 / height;
        })
    };
    let mut warm = made();
    println!("| frame | lag of a light that turns by 3° and a twist by 1° a frame | pumping |");
    println!("| --- | --- | --- |");
    let mut levels: Vec<f64> = Vec::new();
    for frame in 0..60 {
        let mut pose = Pose::rest(0);
        pose.warp.twist = (frame as f32).to_radians();
        let (sin, cos) = (3.0 * frame as f32).to_radians().sin_cos();
        let lights = [sun([sin, 0.3, -cos])];
        warm.run(&pose.frame(&lights));
        if frame % 6 == 5 {
            let mut cold = made();
            for _ in 0..3 {
                cold.run(&pose.frame(&lights));
            }
            let mean = |fixture: &Fixture| -> f64 {
                let area = |(source, value): (&Source, &[f64; 3])| source.area * value[1];
                fixture.sources().iter().zip(&fixture.exitance()).map(area).sum()
            };
            levels.push(mean(&warm) / mean(&cold));
            let lag = apart(&cold, &warm.exitance(), &cold.exitance());
            println!(
                "| {frame} | {:.2} % | {:+.2} % |",
                100.0 * lag,
                100.0 * (mean(&warm) / mean(&cold) - 1.0)
            );
        }
    }
    assert!(levels.len() == 10, "ten looks");
}

/// What serves is chosen by how far light goes, unless somebody chose what the solver does not know.
#[test]
fn auto_solves_where_light_crosses_the_body() {
    let model = sphere_with(48);
    let (pose, lights) = (Pose::rest(0), [sun([1.0, 0.2, 0.3])]);
    let made = |transport, profile: Profile| {
        let mut fixture = Fixture::new(&model, |d| {
            (d.medium, d.transport, d.profile) = (THIN, transport, profile.clone());
        });
        fixture.run(&pose.frame(&lights));
        fixture
    };
    let mut auto = made(Transport::Auto, Profile::default());
    let [solved, classic] =
        [Transport::BoundaryLayers, Transport::Classic].map(|transport| made(transport, Profile::default()));
    let same = |auto: &Fixture, other: &Fixture| {
        at_most("auto", apart(auto, &auto.exitance(), &other.exitance()), 1e-4)
    };
    assert_eq!(auto.body.transport_in_use(), Transport::BoundaryLayers);
    assert_eq!(auto.body.transport(), Transport::Auto);
    holds(same(&auto, &solved));
    notices(same(&auto, &classic));

    let dense = Medium { sigma_s_prime: [30.0; 3], ..THIN };
    auto.body.set_medium(dense).unwrap_or_else(|error| panic!("{error}"));
    auto.run(&pose.frame(&lights));
    assert_eq!(auto.body.transport_in_use(), Transport::Classic);
    auto.body.set_medium(THIN).unwrap_or_else(|error| panic!("{error}"));
    for _ in 0..2 {
        auto.run(&pose.frame(&lights));
    }
    assert_eq!(auto.body.transport_in_use(), Transport::BoundaryLayers);
    // Two frames that begin with nothing: measured .03 %.
    holds(at_most("back again", apart(&auto, &auto.exitance(), &solved.exitance()), 0.01));

    let chosen = made(Transport::Auto, Profile::DipoleNormalised);
    assert_eq!(chosen.body.transport_in_use(), Transport::Classic);
}

/// A host may look at the irradiance before it goes on.
#[test]
fn a_frame_may_be_recorded_in_parts() {
    let model = sphere_with(48);
    let (pose, lights) = (Pose::rest(0), [sun([1.0, 0.2, 0.3])]);
    let mut whole = fixture(&model, MEDIUM, Transport::Boundary);
    whole.run(&pose.frame(&lights));
    let mut parts = fixture(&model, MEDIUM, Transport::Boundary);
    parts.light(&pose.frame(&lights));
    let same = |parts: &Fixture| at_most("parts", apart(parts, &parts.exitance(), &whole.exitance()), 1e-5);
    notices(same(&parts));
    parts.encode();
    holds(same(&parts));
}

/// Share of the light that is not explained after the first frame, the worst of the channels, and how often nothing was found.
fn state(fixture: &Fixture) -> (f64, u32) {
    let Some(buffer) = fixture.body.outputs().solver else { return (f64::NAN, u32::MAX) };
    let words: Vec<u32> = readback::buffer(&gpu().device, &gpu().queue, buffer).unwrap_or_default();
    let residual = words[32..35].iter().map(|word| f64::from(f32::from_bits(*word))).fold(0.0, f64::max);
    (residual, words[39])
}

/// Eight tries, each of which takes a factor of 2 to 5 on bodies like these.
#[test]
fn the_first_frame_solves_the_equation() {
    for (model, medium) in [(sphere_with(48), MEDIUM), (creature(), THIN)] {
        let mut fixture = fixture(&model, medium, Transport::Boundary);
        fixture.run(&Pose::rest(model.mesh.targets.len()).frame(&[sun([0.0, 0.3, -1.0])]));
        let (residual, failures) = state(&fixture);
        holds(at_most("what is left", residual, 0.01));
        assert_eq!(failures, 0);
    }
    notices(at_most(
        "what is left of nothing",
        state(&fixture(&creature(), THIN, Transport::Classic)).0,
        0.01,
    ));
}

fn furnace(model: &Arc<Model>, medium: Medium, shadow: bool, bound: f64) -> Check {
    let mut fixture = fixture(model, medium, Transport::Boundary);
    let sky = Light::Ambient(AmbientLight { shadow, ..AmbientLight::default() });
    fixture.run(&Pose::rest(model.mesh.targets.len()).frame(&[sky]));
    let white = vec![[std::f64::consts::PI; 3]; fixture.exitance().len()];
    at_most("furnace", apart(&fixture, &fixture.exitance(), &white), bound)
}

/// Light that goes through without scattering is missing: e^−10 along a diameter. The atlas: measured 1.6 %.
#[test]
fn a_white_body_vanishes_in_a_white_sky() {
    let white = Medium { sigma_s_prime: [0.1, 0.2, 0.3], sigma_a: [0.0; 3], ior: 1.0, g: 0.0 };
    let ball = sphere_with(64);
    holds(furnace(&ball, white, false, 0.025));
    notices(furnace(&ball, Medium { sigma_a: [0.002; 3], ..white }, false, 0.025));
}

/// In its hollows light comes in again in place of the sky. Measured 7.4 %; 12.5 % were none to come in, and 10.6 % where the whole sky does, too.
#[test]
fn a_concave_white_body_vanishes_too() {
    let white = Medium { sigma_s_prime: [1.0, 2.0, 3.0], sigma_a: [0.0; 3], ior: 1.0, g: 0.0 };
    holds(furnace(&creature(), white, true, 0.09));
    notices(furnace(&creature(), white, false, 0.09));
}

const EYE: [f32; 3] = [0.0, 0.0, 300.0];

/// A ball of 50 mm in a white sky, as it is seen from there.
fn ball_in_a_sky(medium: Medium) -> Fixture {
    let mut fixture = fixture(&sphere_with(64), medium, Transport::BoundaryLayers);
    let pose = Pose::rest(0);
    let lights = [Light::Ambient(AmbientLight::default())];
    fixture.run(&seen_from(EYE, &pose, &lights));
    fixture
}

/// Of a white body in a white sky what is seen from an eye, on the side that faces it.
fn seen_in_a_furnace(medium: Medium, bound: f64) -> Check {
    let fixture = ball_in_a_sky(medium);
    let white = std::f64::consts::PI * hemispherical_transmittance(medium.ior.into());
    let faces = |source: &Source| source.normal[2] > 0.3;
    let sources: Vec<Source> = fixture.sources();
    let seen: Vec<[f64; 3]> = fixture
        .exitance()
        .into_iter()
        .zip(&sources)
        .map(|(exitance, source)| if faces(source) { exitance } else { [white; 3] })
        .collect();
    let white = vec![[white; 3]; seen.len()];
    at_most("furnace, by layers", apart(&fixture, &seen, &white), bound)
}

/// Measured 1.0 %: a ball of ten mean free paths in red, of thirty in blue.
#[test]
fn layers_of_a_white_body_are_white() {
    let white = Medium { sigma_s_prime: [0.2, 0.4, 0.6], sigma_a: [0.0; 3], ior: 1.0, g: 0.0 };
    holds(seen_in_a_furnace(white, 0.03));
    notices(seen_in_a_furnace(Medium { sigma_a: [0.002; 3], ..white }, 0.03));
}

/// What the surface lets in of the sky comes out, whatever the index of refraction; measured .8 %.
#[test]
fn layers_of_a_white_body_that_refracts_are_white() {
    for ior in [1.1, 1.3, 1.5] {
        let white = Medium { sigma_s_prime: [0.2, 0.4, 0.6], sigma_a: [0.0; 3], ior, g: 0.0 };
        holds(seen_in_a_furnace(white, 0.02));
        notices(seen_in_a_furnace(Medium { sigma_a: [0.002; 3], ..white }, 0.02));
    }
}

/// Lit by a cone of the sky this wide around a sun, as bright on a plane that faces it.
fn as_by_a_sun(half_angle: f32, bound: f64) -> Check {
    let to_light = [0.6, 0.0, -0.8];
    let seen = |light: Light| {
        let mut fixture = fixture(&sphere_with(64), THIN, Transport::BoundaryLayers);
        let (pose, lights) = (Pose::rest(0), [light]);
        fixture.run(&seen_from(EYE, &pose, &lights));
        fixture
    };
    let sun = seen(sun(to_light));
    let radiance = 3.0 / (std::f32::consts::PI * half_angle.sin().powi(2));
    let cone = AmbientLight { radiance: [radiance; 3], axis: to_light, half_angle, shadow: true };
    let cone = seen(Light::Ambient(cone));
    at_most("a narrow cone", apart(&sun, &cone.exitance(), &sun.exitance()), bound)
}

/// A light of some extent comes from one side, too; measured .6 %.
#[test]
fn a_narrow_cone_of_the_sky_is_a_sun() {
    holds(as_by_a_sun(0.1, 0.03));
    notices(as_by_a_sun(1.2, 0.03));
}

/// Of balls of 3, 6.5 and 10 mean free paths with albedos .99, .99 and .9 in a white sky: exact radiance by the cosine of where it is seen, 1 for the sky's. Each from
/// the integral equation for r φ(r), with the kernel E₁, on 1,200 shells.
const BALLS: [[f64; 5]; 3] = [
    [0.6793, 0.8797, 0.9357, 0.9483, 0.9479],
    [0.8800, 0.9332, 0.9259, 0.9146, 0.9034],
    [0.6553, 0.6047, 0.5542, 0.5117, 0.4751],
];
const COSINES: [f64; 5] = [0.2, 0.4, 0.6, 0.8, 1.0];

fn balls_are_as_bright_as(exact: &[[f64; 5]; 3], bound: f64) -> Check {
    let radius = 50.0;
    let [sigma_s_prime, sigma_a] = [[0.99, 0.99, 0.9], [0.01, 0.01, 0.1]]
        .map(|share| [0, 1, 2].map(|k| share[k] * [3.0, 6.5, 10.0][k] / radius));
    let fixture = ball_in_a_sky(Medium { sigma_s_prime, sigma_a, ior: 1.0, g: 0.0 });
    let sources: Vec<Source> = fixture.sources();
    let expected = |(source, found): (&Source, [f64; 3])| -> ([f64; 3], [f64; 3]) {
        let away: [f64; 3] = std::array::from_fn(|k| f64::from(EYE[k]) - source.position[k]);
        let length = away.iter().map(|x| x * x).sum::<f64>().sqrt();
        let cosine = (0..3).map(|k| away[k] * source.normal[k]).sum::<f64>() / length;
        if cosine < COSINES[0] {
            return ([0.0; 3], [0.0; 3]);
        }
        let at = ((cosine - COSINES[0]) / 0.2).min(3.999);
        let radiance =
            |k: usize| exact[k][at as usize] * (1.0 - at.fract()) + exact[k][at as usize + 1] * at.fract();
        (found, std::array::from_fn(|k| std::f64::consts::PI * radiance(k)))
    };
    let (found, exact): (Vec<_>, Vec<_>) = sources.iter().zip(fixture.exitance()).map(expected).unzip();
    at_most("balls in a sky", apart(&fixture, &found, &exact), bound)
}

/// Measured 2.0 %, most of it at the middle and the rim of the smallest.
#[test]
fn small_balls_are_as_bright_as_they_are() {
    holds(balls_are_as_bright_as(&BALLS, 0.02));
    let [three, six, ten] = BALLS;
    notices(balls_are_as_bright_as(&[six, three, ten], 0.02));
}

const TWIN_CAMERA: TwinCamera = TwinCamera {
    eye: [0.0, 0.0, 300.0],
    target: [0.0; 3],
    up: [0.0, 1.0, 0.0],
    fov: 0.4,
    width: 24,
    height: 24,
};

/// A ball with the sun behind it in both pictures, where light of the twin goes on straight by this mean cosine.
fn looks_like_its_twin(medium: Medium, g: f64, bound: f64) -> Check {
    let (model, pose, lights) = (sphere_with(64), Pose::rest(0), [sun([0.6, 0.0, -0.8])]);
    let mut fixture = fixture(&model, medium, Transport::BoundaryLayers);
    fixture.run(&seen_from(EYE, &pose, &lights));
    let surface = fixture.twin_surface(&pose);
    let exit = Exit { eta: 1.0, normalised: false };
    let exitance = fixture.exitance();
    let found = render(&TWIN_CAMERA, &surface, exit, |hit| look_up(&model.atlas, &exitance, hit));
    let shape = Closed::new(&surface).map_err(|problem| format!("{problem}"))?;
    let twins: Vec<_> = lights.iter().map(|each| light(each, 1.0)).collect();
    let volume = Volume::new(&translume_twin::medium(&medium), g);
    let body = Body { shape: &shape, volume, lights: &twins };
    let solution = Solution::new(body, sites(&model.atlas, &surface, &fixture.sources()), 6);
    let exact = picture(&TWIN_CAMERA, &surface, &model.atlas, &solution, Tier::Layers);
    let (mut square, mut whole) = (0.0, 0.0);
    for (found, exact) in found.radiance.iter().zip(&exact.radiance) {
        for k in 0..3 {
            square += f64::from(found[k] - exact[k]).powi(2);
            whole += f64::from(exact[k]).powi(2);
        }
    }
    at_most("against the twin's picture", (square / whole).sqrt(), bound)
}

#[test]
fn light_goes_on_straight_as_in_the_twin() {
    let forward = Medium { g: 0.8, ..THIN };
    holds(looks_like_its_twin(forward, 0.8, 0.1));
    notices(looks_like_its_twin(forward, 0.0, 0.1));
}

fn view_from(eye: [f32; 3]) -> View {
    let camera = Camera::from(LookAt {
        eye,
        target: [0.0; 3],
        up: [0.0, 1.0, 0.0],
        horizontal_fov: 0.5,
        aspect: 1.0,
        near: 1.0,
        far: 1000.0,
    });
    View { camera, pixels: [64, 64] }
}

/// Without an eye light leaves by the diffuse law.
#[test]
fn layers_are_seen_from_somewhere() {
    let model = sphere_with(48);
    let pose = Pose::rest(0);
    let lights = [sun([1.0, 0.2, 0.3])];
    let mut plain = fixture(&model, MEDIUM, Transport::Boundary);
    plain.run(&pose.frame(&lights));
    let mut layers = fixture(&model, MEDIUM, Transport::BoundaryLayers);
    layers.run(&pose.frame(&lights));
    let same =
        |layers: &Fixture| at_most("layers", apart(layers, &layers.exitance(), &plain.exitance()), 1e-6);
    holds(same(&layers));
    layers.run(&seen_from(EYE, &pose, &lights));
    notices(same(&layers));
    holds(at_least("what is seen", layers.exitance().iter().map(|b| b[0]).sum(), 1.0));
}

#[test]
fn only_the_dual_scatter_at_texels_solves() {
    let model = sphere_with(48);
    let refused = Fixture::try_new(&model, |d| {
        (d.transport, d.method) = (Transport::Boundary, Method::AllPairs);
    });
    assert!(matches!(refused.err(), Some(Error::Frame { .. })));
    let mut fixture = fixture(&model, MEDIUM, Transport::Boundary);
    assert!(fixture.body.set_method(Method::Pattern).is_err());
    assert!(fixture.body.set_transport(Transport::Classic).is_ok());
    assert!(fixture.body.set_method(Method::Pattern).is_ok());
    assert!(fixture.body.set_transport(Transport::Boundary).is_err());
}
