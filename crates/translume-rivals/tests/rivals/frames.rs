//! Frames after the first: what moves, and several lights.

use crate::scene::{Picture, Scene, default_rivals, read, scaled, sun};
use translume::{Light, Medium, PointLight};
use translume_mesh::builtin;
use translume_rivals::{Geometry, Rival};
use translume_tests::{Check, Fixture, Pose, Shot, at_most, creature, gpu, holds, notices};

fn scene(lights: Vec<Light>) -> Scene {
    let shot = Shot { eye: [0.0, 15.0, 230.0], target: [0.0; 3], fov: 0.42, size: 48 };
    Scene { mesh: scaled(builtin::creature_with(5000), 100.0), medium: Medium::SKIN1, lights, shot }
}

fn lamp() -> Light {
    Light::Point(PointLight { position: [-30.0, 40.0, -80.0], intensity: [1e4; 3], ..Default::default() })
}

fn key() -> Light {
    Light::Directional(sun([0.6, 0.7, 0.5]))
}

/// Largest difference over the largest value.
fn apart(a: &Picture, b: &Picture) -> f64 {
    let most = a.iter().flatten().copied().fold(0.0, f32::max);
    let differences = a.as_flattened().iter().zip(b.as_flattened()).map(|(x, y)| (x - y).abs());
    (differences.fold(0.0, f32::max) / most).into()
}

fn sum_of_lights(rival: Rival, gain: f32) -> Check {
    let [both, one, other] =
        [vec![lamp(), key()], vec![lamp()], vec![key()]].map(|lights| scene(lights).picture(rival));
    let add =
        |(a, b): (&[f32; 4], &[f32; 4])| [0, 1, 2, 3].map(|k| if k == 3 { a[k] } else { a[k] + gain * b[k] });
    let summed: Picture = one.iter().zip(&other).map(add).collect();
    // Rounding, and a map's half floats are the same in both.
    at_most("lights one by one", apart(&both, &summed), 1e-5)
}

#[test]
fn lights_add_up() {
    for rival in default_rivals() {
        holds(sum_of_lights(rival, 1.0));
        notices(sum_of_lights(rival, 1.01));
    }
}

/// A renderer and a geometry that showed something else show the body of the second frame as new ones do.
#[test]
fn a_body_that_moves_needs_nothing_new() {
    for rival in default_rivals() {
        let first = scene(vec![key()]);
        let mut second = scene(vec![lamp()]);
        second.medium = Medium::SKIMMILK;
        for p in &mut second.mesh.positions {
            p[0] += 5.0 * (0.05 * p[1]).sin();
        }
        let mut renderer = first.render(rival);
        let before = read(&renderer);
        let geometry = first.geometry();
        let wide = |v: &[[f32; 3]]| v.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect::<Vec<_>>();
        geometry.write(&gpu().queue, &wide(&second.mesh.positions), &wide(&second.mesh.normals)).unwrap();
        renderer.prepare(&gpu().queue, &second.frame()).unwrap();
        second.encode(&renderer, &geometry);
        let fresh = second.picture(rival);
        let same = |picture: &Picture| at_most("moved against new", apart(&fresh, picture), 0.0);
        holds(same(&read(&renderer)));
        notices(same(&before));
    }
}

#[test]
fn geometry_follows_a_body() {
    let model = creature();
    let mut fixture = Fixture::new(&model, |_| ());
    let mut pose = Pose::rest(model.mesh.targets.len());
    pose.weights[0] = 0.7;
    fixture.run(&pose.frame(&[key()]));
    let triples = |v: Vec<[f64; 3]>| v.into_iter().map(|p| p.map(|x| x as f32)).collect::<Vec<_>>();
    let mut scene = scene(vec![key()]);
    scene.mesh = model.mesh.clone();
    let rest = scene.picture(default_rivals()[1]);
    scene.mesh.positions = triples(fixture.positions());
    scene.mesh.normals = triples(fixture.normals());

    let queue = &gpu().queue;
    let count = model.mesh.positions.len();
    let geometry = Geometry::new(&gpu().device, queue, count, &model.mesh.triangles).unwrap();
    let renderer = scene.render(default_rivals()[1]);
    let uploaded = read(&renderer);
    let mut encoder = gpu().device.create_command_encoder(&Default::default());
    geometry.follow(&mut encoder, &fixture.body).unwrap();
    renderer.encode(&mut encoder, &geometry);
    queue.submit([encoder.finish()]);
    let same = |picture: &Picture| at_most("following against uploaded", apart(&uploaded, picture), 0.0);
    holds(same(&read(&renderer)));
    notices(same(&rest));
}
