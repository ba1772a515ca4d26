//! Figures and pictures, for reading.

use crate::scene::{Scene, burley, error, read, scaled};
use std::path::Path;
use std::time::Instant;
use translume::{DirectionalLight, Light, Medium, PointLight, wgpu};
use translume_mesh::{builtin, load};
use translume_rivals::{Renderer, Rival, ScreenSpace, TranslucentShadowMap};
use translume_tests::{Shot, dipoles, gpu};

fn subjects() -> Vec<(&'static str, translume_mesh::Mesh)> {
    let mut all = vec![("creature", scaled(builtin::creature(), 100.0))];
    if let Some(folder) = std::env::var_os("TRANSLUME_MODELS") {
        let path = Path::new(&folder).join("stanford-bunny.obj");
        all.push(("bunny", scaled(load::load(&path).unwrap().mesh, 100.0)));
    }
    all
}

fn lit(kind: &str, mesh: translume_mesh::Mesh, medium: Medium, size: u32) -> Scene {
    let lamp = Light::Point(PointLight {
        position: [-30.0, 40.0, -80.0],
        intensity: [1e4; 3],
        ..Default::default()
    });
    let sun = Light::Directional(DirectionalLight { to_light: [0.6, 0.7, 0.5], ..Default::default() });
    let lights = match kind {
        "behind" => vec![lamp],
        "sun" => vec![sun],
        _ => vec![lamp, sun],
    };
    let shot = Shot { eye: [0.0, 15.0, 230.0], target: [0.0; 3], fov: 0.42, size };
    Scene { mesh, medium, lights, shot }
}

fn rivals() -> Vec<Rival> {
    let maps = [
        (1, 4, 256, false),
        (4, 5, 256, false),
        (4, 5, 512, false),
        (4, 5, 512, true),
        (6, 8, 512, false),
        (10, 12, 512, false),
        (16, 20, 1024, false),
    ];
    let maps = maps.map(|(rings, spokes, map, displaced)| {
        Rival::TranslucentShadowMap(TranslucentShadowMap { rings, spokes, map, displaced })
    });
    let screens = [(11, true), (55, true), (200, true), (1000, true), (200, false)];
    let screens = screens.map(|(samples, transmission)| {
        Rival::ScreenSpace(ScreenSpace { samples, transmission, ..Default::default() })
    });
    maps.into_iter().chain(screens).collect()
}

/// Median of five frames, from submission to the end, ms.
fn time(scene: &Scene, rival: Rival) -> (Renderer, f64) {
    let renderer = scene.render(rival);
    let geometry = scene.geometry();
    let mut times: Vec<f64> = (0..5)
        .map(|_| {
            let start = Instant::now();
            scene.encode(&renderer, &geometry);
            gpu().device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
            1e3 * start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    (renderer, times[2])
}

/// Figures and pictures: `TRANSLUME_MODELS=… OUT=folder cargo test --release -p translume-rivals --test rivals -- --ignored --nocapture`.
#[test]
#[ignore = "minutes; for reading"]
fn errors_beside_times() {
    let size = 256;
    println!("| scene | rival | against dipole: RMSE, bias | against normalised diffusion | ms |");
    println!("| --- | --- | --- | --- | --- |");
    for (name, mesh) in subjects() {
        for (kind, medium) in
            [("behind", "skimmilk"), ("sun", "skimmilk"), ("behind", "skin1"), ("sun", "skin1")]
        {
            let scene = lit(kind, mesh.clone(), Medium::preset(medium).unwrap(), size);
            let dipole = scene.judge(dipoles(&scene.medium), 16, 1.0);
            let normalised = scene.judge(burley(&scene.medium), 16, 1.0);
            for rival in rivals() {
                let (renderer, ms) = time(&scene, rival);
                let picture = read(&renderer);
                let [a, b] = [&dipole, &normalised].map(|judge| error(&picture, judge, size as usize));
                println!(
                    "| {name} {kind} {medium} | {rival} | {:.3} {:+.3} | {:.3} {:+.3} | {ms:.1} |",
                    a[0], a[1], b[0], b[1]
                );
            }
        }
    }
}

/// Pictures: the same with `OUT=folder`.
#[test]
#[ignore = "a minute; for looking at"]
fn pictures() {
    for (name, mesh) in subjects() {
        for kind in ["behind", "both"] {
            let scene = lit(kind, mesh.clone(), Medium::SKIMMILK, 512);
            for rival in rivals() {
                save(&format!("{name} {kind} {rival}"), &scene.picture(rival), scene.shot.size);
            }
        }
    }
}

fn save(name: &str, picture: &[[f32; 4]], size: u32) {
    let Some(folder) = std::env::var_os("OUT") else { return };
    let bright: f32 = picture.iter().map(|p| p[1]).sum::<f32>() / picture.iter().map(|p| p[3]).sum::<f32>();
    let byte = |x: f32| (255.0 * (0.35 * x / bright).clamp(0.0, 1.0).powf(1.0 / 2.2)) as u8;
    let pixels = picture.iter().flat_map(|p| [byte(p[0]), byte(p[1]), byte(p[2])]).collect();
    let path = Path::new(&folder).join(format!("{}.png", name.replace(' ', "-")));
    image::RgbImage::from_raw(size, size, pixels).unwrap().save(path).unwrap();
}
