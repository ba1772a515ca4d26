use translume_mesh::load::{LoadError, Loaded};

use crate::fixtures::Folder;

/// One right triangle: positions, then indices, then one morph target.
fn triangle_bytes() -> Vec<u8> {
    let floats = |points: &[f32]| points.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let mut bytes = floats(&[0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    bytes.extend([0, 0, 1, 0, 2, 0, 0, 0]);
    bytes.extend(floats(&[0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.25]));
    bytes
}

/// A document over [`triangle_bytes`] with the given nodes and primitive.
struct Document {
    nodes: String,
    roots: String,
    primitive: String,
    accessors: Vec<String>,
    views: Vec<String>,
    extra: String,
}

impl Document {
    fn new() -> Self {
        Self {
            nodes: r#"{"mesh":0}"#.into(),
            roots: "0".into(),
            primitive: r#"{"attributes":{"POSITION":0},"indices":1,"targets":[{"POSITION":2}]}"#.into(),
            accessors: vec![
                r#"{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[2,1,0]}"#.into(),
                r#"{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}"#.into(),
                r#"{"bufferView":2,"componentType":5126,"count":3,"type":"VEC3"}"#.into(),
            ],
            views: vec![
                r#"{"buffer":0,"byteOffset":0,"byteLength":36}"#.into(),
                r#"{"buffer":0,"byteOffset":36,"byteLength":6}"#.into(),
                r#"{"buffer":0,"byteOffset":44,"byteLength":36}"#.into(),
            ],
            extra: String::new(),
        }
    }

    fn json(&self, buffer: &str) -> String {
        format!(
            r#"{{"asset":{{"version":"2.0"}},{}"scenes":[{{"nodes":[{}]}}],"nodes":[{}],
            "meshes":[{{"primitives":[{}]}}],"accessors":[{}],"bufferViews":[{}],"buffers":[{{{buffer}}}]}}"#,
            self.extra,
            self.roots,
            self.nodes,
            self.primitive,
            self.accessors.join(","),
            self.views.join(","),
        )
    }

    fn glb(&self) -> Vec<u8> {
        let bin = triangle_bytes();
        let mut json = self.json(&format!(r#""byteLength":{}"#, bin.len())).into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut bytes = b"glTF\x02\0\0\0".to_vec();
        let word = |n: usize| (n as u32).to_le_bytes();
        bytes.extend(word(28 + json.len() + bin.len()));
        bytes.extend(word(json.len()));
        bytes.extend(b"JSON");
        bytes.extend(json);
        bytes.extend(word(bin.len()));
        bytes.extend(b"BIN\0");
        bytes.extend(bin);
        bytes
    }

    fn load(&self) -> Result<Loaded, LoadError> {
        Folder::new().load("model.glb", self.glb())
    }

    fn refuse(&self) -> String {
        let error = self.load().unwrap_err().to_string();
        assert!(error.contains("model.glb: "), "{error}");
        error
    }
}

const SQUARE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

#[test]
fn a_glb_loads_with_its_morph_target() {
    let loaded = Document::new().load().unwrap();
    assert_eq!(loaded.mesh.name, "model.glb");
    assert_eq!(loaded.metres_per_unit, Some(1.0));
    assert_eq!(loaded.mesh.positions, SQUARE);
    assert_eq!(loaded.mesh.triangles, [[0, 1, 2]]);
    assert_eq!(loaded.mesh.normals, [[0.0, 0.0, 1.0]; 3]);
    let deltas = [[0.0; 3], [0.5, 0.0, 0.0], [0.0, 0.0, 0.25]];
    assert_eq!(loaded.mesh.targets[0].position_deltas, deltas);
}

#[test]
fn buffers_come_from_files_and_data_uris() {
    let folder = Folder::new();
    let document = Document::new();
    folder.write("a b.bin", triangle_bytes());
    let beside = document.json(r#""byteLength":80,"uri":"a%20b.bin""#);
    assert_eq!(folder.load("model.gltf", beside).unwrap().mesh.positions, SQUARE);

    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut base64 = String::new();
    for group in triangle_bytes().chunks(3) {
        let bits = group.iter().enumerate().fold(0, |bits, (k, &b)| bits | u32::from(b) << (16 - 8 * k));
        base64.extend((0..=group.len()).map(|k| char::from(DIGITS[(bits >> (18 - 6 * k) & 63) as usize])));
    }
    let inline = |text: &str| {
        document.json(&format!(r#""byteLength":80,"uri":"data:application/octet-stream;base64,{text}""#))
    };
    assert_eq!(folder.load("model.gltf", inline(&base64)).unwrap().mesh.positions, SQUARE);
    for text in [&base64[..40], "!!!!"] {
        assert!(folder.load("model.gltf", inline(text)).unwrap_err().to_string().contains("buffers[0]"));
    }
    let absent = folder.load("model.gltf", document.json(r#""byteLength":80,"uri":"none.bin""#));
    assert!(absent.unwrap_err().to_string().contains("none.bin: cannot be read"));
}

#[test]
fn nodes_place_turn_and_mirror() {
    let mut document = Document::new();
    // A parent that shifts, a child that turns x to y, one that mirrors x, one that stretches.
    document.nodes = r#"{"translation":[10,0,0],"children":[1,2,3]},
        {"mesh":0,"rotation":[0,0,0.70710678,0.70710678]},{"mesh":0,"scale":[-1,1,1]},{"mesh":0,"scale":[1,1,3]}"#
        .into();
    document.primitive =
        r#"{"attributes":{"POSITION":0,"NORMAL":3},"indices":1,"targets":[{"POSITION":2}]}"#.into();
    // Normals of (2, 0, 0)-like data: reuse the positions; the first is zero and gets computed.
    document.accessors.push(r#"{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}"#.into());
    let mesh = document.load().unwrap().mesh;
    let near = |a: [f32; 3], b: [f32; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-5);
    assert!(near(mesh.positions[1], [10.0, 2.0, 0.0]) && near(mesh.positions[2], [9.0, 0.0, 0.0]));
    assert!(near(mesh.positions[4], [8.0, 0.0, 0.0]));
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 5, 4], [6, 7, 8]], "mirroring turns the winding");
    assert!(near(mesh.normals[1], [0.0, 1.0, 0.0]) && near(mesh.normals[4], [-1.0, 0.0, 0.0]));
    let deltas = &mesh.targets[0].position_deltas;
    assert!(near(deltas[1], [0.0, 0.5, 0.0]) && near(deltas[4], [-0.5, 0.0, 0.0]));
    assert!(near(deltas[8], [0.0, 0.0, 0.75]), "deltas turn and stretch, and do not shift");
}

#[test]
fn targets_of_one_primitive_leave_the_others_alone() {
    let mut document = Document::new();
    let still = r#"{"attributes":{"POSITION":0},"indices":1}"#;
    document.primitive = format!("{still},{},{still}", document.primitive);
    let loaded = document.load().unwrap();
    // The second and third copy repeat the first triangle and are dropped with their vertices.
    assert_eq!((loaded.repairs.dropped_duplicate, loaded.mesh.triangles.len()), (2, 1));
    assert_eq!(loaded.mesh.targets[0].position_deltas, [[0.0; 3]; 3]);
}

#[test]
fn strips_and_fans_wind_as_specified() {
    let mut document = Document::new();
    for (mode, expected) in [(5, [[0, 1, 2]]), (6, [[1, 2, 0]])] {
        document.primitive = format!(r#"{{"attributes":{{"POSITION":0}},"indices":1,"mode":{mode}}}"#);
        assert_eq!(document.load().unwrap().mesh.triangles, expected);
    }
    document.primitive = r#"{"attributes":{"POSITION":0},"mode":0}"#.into();
    assert!(document.refuse().contains("is not a mesh: its scene holds no triangle"));
}

#[test]
fn sparse_and_quantised_accessors_are_read() {
    let mut document = Document::new();
    // Element 1 of the target (index bytes "1, 0" at offset 38) becomes (2, 0, 0), the second position.
    document.accessors[2] = r#"{"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,
        "indices":{"bufferView":1,"byteOffset":2,"componentType":5123},"values":{"bufferView":0,"byteOffset":12}}}"#
        .into();
    let deltas = document.load().unwrap().mesh.targets[0].position_deltas.clone();
    assert_eq!(deltas, [[0.0; 3], [2.0, 0.0, 0.0], [0.0; 3]]);

    let mut document = Document::new();
    document.extra = r#""extensionsRequired":["KHR_mesh_quantization"],"#.into();
    document.primitive = r#"{"attributes":{"POSITION":0}}"#.into();
    document.views[0] = r#"{"buffer":0,"byteOffset":36,"byteLength":18,"byteStride":4}"#.into();
    document.accessors[0] =
        r#"{"bufferView":0,"componentType":5121,"normalized":true,"count":3,"type":"VEC3",
        "min":[0,0,0],"max":[1,1,1]}"#
            .into();
    // The bytes 0 0 1 0 | 2 0 0 0 | 0 0 0 0 in steps of four.
    let positions = document.load().unwrap().mesh.positions;
    assert_eq!(positions, [[0.0, 0.0, 1.0 / 255.0], [2.0 / 255.0, 0.0, 0.0], [0.0; 3]]);
}

#[test]
fn ranges_are_checked_before_memory_is_reserved() {
    let refused = |change: &dyn Fn(&mut Document), what: &str| {
        let mut document = Document::new();
        change(&mut document);
        let error = document.refuse();
        assert!(error.contains(what), "{error}");
    };
    let many = |text: &str| text.replace(r#""count":3"#, r#""count":4000000000"#);
    refused(&|d| d.accessors[0] = many(&d.accessors[0]), "meshes[0].primitives[0]");
    refused(&|d| d.accessors[1] = many(&d.accessors[1]), "accessors[1]: 4000000000 elements of 2 bytes");
    refused(&|d| d.accessors[2] = many(&d.accessors[2]), "4000000000 elements, but there are 3 vertices");
    let huge = |text: &str| text.replace(r#""count":3"#, r#""count":18446744073709551615"#);
    refused(&|d| d.accessors[1] = huge(&d.accessors[1]), "accessors[1]");
    refused(
        &|d| d.accessors[0] = d.accessors[0].replace(":3,", ":4,"),
        "accessors[0]: 4 elements of 12 bytes",
    );
    refused(
        &|d| d.views[0] = r#"{"buffer":0,"byteOffset":18446744073709551615,"byteLength":36}"#.into(),
        "bufferViews[0]",
    );
    refused(&|d| d.views[1] = d.views[1].replace("36", "76"), "bufferViews[1] is 6 bytes from byte 76");
    refused(
        &|d| {
            d.accessors[0] =
                d.accessors[0].replace(r#""bufferView":0,"#, r#""byteOffset":4,"bufferView":0,"#);
        },
        "from byte 4 do not fit",
    );
    refused(
        &|d| {
            d.accessors[0] =
                r#"{"componentType":5126,"count":4000000000,"type":"VEC3","min":[0,0,0],"max":[2,1,0],
            "sparse":{"count":1,"indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":0}}}"#
                    .into();
        },
        "positions have no buffer view",
    );
    let sparse = |count: u64, offset: u64| {
        format!(
            r#"{{"componentType":5126,"count":3,"type":"VEC3","sparse":{{"count":{count},
            "indices":{{"bufferView":0,"byteOffset":{offset},"componentType":5123}},"values":{{"bufferView":0}}}}}}"#
        )
    };
    refused(&|d| d.accessors[2] = sparse(4_000_000_000, 0), "targets[0]: accessors[2]");
    // Bytes 14 and 15 are the upper half of 2.0, 0x4000.
    refused(&|d| d.accessors[2] = sparse(1, 14), "replaces element 16384, but there are 3");
}

#[test]
fn contradictions_are_named() {
    let refused = |change: &dyn Fn(&mut Document), what: &str| {
        let mut document = Document::new();
        change(&mut document);
        let error = document.refuse();
        assert!(error.contains(what), "{error}");
    };
    let offset_two = |text: &str| text.replace(r#""bufferView":1"#, r#""bufferView":2,"byteOffset":12"#);
    refused(&|d| d.accessors[1] = offset_two(&d.accessors[1]), "uses vertex 16128, but there are 3");
    refused(&|d| d.primitive = d.primitive.replace(":0}", ":9}"), "uses accessor 9, but there are 3");
    refused(&|d| d.primitive = d.primitive.replace(":1,", ":2,"), "indices must be plain unsigned integers");
    refused(&|d| d.accessors[0] = d.accessors[0].replace("VEC3", "VEC2"), "not vectors of three numbers");
    refused(
        &|d| d.extra = r#""extensionsRequired":["KHR_draco_mesh_compression"],"#.into(),
        "KHR_draco_mesh_compression",
    );
    refused(&|d| d.nodes = r#"{"mesh":0,"children":[0]}"#.into(), "nodes[0]: it has two parents");
    refused(&|d| d.roots = "0,0".into(), "nodes[0]: it has two parents");
    refused(&|d| d.roots = "7".into(), "scenes[0].nodes[0]");
    refused(
        &|d| d.nodes = r#"{"mesh":0,"scale":[1e38,1,1]},{"children":[0],"scale":[1e38,1,1]}"#.into(),
        "diagonal",
    );
    refused(
        &|d| {
            d.nodes = r#"{"mesh":0,"scale":[1e38,1,1]},{"children":[0],"scale":[1e38,1,1]}"#.into();
            d.roots = "1".into();
        },
        "nodes[0]: its transform is not finite",
    );
}

#[test]
fn a_file_cannot_unfold_without_bound() {
    let mut document = Document::new();
    // A million targets of three vertices, on a thousand primitives: 3·10⁹ vectors from a file of some megabytes.
    let targets = vec!["{}"; 1_000_000].join(",");
    document.primitive = format!(r#"{{"attributes":{{"POSITION":0}},"targets":[{targets}]}}"#);
    let primitive = document.primitive.clone();
    document.primitive = vec![r#"{"attributes":{"POSITION":0}}"#; 1000].join(",") + "," + &primitive;
    assert!(document.refuse().contains("unfolds to more than"));
}

#[test]
fn every_truncation_and_every_flipped_byte_is_survived() {
    let folder = Folder::new();
    let glb = Document::new().glb();
    for length in 0..glb.len() {
        let error = folder.load("model.glb", &glb[..length]).unwrap_err().to_string();
        assert!(error.contains("model.glb: is not a mesh"), "{length}: {error}");
    }
    for place in 0..glb.len() {
        let mut bytes = glb.clone();
        bytes[place] ^= [0x01, 0x80, 0xff][place % 3];
        if let Err(error) = folder.load("model.glb", bytes) {
            assert!(error.to_string().contains("model.glb: "), "{place}: {error}");
        }
    }
}
