//! The boundary solver against its dense twin, whose rays are cast through the mesh.

use std::sync::Arc;
use translume::{DirectionalLight, Light, Medium, Method, Transport};
use translume_reference::path::{Closed, Volume};
use translume_reference::transport::{Body, Solution, sites};
use translume_tests::{Check, Fixture, Model, Pose, at_most, holds, light, notices, sphere_with};

/// Five mean free paths across a radius in red, none in blue to speak of.
fn medium() -> Medium {
    Medium { sigma_s_prime: [0.1, 0.5, 1.5], sigma_a: [0.0, 0.01, 0.1], ior: 1.0 }
}

fn agrees(model: &Arc<Model>, medium: Medium, lights: &[Light], bound: f64) -> Check {
    let mut fixture = Fixture::new(model, |d| {
        (d.medium, d.transport, d.method) = (medium, Transport::Boundary, Method::default());
    });
    let pose = Pose::rest(model.mesh.targets.len());
    fixture.run(&pose.frame(lights));
    let exitance = fixture.exitance();
    let wide = |values: [f32; 3]| values.map(f64::from);
    let volume = Volume {
        sigma_s: wide(medium.sigma_s_prime),
        sigma_a: wide(medium.sigma_a),
        g: 0.0,
        ior: medium.ior.into(),
    };
    let surface = fixture.twin_surface(&pose);
    let shape = Closed::new(&surface).expect("a closed mesh");
    let twins: Vec<_> = lights.iter().map(|each| light(each, 1.0)).collect();
    let body = Body { shape: &shape, volume, lights: &twins };
    let sources = fixture.sources();
    let solution = Solution::new(body, sites(&model.atlas, &surface, &sources), 8);
    eprintln!("residual {:?}", solution.residual());
    let mut worst: f64 = 0.0;
    for k in 0..3 {
        let (mut square, mut sum, mut count, mut signed) = (0.0, 0.0, 0.0, 0.0);
        for (i, source) in sources.iter().enumerate().filter(|(_, source)| source.area > 0.0) {
            let exact = solution.exitance(i)[k];
            square += source.area * (exitance[i][k] - exact).powi(2);
            signed += source.area * (exitance[i][k] - exact);
            sum += source.area * exact;
            count += source.area;
        }
        let rms = (square / count).sqrt() / (sum / count);
        eprintln!("channel {k}: rms {rms:.4} bias {:+.4} mean {:.4e}", signed / sum, sum / count);
        worst = worst.max(rms);
    }
    at_most("boundary against dense sums", worst, bound)
}

#[test]
fn exitance_is_that_of_dense_sums() {
    let model = sphere_with(48);
    let sun = Light::Directional(DirectionalLight { irradiance: [3.0; 3], ..Default::default() });
    holds(agrees(&model, medium(), &[sun], 0.02));
    notices(agrees(&model, medium(), &[sun], 1e-6));
}

#[test]
fn frames() {
    let mesh = translume_mesh::builtin::creature_with(20000);
    let model = Model::new(mesh, std::env::var("AT").map_or(192, |t| t.parse().unwrap()));
    let medium = Medium { ior: 1.0, ..Medium::SKIMMILK };
    let camera = translume::LookAt { eye: [60.0, 89.0, 250.0], target: [0.0, 49.0, 0.0], up: [0.0, 1.0, 0.0], horizontal_fov: 0.5, aspect: 1.0, near: 1.0, far: 1000.0 };
    let frame = |k: f32| {
        let mut pose = Pose::rest(1);
        pose.weights = vec![0.0];
        pose.warp.twist = k.to_radians();
        let (sin, cos) = (0.05236 * k).sin_cos();
        (pose, [Light::Directional(DirectionalLight { to_light: [sin, 0.3, cos], irradiance: [3.0; 3], ..Default::default() })])
    };
    for transport in Transport::ALL {
        let body = || Fixture::new(&model, |d| (d.medium, d.transport, d.method, d.profile) = (medium, transport, Method::default(), translume::Profile::default()));
        let mut warm = body();
        let mut times = Vec::new();
        for k in 0..6 {
            let (pose, lights) = frame(k as f32);
            let mut f = pose.frame(&lights);
            let look = translume::Camera::from(camera);
            f.view = Some(translume::View { camera: look, pixels: [512, 512] });
            if transport != Transport::BoundaryLayers { f.view = None; }
            let start = std::time::Instant::now();
            warm.run(&f);
            let exitance = warm.exitance();
            times.push(start.elapsed().as_secs_f64());
            if k == 5 || k == 1 {
                let mut cold = body();
                cold.run(&f);
                let exact = cold.exitance();
                let areas: Vec<f64> = warm.sources().iter().map(|s| s.area).collect();
                for c in 0..3 {
                    let (mut square, mut sum, mut count) = (0.0, 0.0, 0.0);
                    for i in 0..areas.len() { square += areas[i] * (exitance[i][c] - exact[i][c]).powi(2); sum += areas[i] * exact[i][c]; count += areas[i]; }
                    eprintln!("frame {k} {transport:?} lag {c}: {:.4}", (square / count).sqrt() / (sum / count));
                }
            }
        }
        eprintln!("{transport:?} {} texels: {times:.3?}", warm.body.texels());
    }
}
