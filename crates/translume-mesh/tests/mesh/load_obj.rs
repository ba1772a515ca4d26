use std::cell::RefCell;
use std::path::Path;

use translume_mesh::load::{LoadError, Loaded, load, load_bytes, load_with_progress};
use translume_mesh::{Mesh, Progress};

use crate::fixtures::{Folder, area};

fn read(text: impl AsRef<[u8]>) -> Result<Loaded, LoadError> {
    Folder::new().load("model.obj", text)
}

/// The error of a file, which must name it.
fn refuse(text: impl AsRef<[u8]>) -> String {
    let error = read(text).unwrap_err().to_string();
    assert!(error.contains("model.obj: "), "{error}");
    error
}

const TETRAHEDRON: &str = "v 1 1 1\nv 1 -1 -1\nv -1 1 -1\nv -1 -1 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n";

#[test]
fn a_plain_file_loads() {
    let loaded = read(TETRAHEDRON).unwrap();
    assert_eq!(loaded.mesh.name, "model.obj");
    assert_eq!(loaded.metres_per_unit, None);
    assert_eq!(loaded.mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]);
    assert!(loaded.repairs.is_pristine());
}

#[test]
fn the_extension_is_read_in_any_case() {
    let folder = Folder::new();
    assert_eq!(load(&folder.write("A.OBJ", TETRAHEDRON)).unwrap().mesh.triangles.len(), 4);
    for name in ["a.stl", "a"] {
        let error = load(&folder.write(name, TETRAHEDRON)).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains(".obj, .ply, .gltf, .glb"), "{error}");
    }
}

#[test]
fn relative_indices_objects_colours_comments_and_continuations_are_read() {
    let text = "# \u{e9}\no first\nv 1 1 1 0.5 0.5 0.5\nv 1 -1 -1\nv -1 1 -1 1\nvt 0 0\nvt 1 1\n\
                f -3/1 -2/2 \\\n -1/1 # front\ng second\nusemtl wax\nv -1 -1 1\n\
                f 1/1 3/1 4/2\nf 1 4 2\ns off\nl 1 2\nf 2//  4//  3//\n";
    assert_eq!(read(text).unwrap().mesh.triangles, read(TETRAHEDRON).unwrap().mesh.triangles);
    // Names in another encoding do not matter.
    read([b"o \xe9\n", TETRAHEDRON.as_bytes()].concat()).unwrap();
}

#[test]
fn polygons_become_fans() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0.5 2 0\nv 0 1 0\nf 1 2 3 4 5\n";
    let loaded = read(text).unwrap();
    assert_eq!(loaded.mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    assert_eq!(loaded.repairs.boundary_edges, 5);
}

#[test]
fn concave_polygons_lose_ears_until_none_is_left() {
    // An arrowhead whose fan around the first corner would cover the notch.
    let loaded = read("v 2 0 0\nv 0 2 0\nv 0 0 0\nv -2 -2 0\nf 1 2 3 4\n").unwrap();
    assert_eq!(loaded.mesh.triangles.len(), 2);
    assert!((area(&loaded.mesh) - 4.0).abs() < 1e-6, "{}", area(&loaded.mesh));
    let fan = read("v 2 0 0\nv 0 2 0\nv 0 0 0\nv -2 -2 0\nf 4 1 2\nf 4 2 3\n").unwrap();
    assert!(area(&fan.mesh) > 5.0, "the check notices the wrong fan");
}

#[test]
fn texture_coordinates_are_kept_where_every_face_has_them() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0 9\nvt 1 0.75\nvt 0.5 # v is 0\n";
    let mesh = read(format!("{square}f 1/1 2/2 3/3 4/4\n")).unwrap().mesh;
    // Upwards in the file, downwards here.
    let corners = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.25], [0.5, 1.0]];
    assert_eq!(mesh.uvs, [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|k: usize| corners[k])));
    assert_eq!(mesh.positions.len(), 4, "a seam splits no vertex");
    let relative = read(format!("{square}f 1/-4 2/-3 3/-2 4/-1\n")).unwrap().mesh;
    assert_eq!(relative.uvs, mesh.uvs);
    for faces in ["f 1/1 2/2 3/3\nf 1 3 4\n", "f 1/1 2/2 3/3 4\n", "f 1/1/ 2/2/ 3//\n"] {
        assert!(read(format!("{square}{faces}")).unwrap().mesh.uvs.is_empty(), "{faces}");
    }
    let error = refuse(format!("{square}f 1/1 2/2 3/5\n"));
    assert!(error.contains("face 1 uses texture coordinate 5, but there are 4"), "{error}");
    let error = refuse(format!("{square}vt nan 0\nf 1/1 2/2 3/5\n"));
    assert!(error.contains("triangle 0 (from 0) has the texture coordinate [NaN, 1.0]"), "{error}");
    let error = refuse("v 0 0 0\nvt x\n");
    assert!(error.contains("line 2: texture coordinate 1 has the coordinate \"x\""), "{error}");
}

#[test]
fn missing_normals_are_computed_and_the_others_kept() {
    let loaded = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 1 0 1\nf 1//1 2//1 3//1\nf 2 4 3\n").unwrap();
    assert!(loaded.repairs.computed_normals);
    let [with, without] =
        [0, 1].map(|t: usize| loaded.mesh.triangles[t].map(|v| loaded.mesh.normals[v as usize]));
    let half = 0.5_f32.sqrt();
    assert_eq!((with, without), ([[half, 0.0, half]; 3], [[0.0, 0.0, 1.0]; 3]));
}

#[test]
fn progress_is_told_in_order_and_can_cancel() {
    let folder = Folder::new();
    let path = folder.write("model.obj", TETRAHEDRON);
    let told = RefCell::new(Vec::new());
    let listen = |p: Progress| {
        told.borrow_mut().push(p);
        true
    };
    assert_eq!(load_with_progress(&path, listen).unwrap(), load(&path).unwrap());
    let told = told.into_inner();
    let mut stages: Vec<_> = told.iter().map(|p| p.stage).collect();
    stages.dedup();
    assert_eq!(stages, ["reading", "parsing", "repairing"]);
    assert!(told.iter().all(|p| p.total.is_none_or(|total| p.done <= total)), "{told:?}");
    for stage in stages {
        let error = load_with_progress(&path, |p| p.stage != stage).unwrap_err();
        assert_eq!(error, LoadError::Cancelled { file: path.display().to_string() });
    }
}

#[test]
fn bytes_in_memory_are_read_as_a_file_is() {
    let folder = Folder::new();
    let path = folder.write("model.obj", TETRAHEDRON);
    let of_bytes = |bytes: &str| load_bytes(&path, bytes.into(), |_| true).unwrap();
    assert_eq!(of_bytes(TETRAHEDRON), load(&path).unwrap());
    assert_ne!(of_bytes(&TETRAHEDRON.replacen('1', "2", 1)), load(&path).unwrap());
    let error = load_bytes(Path::new("model.fbx"), Vec::new(), |_| true).unwrap_err();
    assert_eq!(error, LoadError::UnknownExtension { file: "model.fbx".into() });
}

#[test]
fn vertices_split_where_normals_differ_and_nowhere_else() {
    // Two triangles with a hard edge between 2 and 3; normal 3 repeats normal 1; texture coordinates differ everywhere.
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 -1\nvn 0 0 1\nvn 1 0 1\nvn 0 0 1\nvt 0 0\nvt 1 0\n\
                f 1/1/1 2/1/1 3/2/3\nf 2/2/2 4/2/2 3/1/2\n";
    let loaded = read(text).unwrap();
    assert_eq!(loaded.mesh.positions.len(), 6);
    assert_eq!(loaded.mesh.triangles, [[0, 1, 2], [4, 3, 5]]);
    assert_eq!(loaded.mesh.normals[4], loaded.mesh.normals[3]);
    assert!(!loaded.repairs.computed_normals);
    assert_eq!(loaded.repairs.boundary_edges, 4, "the hard edge is no hole");
}

/// The `tobj` crate as a second opinion, on a grid of quads with normals.
#[test]
fn another_reader_finds_the_same_triangles() {
    let mut text = String::new();
    for k in 0..100 {
        let (x, y) = (k % 10, k / 10);
        text += &format!("v {x} {y} {}\nvn {} 1 0.5\n", (x * y) % 7, x as f32 / 10.0);
    }
    for k in (0..89).filter(|k| k % 10 != 9) {
        let corners = [k + 1, k + 2, k + 12, k + 11].map(|v| format!("{v}//{v}"));
        text += &format!("f {}\n", corners.join(" "));
    }
    let options = tobj::LoadOptions { single_index: true, triangulate: true, ..Default::default() };
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, |_| Ok(Default::default())).unwrap();
    let theirs = &models[0].mesh;
    let point = |v: u32| -> Vec<f32> { theirs.positions[3 * v as usize..][..3].to_vec() };
    let theirs: Vec<Vec<f32>> = theirs.indices.iter().map(|&v| point(v)).collect();
    let corners = |mesh: &Mesh| -> Vec<Vec<f32>> {
        mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize].to_vec()).collect()
    };
    let mut ours = read(&text).unwrap().mesh;
    assert_eq!(corners(&ours), theirs);
    ours.triangles[50].swap(0, 1);
    assert_ne!(corners(&ours), theirs);
}

#[test]
fn indices_out_of_range_name_face_vertex_and_count() {
    let error = refuse(format!("{TETRAHEDRON}f 1 2 99999\n"));
    assert!(
        error
            .ends_with("face 5 uses vertex 99999, but there are 4; re-export the file or repair its indices"),
        "{error}"
    );
    for (face, expected) in [
        ("f 0 1 2", "face 5 uses vertex 0, but there are 4"),
        ("f 1 2 -5", "face 5 uses vertex -5, but there are 4"),
        ("f 1 2 -9223372036854775808", "uses vertex -9223372036854775808"),
        ("f 1 2 9223372036854775807", "uses vertex 9223372036854775807"),
        ("f 1//1 2//1 3//1", "face 5 uses normal 1, but there are 0"),
        ("f 1//-6148914691236517205 2 3", "face 5 uses normal -6148914691236517205"),
    ] {
        let error = refuse(format!("{TETRAHEDRON}{face}\n"));
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn malformed_numbers_name_their_line() {
    let error = refuse("v 0 0 0\nv 1,5 0 0\n");
    assert!(error.contains("line 2: vertex 2 has the coordinate \"1,5\""), "{error}");
    let error = refuse("v 0 0 0\nv 1 0\n");
    assert!(error.contains("line 2: vertex 2 has fewer than three coordinates"), "{error}");
    let error = refuse("v 0 0 0\n\nf 1 x 2\n");
    assert!(error.contains("line 3: face 1 has the corner \"x\""), "{error}");
}

#[test]
fn a_nan_vertex_is_named_as_in_the_file_if_a_face_uses_it() {
    let error = refuse(TETRAHEDRON.replace("v -1 1 -1", "v nan 1 -1"));
    assert!(error.contains("vertex 3 is at [NaN, 1.0, -1.0]"), "{error}");
    let loaded = read(format!("{TETRAHEDRON}v inf 0 0\nv 1 2 3\n")).unwrap();
    assert_eq!(loaded.repairs.dropped_vertices, 2);
}

#[test]
fn files_that_are_no_mesh_say_so() {
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x01\0";
    let noise: Vec<u8> = (0..5000_u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    for bytes in [&png[..], &noise, b"", b"v 0 0 0\nv 1 0 0\n", "Dear reader,\n".as_bytes()] {
        let error = refuse(bytes);
        assert!(error.contains("is not a mesh"), "{error}");
    }
    assert!(refuse("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").contains("none of its 1 triangles has an area"));
}

#[test]
fn missing_files_and_folders_are_told() {
    let folder = Folder::new();
    let missing = folder.path().join("none.obj");
    let error = load(&missing).unwrap_err().to_string();
    assert!(error.starts_with(&missing.display().to_string()) && error.contains("cannot be read"), "{error}");
    let directory = folder.path().join("folder.glb");
    std::fs::create_dir(&directory).unwrap();
    assert!(load(&directory).unwrap_err().to_string().contains("not a regular file"));
}
