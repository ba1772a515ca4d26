//! What layout and order of the texels do to the scatter.

use std::sync::Arc;

use translume::{DirectionalLight, Light, Medium, Method, PointLight};
use translume_mesh::{Atlas, AtlasOptions, Mesh, builtin, load};
use translume_reference::converged::Converged;
use translume_tests::{Fixture, Model, Pose, light, relative_rmse};

fn twin(medium: &Medium) -> translume_reference::Medium {
    translume_reference::Medium {
        sigma_s_prime: medium.sigma_s_prime.map(f64::from),
        sigma_a: medium.sigma_a.map(f64::from),
        ior: medium.ior.into(),
    }
}

fn show(
    model: &Arc<Model>,
    medium: Medium,
    method: Method,
    mm: f32,
    lights: &[Light],
) -> (Fixture, Vec<[f64; 3]>) {
    let mut fixture = Fixture::new(model, |d| (d.medium, d.method, d.mm_per_unit) = (medium, method, mm));
    fixture.run(&Pose::rest(model.mesh.targets.len()).frame(lights));
    let exitance = fixture.exitance();
    (fixture, exitance)
}

/// Relative RMSE of the texels' exitance against the converged integral at their centres, at 400 of them.
fn total_error(mesh: &Mesh, options: &AtlasOptions) -> f64 {
    // Mean free paths of .3 to 1.4 mm: skim milk's green, marble's red and the first skin's blue.
    let medium =
        Medium { sigma_s_prime: [2.19, 1.22, 1.01], sigma_a: [0.0021, 0.0025, 0.48], ior: 1.3, g: 0.0 };
    let sun = Light::Directional(DirectionalLight {
        to_light: [0.4, 0.7, 0.5],
        shadow: false,
        ..Default::default()
    });
    let mm = 100.0 / mesh.diagonal();
    let atlas = Atlas::build(mesh, options, |_| true).unwrap();
    let model = Arc::new(Model { mesh: mesh.clone(), atlas });
    let (fixture, exitance) = show(&model, medium, Method::Tree { theta: 0.25 }, mm, &[sun]);
    let surface = fixture.twin_surface(&Pose::rest(mesh.targets.len()));
    let lights = [light(&sun, f64::from(mm))];
    let converged = Converged::new(&surface, &lights, &twin(&medium), 1.0);
    let sources = fixture.sources();
    let inside: Vec<usize> = (0..sources.len()).filter(|&k| sources[k].area > 0.0).collect();
    let picked: Vec<usize> = (0..400).map(|k| inside[k * inside.len() / 400]).collect();
    let places: Vec<_> = picked.iter().map(|&k| sources[k].position).collect();
    let measured: Vec<_> = picked.iter().map(|&k| exitance[k]).collect();
    relative_rmse(&measured, &converged.exitance(&places))
}

/// Figures: `TRANSLUME_MODELS=… cargo test --release -p translume-tests --test gpu -- --ignored --nocapture equal_areas`.
///
/// One layout differs from the next by where charts happen to lie on the texels, so each figure is a mean over ten sizes.
#[test]
#[ignore = "minutes on a software rasteriser; for reading"]
fn equal_areas_in_figures() {
    let mut meshes = vec![builtin::creature_with(20_000), builtin::teapot()];
    if let Some(folder) = std::env::var_os("TRANSLUME_MODELS") {
        for name in ["spot.obj", "rocker-arm.obj"] {
            meshes.push(load::load(&std::path::Path::new(&folder).join(name)).unwrap().mesh);
        }
    }
    println!(
        "| mesh | error % with unequal texels | with equal ones | ratio, geometric mean ± standard error |"
    );
    println!("| --- | --- | --- | --- |");
    for mesh in meshes {
        let sizes: Vec<u32> = (0..10).map(|k| 112 + 11 * k).collect();
        let errors = |equiareal| -> Vec<f64> {
            let options = |&size| AtlasOptions { size, equiareal, ..AtlasOptions::default() };
            sizes.iter().map(|size| total_error(&mesh, &options(size))).collect()
        };
        let [unequal, equal] = [false, true].map(errors);
        let count = sizes.len() as f64;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / count;
        let logs: Vec<f64> = equal.iter().zip(&unequal).map(|(e, u)| (e / u).ln()).collect();
        let variance = logs.iter().map(|l| (l - mean(&logs)).powi(2)).sum::<f64>() / (count - 1.0);
        println!(
            "| {} | {:.3} | {:.3} | {:.3} ± {:.3} |",
            mesh.name,
            100.0 * mean(&unequal),
            100.0 * mean(&equal),
            mean(&logs).exp(),
            (variance / count).sqrt()
        );
    }
}

/// Median splits along the longest side of a box of any dimension, as the atlas does in three.
fn kd_order<const N: usize>(points: &[[f64; N]]) -> Vec<usize> {
    fn split<const N: usize>(order: &mut [usize], points: &[[f64; N]]) {
        if order.len() < 2 {
            return;
        }
        let side = |axis: usize| {
            let along = order.iter().map(|&k| points[k][axis]);
            along.clone().fold(f64::MIN, f64::max) - along.fold(f64::MAX, f64::min)
        };
        let axis = (0..N).max_by(|&a, &b| side(a).total_cmp(&side(b))).unwrap();
        let left = order.len().next_power_of_two() / 2;
        order.select_nth_unstable_by(left, |&a, &b| {
            points[a][axis].total_cmp(&points[b][axis]).then(a.cmp(&b))
        });
        let (left, right) = order.split_at_mut(left);
        split(left, points);
        split(right, points);
    }
    let mut order: Vec<usize> = (0..points.len()).collect();
    split(&mut order, points);
    order
}

/// The atlas with its texels sorted by position and, `reach` model units long, normal.
fn sorted_by_normal(model: &Model, reach: f64) -> Arc<Model> {
    let mesh: &Mesh = &model.mesh;
    let atlas = &model.atlas;
    let points: Vec<[f64; 6]> = atlas
        .texels
        .iter()
        .map(|t| {
            let corners = mesh.triangles[t.triangle as usize];
            let p = t.interpolate(corners.map(|v| mesh.positions[v as usize]));
            let n = t.interpolate(corners.map(|v| mesh.normals[v as usize]));
            std::array::from_fn(|k| if k < 3 { p[k].into() } else { reach * f64::from(n[k - 3]) })
        })
        .collect();
    let order = kd_order(&points);
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(new, &old)| place[old] = new as u32);
    let mut sorted = atlas.clone();
    sorted.texels = order.iter().map(|&k| atlas.texels[k]).collect();
    sorted.pixels.iter_mut().filter(|p| **p != Atlas::EMPTY).for_each(|p| *p = place[*p as usize]);
    Arc::new(Model { mesh: mesh.clone(), atlas: sorted })
}

/// Figures: `cargo test --release -p translume-tests --test gpu -- --ignored --nocapture texel_order`.
#[test]
#[ignore = "minutes on a software rasteriser; for reading"]
fn texel_order_in_figures() {
    println!("| sheet, mm | medium | order | θ .4: error % | θ .6 | θ .8 |");
    println!("| --- | --- | --- | --- | --- | --- |");
    for thickness in [0.2_f32, 1.0, 4.0] {
        let mesh = builtin::cuboid([0.0; 3], [50.0, thickness, 50.0], [16, 1, 16]);
        let model = Model::new(mesh, 96);
        let lamp = [Light::Point(PointLight {
            position: [15.0, -8.0, 20.0],
            intensity: [300.0; 3],
            shadow: false,
            ..Default::default()
        })];
        let texel = 50.0 / 60.0;
        for name in ["skimmilk", "skin1", "marble"] {
            let medium = Medium::preset(name).unwrap();
            let exact = show(&model, medium, Method::AllPairs, 1.0, &lamp).1;
            for (label, reach) in [
                ("position", 0.0),
                ("normal 2 texels", 2.0 * texel),
                ("normal 8 texels", 8.0 * texel),
                ("normal 32 texels", 32.0 * texel),
            ] {
                let sorted = sorted_by_normal(&model, reach);
                let back: Vec<usize> = sorted
                    .atlas
                    .texels
                    .iter()
                    .map(|t| model.atlas.texels.iter().position(|u| u.pixel == t.pixel).unwrap())
                    .collect();
                let reference: Vec<[f64; 3]> = back.iter().map(|&k| exact[k]).collect();
                let errors: Vec<String> = [0.4, 0.6, 0.8]
                    .iter()
                    .map(|&theta| {
                        let found = show(&sorted, medium, Method::Tree { theta }, 1.0, &lamp).1;
                        format!("{:.3}", 100.0 * relative_rmse(&found, &reference))
                    })
                    .collect();
                println!("| {thickness} | {name} | {label} | {} |", errors.join(" | "));
            }
        }
    }
}
