//! `translume trace`: what it writes, what it refuses, and how it compares with references from elsewhere.

use crate::desk::{Desk, check_refusal, read_exr, translume};
use std::path::Path;

const LIGHTS: &str = r#""lights": [
    { "type": "directional", "to_light": [0.6, 0.8, 0], "irradiance": [3, 3, 3] },
    { "type": "constant_env", "radiance": [0.2, 0.3, 0.4] }
  ]"#;

fn scene(eta: f64, lights: &str) -> String {
    format!(
        r#"{{ "shape": {{ "type": "sphere", "center": [0, 0, 0], "radius": 5 }}, {lights},
        "material": {{ "sigma_s_prime": [0.5, 1, 2], "sigma_a": [0.01, 0.02, 0.03], "g": 0.3, "eta": {eta} }},
        "camera": {{ "eye": [0, 0, 60], "target": [0, 0, 0], "fov_deg": 12, "width": 24, "height": 16 }} }}"#
    )
}

/// Runs the command with an output and returns its picture.
fn trace(desk: &Desk, scene: &str, name: &str, more: &[&str]) -> Vec<[f32; 3]> {
    let output = desk.path(name);
    let mut arguments = vec!["trace", scene, "-o", output.to_str().unwrap()];
    arguments.extend_from_slice(more);
    let run = translume(&arguments);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    if name.ends_with("exr") { read_exr(&output).1 } else { Vec::new() }
}

fn mean(picture: &[[f32; 3]], channel: usize) -> f64 {
    picture.iter().map(|rgb| f64::from(rgb[channel])).sum::<f64>() / picture.len() as f64
}

#[test]
fn pictures_errors_and_single_scattering_are_written() {
    let desk = Desk::new();
    let scene = desk.file("ball.json", scene(1.0, LIGHTS));
    let [error, single] =
        ["error.exr", "single.exr"].map(|name| desk.path(name).to_str().unwrap().to_owned());
    let files = ["--stderr", &error, "--single", &single];
    let picture = trace(&desk, &scene, "a.exr", &[&["--samples", "8"][..], &files].concat());
    let [error, single] = [&error, &single].map(|path| read_exr(Path::new(path)).1);
    assert_eq!((picture.len(), error.len(), single.len()), (24 * 16, 24 * 16, 24 * 16));
    for k in 0..3 {
        assert!(mean(&picture, k) > 1.1 * mean(&single, k) && mean(&single, k) > 0.0);
        assert!(mean(&error, k) > 0.01 * mean(&picture, k) && mean(&error, k) < mean(&picture, k));
    }
    assert_eq!(picture[0], [0.0; 3], "the corner is empty");
    assert_eq!(trace(&desk, &scene, "b.exr", &["--samples", "8"]), picture, "runs repeat");
    assert_ne!(trace(&desk, &scene, "c.exr", &["--samples", "8", "--seed", "2"]), picture);
    assert_eq!(trace(&desk, &scene, "d.exr", &["--samples", "2", "--size", "48"]).len(), 48 * 32);
    trace(&desk, &scene, "e.png", &["--noise", "0.5"]);
    assert!(std::fs::metadata(desk.path("e.png")).unwrap().len() > 300);
}

#[test]
fn limits_end_the_work() {
    let desk = Desk::new();
    let scene = desk.file("ball.json", scene(1.0, LIGHTS));
    let error = desk.path("error.exr").to_str().unwrap().to_owned();
    let noise = |limit: &str| {
        let picture = trace(&desk, &scene, "a.exr", &["--noise", limit, "--stderr", &error]);
        let square: f64 = read_exr(Path::new(&error)).1.iter().map(|rgb| f64::from(rgb[0]).powi(2)).sum();
        // Over the whole picture rather than the body, which fills 0.4 of it: smaller by the root of 0.4 over 0.4.
        (square / picture.len() as f64).sqrt() / mean(&picture, 0)
    };
    let (coarse, fine) = (noise("0.2"), noise("0.05"));
    assert!(fine < 0.5 * coarse && fine > 0.1 * coarse, "{coarse} {fine}");
    let start = std::time::Instant::now();
    trace(&desk, &scene, "a.exr", &["--seconds", "0.5", "--size", "256"]);
    // A batch of paths and the start of the program come on top.
    assert!((0.5..5.0).contains(&start.elapsed().as_secs_f64()), "{:?}", start.elapsed());
}

#[test]
fn what_cannot_be_traced_is_named() {
    let desk = Desk::new();
    let refused = |arguments: &[&str], words: &[&str]| {
        let output = desk.path("out.exr");
        let all = [&["trace", "-o", output.to_str().unwrap()], arguments].concat();
        check_refusal(&desk, &translume(&all), words)
            .unwrap_or_else(|problem| panic!("{arguments:?}: {problem}"));
    };
    let fine = desk.file("ball.json", scene(1.0, LIGHTS));
    let glass = desk.file("glass.json", scene(1.3, LIGHTS));
    refused(&[&glass], &["light 0", "refracts", "1.3", "extent"]);
    refused(&[&fine, "--noise", "0"], &["--noise", "0", "positive"]);
    refused(&[&fine, "--seconds", "nan"], &["--seconds", "NaN"]);
    let png = desk.path("error.png");
    refused(&[&fine, "--stderr", png.to_str().unwrap()], &["error.png", ".exr"]);
    refused(&[desk.path("gone.json").to_str().unwrap()], &["gone.json"]);
    desk.file("sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n");
    let sheet = desk.file("sheet.json", r#"{ "shape": { "type": "mesh", "file": "sheet.obj" } }"#);
    refused(&[&sheet], &["3 edges", "close"]);
}

/// A light through glass that has an extent is no obstacle.
#[test]
fn glass_takes_light_from_the_sky() {
    let desk = Desk::new();
    let sky = r#""lights": [{ "type": "constant_env", "radiance": [1, 1, 1] }]"#;
    let scene = desk.file("glass.json", scene(1.3, sky));
    let picture = trace(&desk, &scene, "a.exr", &["--samples", "16"]);
    let middle = picture[8 * 24 + 12];
    // What enters is 0.98, and of the channel that absorbs most two thirds come back.
    assert!(middle.iter().all(|c| (0.6..0.97).contains(c)), "{middle:?}");
}

/// Five scenes with references by another program, in the folder that an environment variable names.
#[test]
fn means_agree_with_references() {
    let Some(folder) = std::env::var_os("TRANSLUME_REFERENCES") else {
        return;
    };
    let folder = Path::new(&folder);
    let desk = Desk::new();
    for name in
        ["c01_slab_edge", "c02_sphere_dir", "c04_bunny_back", "c07_sphere_furnace", "c08_sphere_env_eta13"]
    {
        let scene = folder.join(format!("cases/{name}.json"));
        let error = desk.path("error.exr").to_str().unwrap().to_owned();
        let picture = trace(&desk, scene.to_str().unwrap(), "a.exr", &["--samples", "4", "--stderr", &error]);
        let error = read_exr(Path::new(&error)).1;
        let [truth, own, mask] =
            ["ref", "stderr", "mask"].map(|kind| read_exr(&folder.join(format!("ref/{name}.{kind}.exr"))).1);
        let inside: Vec<usize> = (0..mask.len()).filter(|&pixel| mask[pixel][0] > 0.5).collect();
        for k in 0..3 {
            let sum = |of: &dyn Fn(usize) -> f64| inside.iter().map(|&pixel| of(pixel)).sum::<f64>();
            let variance = sum(&|p| f64::from(error[p][k]).powi(2) + f64::from(own[p][k]).powi(2));
            let (found, exact) = (sum(&|p| picture[p][k].into()), sum(&|p| truth[p][k].into()));
            // Single precision of the files, where nothing is left to chance.
            let tolerance = 3.0 * variance.sqrt() + 1e-6 * exact;
            assert!((found - exact).abs() <= tolerance, "{name} {k}: {found} {exact} ± {}", variance.sqrt());
            assert!((found - 1.15 * exact).abs() > tolerance, "{name} {k}: 15 % must be noticed");
        }
    }
}
