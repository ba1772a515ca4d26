//! PLY files.

use crate::harness::{Row, row};
use crate::obj::noise;

pub const TETRAHEDRON: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
    property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n\
    1 1 1\n1 -1 -1\n-1 1 -1\n-1 -1 1\n3 0 1 2\n3 0 2 3\n3 0 3 1\n3 1 3 2\n";

/// Bytes of the tetrahedron in binary after its header: four vertices, four faces.
const BODY: usize = 4 * 12 + 4 * 13;

/// The tetrahedron in binary.
pub fn binary(encoding: &str) -> Vec<u8> {
    let (header, body) = TETRAHEDRON.split_once("end_header\n").unwrap();
    let mut bytes = header.replace("ascii", encoding).into_bytes();
    bytes.extend(b"end_header\n");
    let big = encoding == "binary_big_endian";
    for (row, line) in body.lines().enumerate() {
        let numbers: Vec<f32> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        let (length, numbers) = if row < 4 { (None, &numbers[..]) } else { (Some(3), &numbers[1..]) };
        bytes.extend(length);
        for &number in numbers {
            let little = if row < 4 { number.to_le_bytes() } else { (number as i32).to_le_bytes() };
            bytes.extend(std::array::from_fn::<u8, 4, _>(|k| little[if big { 3 - k } else { k }]));
        }
    }
    bytes
}

/// The tetrahedron with something else in the place of the first occurrence of something.
fn with(from: &'static str, to: &'static str) -> impl Fn() -> String {
    assert!(TETRAHEDRON.contains(from), "{from}");
    move || TETRAHEDRON.replacen(from, to, 1)
}

/// The same in binary, where the header alone is text.
fn binary_with(from: &'static str, to: &'static str) -> impl Fn() -> Vec<u8> {
    move || {
        let bytes = binary("binary_little_endian");
        let end = TETRAHEDRON.find("end_header").unwrap() + "binary_little_endian".len() - "ascii".len();
        let header = std::str::from_utf8(&bytes[..end]).unwrap();
        assert!(header.contains(from), "{from}");
        [header.replacen(from, to, 1).as_bytes(), &bytes[end..]].concat()
    }
}

fn cut(encoding: &'static str, missing: usize) -> impl Fn() -> Vec<u8> {
    move || {
        let mut bytes = binary(encoding);
        bytes.truncate(bytes.len() - missing);
        bytes
    }
}

pub fn rows() -> Vec<Row> {
    vec![
        row("empty.ply", || ""),
        row("magic.ply", || "ply\n"),
        row("noise.ply", || noise(b"", 100_000)),
        row("noise after the magic.ply", || noise(b"ply\n", 100_000)),
        row("noise after the header.ply", || {
            noise(TETRAHEDRON.split_once("1 1 1").unwrap().0.as_bytes(), 100_000)
        }),
        row("utf-16.ply", || TETRAHEDRON.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>()),
        row("obj.ply", || crate::obj::TETRAHEDRON),
        row("header without end.ply", with("end_header\n", "")),
        row("header of ten megabytes.ply", || format!("ply\ncomment {}", "x".repeat(10_000_000))),
        row("header of a million lines.ply", || format!("ply\n{}", "comment\n".repeat(1_000_000))),
        row("statement of ten megabytes.ply", || format!("ply\n{}\n", "x ".repeat(5_000_000))),
        row("format unknown.ply", with("ascii", "ebcdic")),
        row("element without count.ply", with("element vertex 4", "element vertex")),
        row("element of minus one.ply", with("vertex 4", "vertex -1")),
        row("element of half.ply", with("vertex 4", "vertex 0.5")),
        row("element beyond u64.ply", with("vertex 4", "vertex 18446744073709551616")),
        row("a billion vertices.ply", with("vertex 4", "vertex 1000000000")),
        row("a billion faces.ply", with("face 4", "face 1000000000")),
        row("most vertices.ply", with("vertex 4", "vertex 18446744073709551615")),
        row("most faces.ply", with("face 4", "face 18446744073709551615")),
        row("a billion vertices in binary.ply", binary_with("vertex 4", "vertex 1000000000")),
        row("a billion faces in binary.ply", binary_with("face 4", "face 1000000000")),
        row(
            "a billion rows of nothing, and no face.ply",
            || "ply\nformat binary_little_endian 1.0\nelement nothing 1000000000\nend_header\n",
        ),
        row("a billion empty lists.ply", || {
            let header = "ply\nformat binary_little_endian 1.0\nelement face 1000000000\n\
                          property list uchar int vertex_indices\nend_header\n";
            [header.as_bytes(), &[0; 1_000_000]].concat()
        }),
        row("one vertex too few.ply", with("1 1 1\n", "")),
        row("one vertex too many.ply", with("1 1 1\n", "1 1 1\n1 1 1\n")),
        row("no vertices.ply", with("vertex 4", "vertex 0")),
        row("no faces.ply", with("face 4", "face 0")),
        row("vertex without z.ply", with("property float z\n", "")),
        row("vertex of lists.ply", with("property float z", "property list uchar float z")),
        row("vertex declared twice.ply", with("element face 4", "element vertex 4")),
        row("face without corners.ply", with("vertex_indices", "vertices")),
        row(
            "face with corners twice.ply",
            with("end_header", "property list uchar int vertex_index\nend_header"),
        ),
        row("face with one corner.ply", with("list uchar int", "int")),
        row("property without element.ply", with("element vertex 4\n", "")),
        row("property of an unknown type.ply", with("float z", "quaternion z")),
        row("list of a billion.ply", with("3 0 1 2", "1000000000 0 1 2")),
        row("list of a billion in binary.ply", || {
            let mut bytes = binary_with("uchar int", "uint int")();
            let place = bytes.len() - 4 * 13;
            bytes.splice(place..place + 1, 1_000_000_000_u32.to_le_bytes());
            bytes
        }),
        row("list of minus three.ply", with("3 0 1 2", "-3 0 1 2")),
        row("list of half.ply", with("3 0 1 2", "0.5 0 1 2")),
        row("list of infinitely many.ply", with("3 0 1 2", "inf 0 1 2")),
        row("index 4.ply", with("3 0 1 2", "3 0 1 4")),
        row("index -1.ply", with("3 0 1 2", "3 0 1 -1")),
        row("index of a billion.ply", with("3 0 1 2", "3 0 1 1000000000")),
        row("index beyond u32.ply", with("3 0 1 2", "3 0 1 4294967296")),
        row("index of half.ply", with("3 0 1 2", "3 0 1 0.5")),
        row("index not a number.ply", with("3 0 1 2", "3 0 1 nan")),
        row("coordinate in words.ply", with("1 1 1\n", "1 one 1\n")),
        row("coordinate not a number.ply", with("1 1 1\n", "1 nan 1\n")),
        row("coordinate beyond f32.ply", with("1 1 1\n", "1 1e300 1\n")),
        row("a word of ten megabytes.ply", || {
            TETRAHEDRON.replacen("1 1 1", &"1".repeat(10_000_000), 1) + "x"
        }),
        row("points as faces.ply", with("3 0 1 2\n3 0 2 3\n3 0 3 1\n3 1 3 2\n", "1 0\n1 1\n1 2\n1 3\n")),
        row("cut in the last number.ply", cut("binary_little_endian", 1)),
        row("cut before the last face.ply", cut("binary_big_endian", 13)),
        row("cut in the vertices.ply", cut("binary_little_endian", 4 * 13 + 20)),
        row("cut after the header.ply", cut("binary_big_endian", BODY)),
        row("wrong byte order.ply", || {
            let [little, big] = ["binary_little_endian", "binary_big_endian"].map(binary);
            [&little[..little.len() - BODY], &big[big.len() - BODY..]].concat()
        }),
        row("text said to be binary.ply", with("ascii", "binary_little_endian")),
    ]
}
