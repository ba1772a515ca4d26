//! Files that look wrong and are not: each loads.

use translume_mesh::load::load;

use crate::harness::{Row, row, with_file};
use crate::{gltf, obj, ply};

/// Every file, and its number of triangles.
fn rows() -> Vec<(Row, usize)> {
    let text = |text: &'static str| move || format!("{text}{}", obj::TETRAHEDRON);
    vec![
        (row("sound.obj", text("")), 4),
        (row("of windows.obj", || obj::TETRAHEDRON.replace('\n', "\r\n")), 4),
        (row("with tabs.obj", || obj::TETRAHEDRON.replace(' ', " \t ")), 4),
        (row("without last line end.obj", || obj::TETRAHEDRON.trim_end()), 4),
        (
            row("faces first.obj", || {
                let (vertices, faces) = obj::TETRAHEDRON.split_at(obj::TETRAHEDRON.find('f').unwrap());
                format!("{faces}{vertices}")
            }),
            4,
        ),
        (
            row(
                "of other statements.obj",
                text("mtllib none.mtl\no \u{e9}\ng\ns 1\nusemtl \ncstype bezier\nfoo\n"),
            ),
            4,
        ),
        (row("in latin-1.obj", || [b"# caf\xe9\n", obj::TETRAHEDRON.as_bytes()].concat()), 4),
        (
            row("with an unused vertex that is none.obj", || format!("{}v nan inf 1e99\n", obj::TETRAHEDRON)),
            4,
        ),
        (
            row("with a vertex in exponents.obj", || {
                obj::TETRAHEDRON.replacen("v 1 1 1", "v +10e-1 .1e1 1.", 1)
            }),
            4,
        ),
        (row("with faces of two.obj", || format!("{}f 1 2\nf 3\n", obj::TETRAHEDRON)), 4),
        (
            row("with a comment of ten megabytes.obj", || {
                format!("# {}\n{}", "x".repeat(10_000_000), obj::TETRAHEDRON)
            }),
            4,
        ),
        (row("with a face twice.obj", || format!("{}f 2 3 1\n", obj::TETRAHEDRON)), 4),
        (row("inside out.obj", || obj::TETRAHEDRON.replace("v 1 1 1", "v -1 -1 -1")), 4),
        (
            row("a face of a thousand corners.obj", || {
                let mut text = String::new();
                for k in 0..1_000 {
                    let (y, x) = (f64::from(k) / 1e3 * std::f64::consts::TAU).sin_cos();
                    text += &format!("v {x} {y} {}\n", 0.1 * (3.0 * x).sin());
                }
                text + "f" + &(1..=1_000).map(|k| format!(" {k}")).collect::<String>()
            }),
            998,
        ),
        (row("sound.ply", || ply::TETRAHEDRON), 4),
        (row("little.ply", || ply::binary("binary_little_endian")), 4),
        (row("big.ply", || ply::binary("binary_big_endian")), 4),
        (
            row("on one line.ply", || {
                let (header, body) = ply::TETRAHEDRON.split_once("end_header\n").unwrap();
                format!("{header}end_header\n{}", body.replace('\n', " "))
            }),
            4,
        ),
        (row("with more after the end.ply", || format!("{}the end", ply::TETRAHEDRON)), 4),
        (
            row("with a billion rows of nothing.ply", || {
                ply::TETRAHEDRON.replace("element vertex", "element nothing 1000000000\nelement vertex")
            }),
            4,
        ),
        (row("sound.glb", || gltf::glb(&gltf::document().to_string(), &gltf::buffer())), 4),
        (
            row("with a buffer of more than is used.glb", || {
                let mut bytes = gltf::buffer();
                bytes.extend([7; 1024]);
                gltf::glb(&gltf::document().to_string(), &bytes)
            }),
            4,
        ),
        (row("a thousand levels deep.glb", || gltf::chain(1_000, 1.0)), 4),
        (row("a hundred thousand levels deep.glb", || gltf::chain(100_000, 1.0)), 4),
    ]
}

#[test]
fn every_odd_file_loads() {
    for (row, triangles) in rows() {
        let bytes = (row.bytes)();
        let loaded = with_file(row.name, &bytes, load).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(loaded.mesh.triangles.len(), triangles, "{}", row.name);
    }
}
