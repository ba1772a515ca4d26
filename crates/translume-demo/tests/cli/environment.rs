//! Light from equirectangular maps.

use crate::desk::{Desk, check_refusal, read_exr, refused, translume};

const SIZE: usize = 24;
const SPHERE: &str =
    r#""shape": { "type": "sphere", "center": [0, 0, 0], "radius": 50 }, "medium": "marble""#;

/// A map with a sun at +x.
fn pixel(x: usize, y: usize) -> [f32; 3] {
    if (31..33).contains(&x) && (15..17).contains(&y) { [400.0; 3] } else { [0.5; 3] }
}

fn exr(desk: &Desk) -> String {
    let path = desk.path("sun.exr");
    exr::prelude::write_rgb_file(&path, 64, 32, |x, y| pixel(x, y).into()).unwrap();
    path.to_str().unwrap().to_owned()
}

fn hdr(desk: &Desk) -> String {
    let path = desk.path("sun.hdr");
    let pixels: Vec<_> = (0..64 * 32).map(|k| image::Rgb(pixel(k % 64, k / 64))).collect();
    let encoder = image::codecs::hdr::HdrEncoder::new(std::fs::File::create(&path).unwrap());
    encoder.encode(&pixels, 64, 32).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Radiance of the left and the right half of a picture.
fn halves(desk: &Desk, arguments: &[&str]) -> [f32; 2] {
    let path = desk.path("halves.exr");
    let size = SIZE.to_string();
    let mut all = vec!["render", "-o", path.to_str().unwrap(), "--size", &size, "--atlas", "48"];
    all.extend_from_slice(&["--shadow", "256"]);
    all.extend_from_slice(arguments);
    let output = translume(&all);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let (width, pixels) = read_exr(&path);
    assert_eq!(width, SIZE);
    let mut sums = [0.0; 2];
    for (k, pixel) in pixels.iter().enumerate() {
        sums[usize::from(k % width >= width / 2)] += pixel[1];
    }
    sums
}

fn is_brighter(bright: f32, dark: f32) -> bool {
    bright > 2.0 * dark
}

#[test]
fn the_side_towards_the_sun_is_bright() {
    let desk = Desk::new();
    let model = ["sphere", "--medium", "marble", "--view", "0,0", "--gloss", "0"];
    for file in [exr(&desk), hdr(&desk)] {
        let take = |rotation: &str| {
            let lit = [&model[..], &["--env", file.as_str(), "--env-rotation", rotation]].concat();
            halves(&desk, &lit)
        };
        let [left, right] = take("0");
        assert!(is_brighter(right, left), "{file}: {left} {right}");
        let [left, right] = take("-180");
        assert!(is_brighter(left, right), "{file}: {left} {right}");
    }
}

#[test]
fn a_scene_has_an_environment() {
    let desk = Desk::new();
    exr(&desk);
    let camera =
        r#""camera": { "eye": [0, 0, 300], "target": [0, 0, 0], "fov_deg": 24, "width": 8, "height": 8 }"#;
    let take = |settings: &str| {
        let light = format!(r#"{{ "type": "environment", "file": "sun.exr"{settings} }}"#);
        let scene = desk.file("scene.json", format!(r#"{{ {SPHERE}, {camera}, "lights": [{light}] }}"#));
        halves(&desk, &["--scene", &scene])
    };
    let [left, right] = take("");
    assert!(is_brighter(right, left), "{left} {right}");
    let [left, twice] = take(r#", "scale": 2"#);
    assert!((twice / right - 2.0).abs() < 1e-3 && is_brighter(twice, left), "{right} {twice}");
    let [left, right] = take(r#", "rotation_deg": 180"#);
    assert!(is_brighter(left, right), "{left} {right}");
}

#[test]
fn maps_that_cannot_be_are_named() {
    let desk = Desk::new();
    let with = |file: &str, words: &[&str]| refused(&desk, &["sphere", "--env", file], words);
    with(desk.path("gone.exr").to_str().unwrap(), &["gone.exr", "cannot be read"]);
    with(&desk.file("letter.exr", "dear sky"), &["letter.exr", "OpenEXR"]);
    with(&desk.file("letter.hdr", "dear sky"), &["letter.hdr", "Radiance"]);
    with(&desk.file("sky.tiff", "II"), &["sky.tiff", ".exr or .hdr"]);
    refused(&desk, &["sphere", "--env", &exr(&desk), "--env-rotation", "nan"], &["sun.exr", "NaN degrees"]);
    let scene = |light: &str| desk.file("scene.json", format!(r#"{{ {SPHERE}, "lights": [{light}] }}"#));
    let light = r#"{ "type": "environment", "file": "missing.hdr" }"#;
    refused(&desk, &["--scene", &scene(light)], &["missing.hdr", "cannot be read"]);
    let light = r#"{ "type": "environment", "file": "sun.exr", "scale": -2 }"#;
    refused(&desk, &["--scene", &scene(light)], &["sun.exr", "scale is -2"]);
    let light = r#"{ "type": "environment", "file": "sun.exr", "colour": 1 }"#;
    refused(&desk, &["--scene", &scene(light)], &["scene.json", "colour"]);
    // A map that is fine is no refusal.
    let arguments = ["sphere", "--env", &exr(&desk), "--size", "8", "--atlas", "16"];
    assert!(check_refusal(&desk, &crate::desk::render(&desk, &arguments), &[]).is_err());
}
