//! Textures of albedo, as a picture shows them.

use crate::desk::{Desk, check_refusal, read_exr, refused, translume};

/// A block whose texture coordinates are x and y of its front.
const BLOCK: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
    f 5/1 6/2 7/3 8/4\nf 2/2 1/1 4/4 3/3\nf 1/1 5/1 8/4 4/4\nf 6/2 2/2 3/3 7/3\nf 8/4 7/3 3/3 4/4\nf 1/1 2/2 6/2 5/1\n";

/// Green over red in the left and in the right half of the front.
fn tints(desk: &Desk, scene: &str) -> [f32; 2] {
    let output = desk.path("tints.exr");
    let arguments = ["--scene", scene, "--atlas", "64", "--shadow", "256", "-o", output.to_str().unwrap()];
    let done = translume(&[&["render"][..], &arguments].concat());
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let (width, pixels) = read_exr(&output);
    let mean = |columns: std::ops::Range<usize>, channel: usize| {
        let part = pixels.chunks(width).flat_map(|row| &row[columns.clone()]);
        part.map(|pixel| pixel[channel]).sum::<f32>()
    };
    // Away from the edge between the colours, which the light blurs.
    let (left, right) = (0..3 * width / 8, 5 * width / 8..width);
    [left, right].map(|columns| mean(columns.clone(), 1) / mean(columns, 0))
}

#[test]
fn a_half_red_texture_reddens_a_half() {
    let desk = Desk::new();
    desk.file("block.obj", BLOCK);
    let half =
        image::RgbImage::from_fn(32, 4, |x, _| image::Rgb(if x < 16 { [255, 0, 0] } else { [255; 3] }));
    half.save(desk.path("half.png")).unwrap();
    let scene = |albedo: &str| {
        format!(
            r#"{{ "shape": {{ "type": "mesh", "file": "block.obj" }}, "mm_per_unit": 50, {albedo}
                "material": {{ "sigma_s_prime": [2, 2, 2], "sigma_a": [0.01, 0.01, 0.01] }},
                "lights": [{{ "type": "constant_env", "radiance": [1, 1, 1], "shadow": false }}],
                "camera": {{ "eye": [0.5, 0.5, 5], "target": [0.5, 0.5, 0], "fov_deg": 14, "width": 32, "height": 32 }} }}"#
        )
    };
    let plain = tints(&desk, &desk.file("plain.json", scene("")));
    let textured = tints(&desk, &desk.file("textured.json", scene(r#""albedo": "half.png","#)));
    // The medium is grey; what reaches the red half's pixels from elsewhere still passes its albedo of 0.
    assert!(plain.iter().all(|tint| (tint - 1.0).abs() < 0.01), "{plain:?}");
    assert!(textured[0] < 0.02 && (textured[1] - 1.0).abs() < 0.2, "{textured:?}");
}

#[test]
fn textures_that_cannot_be_are_named() {
    let desk = Desk::new();
    let block = desk.file("block.obj", BLOCK);
    refused(&desk, &[&block, "--albedo", "gone.png"], &["gone.png", "cannot be read"]);
    refused(&desk, &[&block, "--albedo", &block], &["block.obj", "neither a PNG nor a JPEG"]);
    refused(&desk, &["creature", "--albedo", "gone.png"], &["creature", "texture coordinates", "remove"]);
    let scene = r#"{ "shape": { "type": "mesh", "file": "block.obj" }, "albedo": "half.png" }"#;
    let output = desk.path("out.exr");
    let traced = translume(&["trace", &desk.file("scene.json", scene), "-o", output.to_str().unwrap()]);
    check_refusal(&desk, &traced, &["half.png", "paths", "remove `albedo`"]).unwrap();
}
