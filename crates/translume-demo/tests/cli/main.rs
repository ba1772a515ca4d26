//! The command as people use it: what it writes, and what it says when it cannot.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test may stop where it cannot go on, in its helpers too"
)]

mod albedo;
mod desk;
mod environment;
mod methods;
mod profile;
mod report;
mod scatter;
mod trace;

use desk::{Desk, check_refusal, read_exr, refused, render, translume};
use std::path::Path;

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

#[test]
fn files_that_cannot_be_rendered_are_named() {
    let desk = Desk::new();
    refused(&desk, &[desk.path("absent.obj").to_str().unwrap()], &["absent.obj"]);
    refused(
        &desk,
        &[&desk.file("noise.obj", [0x89, b'P', b'N', b'G', 0, 1, 2, 255])],
        &["noise.obj", "mesh"],
    );
    refused(&desk, &[&desk.file("letter.txt", "dear mesh")], &["letter.txt", "obj"]);
    refused(&desk, &[&desk.file("cut.glb", b"glTF\x02\0\0\0\xff\0\0\0")], &["cut.glb"]);

    let far = TETRAHEDRON.replace("f 1 4 3", "f 1 4 99");
    refused(&desk, &[&desk.file("far.obj", far)], &["far.obj", "face 4", "99", "4"]);
    let nan = TETRAHEDRON.replace("v 0 1 0", "v 0 nan 0");
    refused(&desk, &[&desk.file("nan.obj", nan)], &["nan.obj", "vertex 3"]);
    let flat = "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n";
    refused(&desk, &[&desk.file("flat.obj", flat)], &["flat.obj", "area"]);
}

#[test]
fn options_that_cannot_be_are_named() {
    let desk = Desk::new();
    let mesh = desk.file("ok.obj", TETRAHEDRON);
    refused(&desk, &[&mesh, "--medium", "kryptonite"], &["kryptonite", "skimmilk"]);
    refused(&desk, &[&mesh, "--profile", "tripole"], &["tripole", "dipole"]);
    refused(&desk, &[&mesh, "--method", "magic"], &["magic", "tree"]);
    refused(&desk, &[&mesh, "--atlas", "100000"], &["--atlas", "100000"]);
    refused(&desk, &[&mesh, "--atlas", "3"], &["3"]);
    refused(&desk, &[&mesh, "--size", "16000", "--samples", "8"], &["--size", "16000"]);
    refused(&desk, &[&mesh, "--mm-per-unit", "0"], &["ok.obj", "mm per unit"]);
    refused(&desk, &[&mesh, "--theta", "9"], &["--theta", "9 is not between"]);
    refused(&desk, &[&mesh, "--theta", "0.5", "--method", "all-pairs"], &["--theta", "all-pairs"]);
    refused(&desk, &[&mesh, "--tolerance", "0"], &["--tolerance", "0 is not between"]);
    refused(&desk, &[&mesh, "--tolerance", "0.01", "--method", "tree"], &["--tolerance", "tree"]);
    refused(&desk, &[&mesh, "--evaluate", "pixel"], &["--evaluate", "pixel", "fragment"]);
    refused(&desk, &[&mesh, "--evaluate", "vertex", "--method", "tree"], &["--evaluate", "tree"]);
    refused(&desk, &[&mesh, "--morph", "0.5"], &["--morph", "0 morph targets"]);
    refused(&desk, &[&mesh, "--twist", "60000"], &["--twist", "60000 degrees", "57296"]);
    refused(&desk, &[&mesh, "--bend=-inf"], &["--bend", "-inf"]);
    refused(&desk, &[&mesh, "--inflate", "nan"], &["--inflate", "NaN"]);
    refused(&desk, &[&mesh, "--animation", "Walk"], &["--animation", "ok.obj", "no animations"]);
    refused(&desk, &[&mesh, "--time", "1"], &["--time", "ok.obj", "no animations"]);
    refused(&desk, &[&mesh, "--charts", "mine"], &["--charts", "mine", "unwrap, own, auto"]);
    refused(&desk, &[&mesh, "--charts", "own"], &["ok.obj", "texture coordinates", "it has none"]);
    refused(&desk, &["torus-knot", "--into", "egg"], &["torus-knot", "genus is 1"]);
    refused(&desk, &["dodecahedron"], &["dodecahedron"]);
    let scene = desk.file("scene.json", r#"{ "shape": { "type": "mesh", "file": "gone.obj" } }"#);
    refused(&desk, &["--scene", &scene], &["gone.obj"]);
    let shape = r#""shape": { "type": "sphere", "center": [0, 0, 0], "radius": 1 }"#;
    let scene = desk.file("warp.json", format!(r#"{{ {shape}, "warp": {{ "bend_deg": 1e6 }} }}"#));
    refused(&desk, &["--scene", &scene], &["warp.json", "bend: 1000000 degrees"]);
    refused(&desk, &["--scene", &scene, "--bend", "9e9"], &["--bend", "9000000000 degrees"]);
    let scene = desk.file("play.json", format!(r#"{{ {shape}, "animation": 3, "time": 1 }}"#));
    refused(&desk, &["--scene", &scene], &["play.json", "animation: ", "no animations"]);
}

#[test]
fn a_silent_failure_would_be_noticed() {
    let desk = Desk::new();
    let fine = render(&desk, &[&desk.file("ok.obj", TETRAHEDRON), "--atlas", "16", "--size", "8"]);
    assert!(check_refusal(&desk, &fine, &[]).is_err(), "success is no refusal");
}

#[test]
fn an_output_that_cannot_be_written_is_refused_before_the_work() {
    let desk = Desk::new();
    let mesh = desk.file("ok.obj", TETRAHEDRON);
    for (name, word) in [("nowhere/out.png", "directory"), ("out.gif", ".png")] {
        let path = desk.path(name);
        let output = translume(&["render", &mesh, "-o", path.to_str().unwrap()]);
        check_refusal(&desk, &output, &[name, word]).unwrap_or_else(|problem| panic!("{name}: {problem}"));
    }
}

#[test]
fn a_furnace_scene_shows_its_sky() {
    let desk = Desk::new();
    let scene = desk.file(
        "furnace.json",
        r#"{ "name": "furnace", "length_unit": "mm",
             "shape": { "type": "sphere", "center": [0, 0, 0], "radius": 50 },
             "material": { "sigma_s_prime": [11.6, 20.4, 14.9], "sigma_a": [0, 0, 0], "g": 0, "eta": 1 },
             "lights": [{ "type": "constant_env", "radiance": [1, 1, 1] }],
             "camera": { "eye": [0, 0, 300], "target": [0, 0, 0], "up": [0, 1, 0], "fov_deg": 20, "width": 40, "height": 20 } }"#,
    );
    let path = desk.path("furnace.exr");
    let output = translume(&["render", "--scene", &scene, "--atlas", "64", "-o", path.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let (width, pixels) = read_exr(&path);
    assert_eq!((width, pixels.len()), (40, 800));
    let middle = pixels[10 * 40 + 20];
    // 2 %: the furnace bound; the dipole itself loses 0.3 % to the curvature of this sphere.
    assert!(middle.iter().all(|c| (c - 1.0).abs() < 0.02), "{middle:?}");
    assert_eq!(pixels[0], [0.0; 3], "nothing is behind the body");
}

#[test]
fn a_lit_region_ends_where_it_says() {
    let desk = Desk::new();
    let scene = desk.file(
        "edge.json",
        r#"{ "shape": { "type": "box", "min": [-20, -10, -20], "max": [20, 0, 20] },
             "material": { "sigma_s_prime": [30, 30, 30], "sigma_a": [1, 1, 1], "eta": 1 },
             "lights": [{ "type": "directional", "to_light": [0, 1, 0], "irradiance": [1, 1, 1],
                          "lit_region": { "axis": "x", "min": 5 } }],
             "camera": { "eye": [0, 100, 0], "target": [0, 0, 0], "up": [0, 0, -1], "fov_deg": 20, "width": 64, "height": 8 } }"#,
    );
    let path = desk.path("edge.exr");
    let output = translume(&["render", "--scene", &scene, "--atlas", "128", "-o", path.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let (_, pixels) = read_exr(&path);
    let row = &pixels[4 * 64..5 * 64];
    let level = row[60][0];
    let edge = (0..64).find(|&x| row[x][0] > 0.5 * level).unwrap();
    // The picture is 35.3 mm wide: x = 5 mm lies at pixel 41.1; a texel is 0.6 mm, one pixel.
    assert!((40..=42).contains(&edge), "{edge}");
    assert!(row[20][0] < 0.02 * level, "dark means dark");
}

#[test]
fn a_morph_becomes_an_animation() {
    let desk = Desk::new();
    let mesh = desk.file("ok.obj", TETRAHEDRON);
    let path = desk.path("turn.png");
    let arguments =
        ["render", &mesh, "--frames", "3", "--size", "16", "--atlas", "32", "-o", path.to_str().unwrap()];
    assert!(translume(&arguments).status.success());
    let (frames, seconds) = read_png(&path);
    assert_eq!((frames.len(), seconds), (3, 417.0 / 10_000.0));
    assert!(frames[0] != frames[1] && frames[1] != frames[2], "something moves");
}

#[test]
fn stages_are_timed_on_request() {
    let desk = Desk::new();
    let mesh = desk.file("ok.obj", TETRAHEDRON);
    let print = |more: &[&str]| {
        let mut all = vec![mesh.as_str(), "--frames", "3", "--size", "16", "--atlas", "32"];
        all.extend_from_slice(more);
        let output = render(&desk, &all);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let table = print(&["--timings"]);
    let whole = if table.contains("wall clock") { "frame" } else { "all" };
    assert!(table.contains(&format!("| {whole} | 3 | ")), "a line for the whole of three frames: {table}");
    assert_eq!(print(&[]), "");
}

/// Bytes of every frame, and how long the last is shown.
fn read_png(path: &Path) -> (Vec<Vec<u8>>, f32) {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let count = reader.info().animation_control().map_or(1, |control| control.num_frames);
    let frame = |_| {
        let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut buffer).unwrap();
        buffer
    };
    let frames = (0..count).map(frame).collect();
    let delay = reader.info().frame_control().map_or((0, 1), |frame| (frame.delay_num, frame.delay_den));
    (frames, f32::from(delay.0) / f32::from(delay.1))
}

/// A tetrahedron that hops by its own height within a second, and lands again in the next.
fn hopper(desk: &Desk) -> String {
    let floats = [
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, // positions
        0.0, 1.0, 2.0, // times
        0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, // translations
    ];
    let bytes = floats.iter().flat_map(|x: &f32| x.to_le_bytes());
    let indices = [0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2];
    desk.file("hopper.bin", bytes.chain(indices).collect::<Vec<u8>>());
    desk.file(
        "hopper.gltf",
        r#"{ "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
             "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
             "animations": [{ "name": "Hop", "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }],
                              "samplers": [{ "input": 2, "output": 3 }] }],
             "buffers": [{ "uri": "hopper.bin", "byteLength": 108 }],
             "bufferViews": [{ "buffer": 0, "byteLength": 48 }, { "buffer": 0, "byteOffset": 96, "byteLength": 12 },
                             { "buffer": 0, "byteOffset": 48, "byteLength": 12 }, { "buffer": 0, "byteOffset": 60, "byteLength": 36 }],
             "accessors": [
               { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1] },
               { "bufferView": 1, "componentType": 5121, "count": 12, "type": "SCALAR" },
               { "bufferView": 2, "componentType": 5126, "count": 3, "type": "SCALAR", "min": [0], "max": [2] },
               { "bufferView": 3, "componentType": 5126, "count": 3, "type": "VEC3" }] }"#,
    )
}

#[test]
fn an_animation_plays_and_the_camera_sees_it_all() {
    let desk = Desk::new();
    let hopper = hopper(&desk);
    let path = desk.path("hop.png");
    let take = |arguments: &[&str]| {
        let mut all =
            vec!["render", hopper.as_str(), "--size", "32", "--atlas", "32", "-o", path.to_str().unwrap()];
        all.extend_from_slice(arguments);
        let output = translume(&all);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        read_png(&path)
    };
    let (frames, seconds) = take(&["--animation", "Hop", "--frames", "4"]);
    assert_eq!((frames.len(), seconds), (4, 0.5));
    assert!(frames[0] != frames[1] && frames[1] != frames[2]);
    // Half way up it passes the same place as half way down.
    assert_eq!(frames[1], frames[3]);
    let lit = |frame: &[u8]| frame.chunks(3).filter(|pixel| pixel[1] > 100).count();
    let (low, high) = (lit(&frames[0]), lit(&frames[2]));
    assert!(low.abs_diff(high) < low / 3, "as much of it is seen below as above: {low}, {high}");
    let still = |arguments| take(arguments).0.remove(0);
    assert_eq!(
        still(&["--time", "0.5"]),
        still(&["--animation", "0", "--time", "1.5"]),
        "a number is a name"
    );
    let plain = still(&["--time", "0"]);
    for warp in &[["--twist", "90"], ["--bend", "-30"], ["--inflate", "0.1"]] {
        assert_ne!(still(warp), plain, "{warp:?}");
    }
}

#[test]
fn animations_that_cannot_be_are_named() {
    let desk = Desk::new();
    let hopper = hopper(&desk);
    refused(&desk, &[&hopper, "--animation", "Skip"], &["--animation", "Skip", "hopper.gltf has 0 Hop"]);
    refused(&desk, &[&hopper, "--animation", "1"], &["\"1\"", "0 Hop"]);
    for time in ["2.5", "-1", "nan"] {
        refused(&desk, &[&hopper, "--time", time], &["--time", "lasts 2 s"]);
    }
    let scene = desk.file(
        "hop.json",
        r#"{ "shape": { "type": "mesh", "file": "hopper.gltf" }, "animation": "Hop", "time": 3 }"#,
    );
    refused(&desk, &["--scene", &scene], &["hop.json: time: 3 s", "lasts 2 s"]);
}

#[test]
fn whatever_is_closed_becomes_an_egg() {
    let desk = Desk::new();
    let mesh = desk.file("ok.obj", TETRAHEDRON);
    let path = desk.path("egg.png");
    let take = |arguments: &[&str]| {
        let mut all =
            vec!["render", mesh.as_str(), "--size", "32", "--atlas", "32", "-o", path.to_str().unwrap()];
        all.extend_from_slice(arguments);
        let output = translume(&all);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        (read_png(&path).0.remove(0), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (rest, told) = take(&["--into", "egg", "--morph", "0"]);
    assert!(told.contains("0 triangles flipped"), "{told}");
    assert_ne!(rest, take(&["--into", "egg", "--morph", "1"]).0);
}

#[test]
fn inspect_counts() {
    let desk = Desk::new();
    let mesh = desk.file("ok.obj", TETRAHEDRON);
    let output = translume(&["inspect", &mesh, "--json", "--atlas", "64"]);
    assert!(output.status.success());
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["triangles"], 4);
    for key in
        ["charts", "utilisation", "area_cv", "area_ratio_p99", "flipped", "overlapping_texels", "seconds"]
    {
        assert!(value[key].is_number(), "{key}");
    }
    let text = translume(&["inspect", &mesh, "--atlas", "64"]);
    assert!(String::from_utf8_lossy(&text.stdout).contains("utilisation"));
    let table = translume(&["inspect", &mesh, "teapot", "--table", "--atlas", "64"]);
    let table = String::from_utf8_lossy(&table.stdout).into_owned();
    let rows: Vec<_> = table.lines().collect();
    assert!(
        rows.len() == 4 && rows[2].starts_with("| ok.obj | 4 |") && rows[3].contains("| teapot |"),
        "{table}"
    );
    let columns = |row: &str| row.matches('|').count();
    assert!(rows.iter().all(|row| columns(row) == columns(rows[0])), "{table}");
    assert_eq!(translume(&["inspect", "absent.obj"]).status.code(), Some(2));
}

#[test]
fn help_shows_examples() {
    for arguments in [&["--help"][..], &["render", "--help"]] {
        let output = translume(arguments);
        assert!(output.status.success());
        assert!(String::from_utf8_lossy(&output.stdout).contains("translume render creature"));
    }
}
