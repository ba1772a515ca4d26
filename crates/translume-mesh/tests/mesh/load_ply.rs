use translume_mesh::load::{LoadError, Loaded, load_with_progress};

use crate::fixtures::{Folder, sphere};

fn read(bytes: impl AsRef<[u8]>) -> Result<Loaded, LoadError> {
    Folder::new().load("model.ply", bytes)
}

fn refuse(bytes: impl AsRef<[u8]>) -> String {
    let error = read(bytes).unwrap_err().to_string();
    assert!(error.contains("model.ply: "), "{error}");
    error
}

const TRIANGLES: [[u32; 3]; 4] = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];

const TETRAHEDRON: &str = "ply\nformat ascii 1.0\ncomment caf\u{e9}\nobj_info made by hand\n\
    element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n\
    element face 4\nproperty list uchar int vertex_indices\nend_header\n\
    1 1 1 255\n1 -1 -1 0\n-1 1 -1 0\n-1 -1 1 9\n3 0 1 2\n3 0 2 3\n3 0 3 1\n3 1 3 2\n";

/// The tetrahedron with normals, extra elements and properties, in either byte order.
fn binary(big: bool) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_{}_endian 1.0\nelement junk 2\nproperty list ushort short heap\nproperty int8 small\n\
         element face 4\nproperty uchar flags\nproperty list uint ushort vertex_index\n\
         element vertex 4\nproperty double nx\nproperty float32 ny\nproperty int8 nz\n\
         property double x\nproperty short y\nproperty float z\nend_header\n",
        if big { "big" } else { "little" }
    )
    .into_bytes();
    let mut put = |little: &[u8]| {
        if big { bytes.extend(little.iter().rev()) } else { bytes.extend(little) }
    };
    for _ in 0..2 {
        put(&2_u16.to_le_bytes());
        put(&(-7_i16).to_le_bytes());
        put(&300_i16.to_le_bytes());
        put(&[0xff]);
    }
    for triangle in TRIANGLES {
        put(&[1]);
        put(&3_u32.to_le_bytes());
        triangle.iter().for_each(|&v| put(&(v as u16).to_le_bytes()));
    }
    for [x, y, z] in [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1_i8]] {
        put(&f64::from(x).to_le_bytes());
        put(&f32::from(y).to_le_bytes());
        put(&[z as u8]);
        put(&f64::from(x).to_le_bytes());
        put(&i16::from(y).to_le_bytes());
        put(&f32::from(z).to_le_bytes());
    }
    bytes
}

#[test]
fn text_and_both_byte_orders_are_read() {
    let text = read(TETRAHEDRON).unwrap();
    assert_eq!((text.mesh.triangles.as_slice(), text.mesh.name.as_str()), (&TRIANGLES[..], "model.ply"));
    assert_eq!(text.metres_per_unit, None);
    assert!(text.repairs.is_pristine() && text.repairs.computed_normals);
    for big in [false, true] {
        let loaded = read(binary(big)).unwrap();
        assert_eq!(
            (&loaded.mesh.positions, &loaded.mesh.triangles),
            (&text.mesh.positions, &text.mesh.triangles)
        );
        assert!(!loaded.repairs.computed_normals);
        assert_eq!(loaded.mesh.normals[1], [1.0, -1.0, -1.0].map(|x: f32| x / 3_f32.sqrt()));
    }
    let swapped = String::from_utf8_lossy(&binary(true)).replace("big", "little").into_bytes();
    refuse(swapped);
}

#[test]
fn line_ends_of_windows_and_rows_over_several_lines_are_read() {
    assert_eq!(read(TETRAHEDRON.replace('\n', "\r\n")).unwrap(), read(TETRAHEDRON).unwrap());
    assert_eq!(read(TETRAHEDRON.replace("3 0 1 2", "3\n0 1\n2")).unwrap(), read(TETRAHEDRON).unwrap());
}

#[test]
fn polygons_are_cut_as_in_obj() {
    let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let arrowhead = read(format!("{header}2 0 0\n0 2 0\n0 0 0\n-2 -2 0\n4 0 1 2 3\n")).unwrap();
    let obj = Folder::new().load("model.obj", "v 2 0 0\nv 0 2 0\nv 0 0 0\nv -2 -2 0\nf 1 2 3 4\n").unwrap();
    assert_eq!(arrowhead.mesh.triangles, obj.mesh.triangles);
}

#[test]
fn errors_name_the_row_and_what_is_wrong() {
    for (from, to, expected) in [
        ("3 1 3 2\n", "3 1 3 4\n", "face 3 (from 0): it uses vertex 4, but there are 4; re-export the file"),
        ("3 1 3 2\n", "3 1 -3 2\n", "face 3 (from 0): it uses vertex -3, which cannot be"),
        ("3 1 3 2\n", "3 1 0.5 2\n", "face 3 (from 0): it uses vertex 0.5, which cannot be"),
        ("3 1 3 2\n", "3 1 3\n", "face 3 (from 0): the file ends before it"),
        ("3 1 3 2\n", "", "face 3 (from 0): the file ends before it"),
        ("3 0 1 2\n", "-3 0 1 2\n", "face 0 (from 0): it has a list of -3 entries"),
        ("3 0 1 2\n", "nan 0 1 2\n", "face 0 (from 0): it has a list of NaN entries"),
        ("1 -1 -1 0\n", "1 -1 x 0\n", "vertex 1 (from 0): it holds a word that is no number"),
        ("1 -1 -1 0\n", "1 -1 inf 0\n", "vertex 1 (from 0) is at [1.0, -1.0, inf]"),
        ("element vertex 4\n", "element vertex 4000000000\n", "vertex 8 (from 0): the file ends before it"),
        (
            "element face 4\n",
            "element face 18446744073709551615\n",
            "face 4 (from 0): the file ends before it",
        ),
        (
            "element face 4\n",
            "element face 18446744073709551616\n",
            "line 10: the element's count is no number",
        ),
        ("element face 4\n", "element vertex 4\n", "line 10: the element is declared twice"),
        ("element face 4\n", "element faces 4\n", "is not a mesh: it holds no face"),
        ("element vertex 4\n", "", "line 5: the property belongs to no element"),
        ("float z", "float w", "element `vertex`: it must have x, y and z, each once"),
        ("float z", "float y", "element `vertex`: it must have x, y and z, each once"),
        ("float z", "half z", "line 8: the property's type is unknown"),
        ("list uchar int", "int", "element `face`: it must have one list `vertex_indices`"),
        ("ascii", "utf16", "line 2: the format is none of ascii, binary_little_endian, binary_big_endian"),
        ("end_header\n", "end\n", "line 12: it is no statement of a PLY header"),
        ("ply\n", "plyx\n", "line 1: it is no statement of a PLY header"),
        ("ply\n", "", "is not a mesh: it does not begin with `ply`"),
    ] {
        assert!(TETRAHEDRON.contains(from), "{from}");
        let error = refuse(TETRAHEDRON.replacen(from, to, 1));
        assert!(error.contains(expected), "{expected}: {error}");
    }
}

#[test]
fn every_truncation_is_told() {
    let folder = Folder::new();
    for bytes in [TETRAHEDRON.as_bytes().to_vec(), binary(true)] {
        // The last byte of a text ends a number that has ended anyway.
        for length in 0..bytes.len() - 1 {
            let error = folder.load("model.ply", &bytes[..length]).unwrap_err().to_string();
            assert!(error.contains("model.ply: "), "{length}: {error}");
        }
    }
}

#[test]
fn rows_without_properties_cost_nothing() {
    let text = TETRAHEDRON.replace("element vertex", "element nothing 18446744073709551615\nelement vertex");
    assert_eq!(read(text).unwrap(), read(TETRAHEDRON).unwrap());
}

#[test]
fn progress_can_cancel_half_way() {
    let mesh = sphere(7);
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.triangles.len()
    );
    mesh.positions.iter().for_each(|p| text += &format!("{} {} {}\n", p[0], p[1], p[2]));
    mesh.triangles.iter().for_each(|t| text += &format!("3 {} {} {}\n", t[0], t[1], t[2]));
    let folder = Folder::new();
    let path = folder.write("model.ply", &text);
    let heard = std::cell::Cell::new(0);
    let error = load_with_progress(&path, |p| {
        heard.set(p.done);
        !(p.stage == "parsing" && p.done > text.len() / 2)
    });
    assert!(matches!(error, Err(LoadError::Cancelled { .. })));
    // A report each MiB.
    assert!((text.len() / 2..text.len() / 2 + (2 << 20)).contains(&heard.get()), "{}", heard.get());
}
