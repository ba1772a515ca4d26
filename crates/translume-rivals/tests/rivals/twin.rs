//! The rivals' sums on the CPU, in double precision, from what the GPU stored before.

use crate::scene::{Scene, read, scaled, sun};
use glam::{DVec2, DVec3, Vec3};
use std::f64::consts::PI;
use translume::{BurleyFit, Light, Medium, readback};
use translume_mesh::builtin;
use translume_reference::fresnel::{hemispherical_transmittance, transmittance};
use translume_rivals::{Renderer, Rival, ScreenSpace, TranslucentShadowMap};
use translume_tests::{Check, Shot, at_most, dipoles, gpu, holds, notices, relative_rmse};

const SIZE: usize = 48;
const TO_LIGHT: [f32; 3] = [0.3, 0.6, -0.8];

fn scene(medium: Medium) -> Scene {
    let shot = Shot { eye: [0.0, 15.0, 230.0], target: [0.0; 3], fov: 0.42, size: SIZE as u32 };
    let mesh = scaled(builtin::creature_with(5000), 100.0);
    Scene { mesh, medium, lights: vec![Light::Directional(sun(TO_LIGHT))], shot }
}

fn stored<T: bytemuck::Pod>(renderer: &Renderer, which: usize) -> Vec<T> {
    readback::texture(&gpu().device, &gpu().queue, &renderer.intermediates()[which], 0).unwrap()
}

/// Pixels spread over the body.
fn pixels(picture: &[[f32; 4]]) -> Vec<usize> {
    (0..picture.len()).filter(|&k| picture[k][3] > 0.0).step_by(23).collect()
}

fn colours(picture: &[[f32; 4]], pixels: &[usize]) -> Vec<[f64; 3]> {
    pixels.iter().map(|&k| [0, 1, 2].map(|c| f64::from(picture[k][c]))).collect()
}

/// The disc of a pixel: `count` samples on a spiral, weighted by the profile at their distance.
fn disc(renderer: &Renderer, scene: &Scene, pixel: usize, count: u32) -> [f64; 3] {
    let light: Vec<[f32; 4]> = stored(renderer, 0);
    let exit: Vec<f32> = stored(renderer, 1);
    let shape = BurleyFit::Diffuse.shape(&scene.medium);
    let lengths = shape.length.map(f64::from);
    let widest = lengths.into_iter().fold(0.0, f64::max);
    let depth = f64::from(light[pixel][3]);
    let per_mm = 0.5 * SIZE as f64 / (0.5 * f64::from(scene.shot.fov)).tan() / depth;
    let middle = DVec2::new((pixel % SIZE) as f64 + 0.5, (pixel / SIZE) as f64 + 0.5);
    let ring = |r: f64, d: f64| ((-r / d).exp() + (-r / 3.0 / d).exp()) / d;
    let (mut sum, mut total) = ([0.0; 3], [0.0; 3]);
    for k in 0..count {
        // Newton's root of the share inside, from the far side where the function is convex.
        let share = (f64::from(k) + 0.5) / f64::from(count);
        let mut x: f64 = 0.0;
        for _ in 0..200 {
            let beyond = 0.25 * ((-x).exp() + 3.0 * (-x / 3.0).exp());
            x += (beyond - (1.0 - share)) / (0.25 * ((-x).exp() + (-x / 3.0).exp()));
        }
        let angle = f64::from(k) * PI * (3.0 - 5.0_f64.sqrt());
        let r = x * widest;
        let at = (middle + DVec2::from_angle(angle) * r * per_mm).floor();
        if at.min_element() < 0.0 || at.max_element() >= SIZE as f64 {
            continue;
        }
        let [red, green, blue, there] = light[at.y as usize * SIZE + at.x as usize].map(f64::from);
        if there == 0.0 {
            continue;
        }
        let distance = r.hypot(there - depth);
        for (c, irradiance) in [red, green, blue].into_iter().enumerate() {
            let weight = ring(distance, lengths[c]) / ring(r, widest);
            sum[c] += weight * irradiance;
            total[c] += weight;
        }
    }
    [0, 1, 2].map(|c| f64::from(shape.albedo[c]) * sum[c] / total[c] * f64::from(exit[pixel]))
}

fn screen_twin(samples: u32, twins: u32) -> Check {
    let scene = scene(Medium::SKIN1);
    let renderer = scene.render(Rival::ScreenSpace(ScreenSpace { samples, ..Default::default() }));
    let picture = read(&renderer);
    let pixels = pixels(&picture);
    let expected: Vec<_> = pixels.iter().map(|&k| disc(&renderer, &scene, k, twins)).collect();
    // A sample on the border of two pixels may fall to either; measured 1·10⁻⁷.
    at_most("a disc against its twin", relative_rmse(&colours(&picture, &pixels), &expected), 2e-3)
}

#[test]
fn a_disc_is_the_sum_of_its_samples() {
    holds(screen_twin(55, 55));
    notices(screen_twin(55, 50));
}

/// A half float, IEEE 754.
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023) / 1024.0);
    sign * if exponent == 0 {
        fraction * 2.0_f64.powi(-14)
    } else {
        (1.0 + fraction) * 2.0_f64.powi(exponent - 15)
    }
}

/// Where light entered, mm, and how much of it for every mm² of the map.
fn entries(renderer: &Renderer, scene: &Scene, width: usize) -> Vec<(DVec3, f64)> {
    let entering: Vec<[u16; 4]> = stored(renderer, 0);
    let depths: Vec<u16> = stored(renderer, 1);
    let forward = -Vec3::from(TO_LIGHT).normalize();
    let right = forward.any_orthonormal_vector();
    let up = right.cross(forward);
    let [low, high] = scene.bounds().map(Vec3::from);
    let (mut half_width, mut reach): (f32, f32) = (0.0, 0.0);
    for k in 0..8 {
        let side =
            |bit: u32, low: f32, high: f32| 0.5 * if k >> bit & 1 == 1 { high - low } else { low - high };
        let corner = Vec3::new(side(0, low.x, high.x), side(1, low.y, high.y), side(2, low.z, high.z));
        half_width = half_width.max(corner.dot(right).abs()).max(corner.dot(up).abs());
        reach = reach.max(corner.dot(forward));
    }
    // Four texels of room to each side, and 1 % of the depth before and behind.
    let half_width = f64::from(half_width) * (1.0 + 8.0 / width as f64);
    let reach = f64::from(reach) * 1.02;
    let middle = (0.5 * (low + high)).as_dvec3();
    let place = |k: usize| 2.0 * (k as f64 + 0.5) / width as f64 - 1.0;
    let area = (2.0 * half_width / width as f64).powi(2);
    (0..width * width)
        .filter(|&k| half(entering[k][3]) > 0.0)
        .map(|k| {
            let weight = half(entering[k][3]);
            let lateral = right.as_dvec3() * place(k % width) - up.as_dvec3() * place(k / width);
            let depth = forward.as_dvec3() * (half(depths[k]) / weight * reach);
            (middle + lateral * half_width + depth, weight * area)
        })
        .collect()
}

/// The dipole over every texel of the finest level, seen by pixels; `brighter` times the light.
fn map_twin(brighter: f64) -> Check {
    let scene = scene(Medium::SKIMMILK);
    let settings = TranslucentShadowMap { rings: 16, spokes: 20, map: 256, ..Default::default() };
    let renderer = scene.render(Rival::TranslucentShadowMap(settings));
    let picture = read(&renderer);
    let pixels = pixels(&picture);
    let entries = entries(&renderer, &scene, 256);
    let surface = scene.surface();
    let hits = scene.hits(&surface);
    let dipoles = dipoles(&scene.medium);
    let eta = f64::from(scene.medium.ior);
    let (mut found, mut expected) = (Vec::new(), Vec::new());
    for pixel in pixels {
        let Some(hit) = &hits[pixel] else { continue };
        let position = DVec3::from(surface.point(hit.triangle, hit.barycentric));
        let normal = DVec3::from(surface.normal(hit.triangle, hit.barycentric));
        let to_eye = (DVec3::from(scene.shot.twin(1.0).eye) - position).normalize();
        let exit = transmittance(eta, normal.dot(to_eye).abs()) / (PI * hemispherical_transmittance(eta));
        let sum = |c: usize| -> f64 {
            entries
                .iter()
                .map(|(there, power)| dipoles[c].reflectance(position.distance(*there)) * power)
                .sum()
        };
        // The default sun has an irradiance of π.
        expected.push([0, 1, 2].map(|c| brighter * PI * exit * sum(c)));
        found.push([0, 1, 2].map(|c| f64::from(picture[pixel][c])));
    }
    // 321 samples and eight levels against 65,536 texels, each as wide as half a mean free path; measured 2 %.
    at_most("a map against the sum of its texels", relative_rmse(&found, &expected), 0.04)
}

#[test]
fn a_pattern_is_the_sum_over_its_map() {
    holds(map_twin(1.0));
    notices(map_twin(1.08));
}
