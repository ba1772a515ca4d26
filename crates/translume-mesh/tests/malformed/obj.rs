//! OBJ files.

use crate::harness::{Row, row};

pub const TETRAHEDRON: &str =
    "v 1 1 1\nv 1 -1 -1\nv -1 1 -1\nv -1 -1 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n";

/// The tetrahedron with something after it.
fn and(more: &'static str) -> impl Fn() -> String {
    move || format!("{TETRAHEDRON}{more}\n")
}

/// The tetrahedron with something in the place of its first vertex.
fn first(vertex: &'static str) -> impl Fn() -> String {
    move || TETRAHEDRON.replacen("v 1 1 1", vertex, 1)
}

/// Numbers that look random (Knuth's MMIX constants), after some bytes that name a format.
pub fn noise(magic: &[u8], length: usize) -> Vec<u8> {
    let mut state = 1_u64;
    let random = std::iter::repeat_with(|| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 56) as u8
    });
    magic.iter().copied().chain(random).take(length).collect()
}

/// A face that zigzags between two rings, which no fan covers.
fn star(corners: usize) -> String {
    let mut text = String::new();
    for k in 0..corners {
        let (y, x) = (k as f64 / corners as f64 * std::f64::consts::TAU).sin_cos();
        let radius = if k % 2 == 0 { 1.0 } else { 0.5 };
        text += &format!("v {} {} 0\n", radius * x, radius * y);
    }
    text + "f" + &(1..=corners).map(|k| format!(" {k}")).collect::<String>() + "\n"
}

pub fn rows() -> Vec<Row> {
    const TEN_MB: usize = 10_000_000;
    vec![
        row("empty.obj", || ""),
        row("white space.obj", || "\n".repeat(TEN_MB)),
        row("comment.obj", || "# a mesh will follow"),
        row("letter.obj", || "Dear reader,\nfind the mesh enclosed.\n"),
        row("page.obj", || "<!DOCTYPE html><html><body>404 Not Found</body></html>"),
        row("vertices only.obj", || "v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
        row("lines only.obj", || "v 0 0 0\nv 1 0 0\nl 1 2\n"),
        row("utf-16.obj", || TETRAHEDRON.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>()),
        row("utf-16 backwards.obj", || {
            "\u{feff}"
                .encode_utf16()
                .chain(TETRAHEDRON.encode_utf16())
                .flat_map(u16::to_be_bytes)
                .collect::<Vec<u8>>()
        }),
        row("picture.obj", || noise(b"\x89PNG\r\n\x1a\n", 100_000)),
        row("archive.obj", || noise(b"PK\x03\x04", 100_000)),
        row("noise that begins well.obj", || noise(TETRAHEDRON.as_bytes(), 100_000)),
        row("noise without zeros.obj", || {
            noise(b"v ", 100_000).into_iter().filter(|b| *b != 0).collect::<Vec<u8>>()
        }),
        row("zeros.obj", || vec![0; TEN_MB]),
        row("cut in a vertex.obj", || &TETRAHEDRON[..11]),
        row("cut after a sign.obj", || &TETRAHEDRON[..14]),
        row("cut before the faces.obj", || TETRAHEDRON.split_once('f').unwrap().0),
        row("cut in the first face.obj", || &TETRAHEDRON[..TETRAHEDRON.find("f 1 2 3").unwrap() + 5]),
        row("two coordinates.obj", first("v 1 1")),
        row("no coordinates.obj", first("v")),
        row("decimal comma.obj", first("v 1,0 1 1")),
        row("hexadecimal.obj", first("v 0x1 1 1")),
        row("two signs.obj", first("v --1 1 1")),
        row("exponent without digits.obj", first("v 1e 1 1")),
        row("not a number.obj", first("v nan 1 1")),
        row("infinite.obj", first("v 1 inf 1")),
        row("beyond f32.obj", first("v 1 1 1e39")),
        row("vertex missing.obj", first("#")),
        row("far corner.obj", first("v 3e38 1 1")),
        row("microscopic.obj", || TETRAHEDRON.replace('1', "1e-20")),
        row("index 0.obj", and("f 0 1 2")),
        row("index 5.obj", and("f 1 2 5")),
        row("index -5.obj", and("f 1 2 -5")),
        row("index of a billion.obj", and("f 1 2 1000000000")),
        row("index of minus a billion.obj", and("f 1 2 -1000000000")),
        row("index beyond u32.obj", and("f 1 2 4294967297")),
        row("smallest index.obj", and("f 1 2 -9223372036854775808")),
        row("index beyond i64.obj", and("f 1 2 9223372036854775808")),
        row("index of a hundred digits.obj", || format!("{TETRAHEDRON}f 1 2 {}\n", "9".repeat(100))),
        row("index with a fraction.obj", and("f 1 2 3.0")),
        row("index not a number.obj", and("f 1 2 nan")),
        row("corner without vertex.obj", and("f /1 2 3")),
        row("corner of four indices.obj", and("f 1/// 2 3")),
        row("corner in words.obj", and("f one two three")),
        row("texture coordinate missing.obj", and("f 1/1 2/1 3/1")),
        row("texture coordinate in words.obj", and("vt left")),
        row("texture coordinate without numbers.obj", and("vt")),
        row("texture coordinate not a number.obj", || "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt nan 0\nf 1/1 2/1 3/1\n"),
        row("normal missing.obj", and("f 1//1 2//1 3//1")),
        row("normal of two.obj", and("vn 0 1")),
        row("points as faces.obj", || "v 0 0 0\nf 1\nf 1\n"),
        row("lines as faces.obj", || "v 0 0 0\nv 1 0 0\nf 1 2\n"),
        row("faces of nothing.obj", || "f\n".repeat(1_000_000)),
        row("one point.obj", || "v 1 2 3\nf 1 1 1\n"),
        row("one line.obj", || "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n"),
        row("all in one place.obj", || "v 7 7 7\n".repeat(1000) + &"f 1 2 3 4 5\n".repeat(1000)),
        row("a million faces without vertices.obj", || "f 1 2 3\n".repeat(1_000_000)),
        row("a face of a hundred thousand corners.obj", || star(100_000)),
        row("a face of a hundred thousand corners that are not there.obj", || {
            format!("{TETRAHEDRON}f {}\n", "9 ".repeat(100_000))
        }),
        row("a line of ten megabytes in a vertex.obj", || format!("v 1 2 {}\n", "x".repeat(TEN_MB))),
        row("a line of ten megabytes in a corner.obj", || {
            format!("{TETRAHEDRON}f 1 2 {}\n", "1/".repeat(TEN_MB / 2))
        }),
        row("a line of ten megabytes of corners.obj", || {
            format!("{TETRAHEDRON}f {}\n", "1 0 ".repeat(TEN_MB / 4))
        }),
        row("a coordinate of ten megabytes.obj", || TETRAHEDRON.replacen('1', &"1".repeat(TEN_MB), 1)),
        row("continued without end.obj", || "f 1 2 \\\n".repeat(1_000_000)),
        row("continued into nothing.obj", || format!("v 1 2 {}", "\\\n".repeat(1_000_000))),
    ]
}
