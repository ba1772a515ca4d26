//! glTF and GLB files: one sound document, and what can be wrong with it.

use serde_json::{Value, json};

use crate::harness::{Row, row};
use crate::obj::noise;

/// What the buffer of [`document`] holds, in the order of its views.
pub fn buffer() -> Vec<u8> {
    let floats = |numbers: &[f32]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let shorts = |numbers: &[u16]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let identity = |k: usize| if k.is_multiple_of(5) { 1.0 } else { 0.0 };
    let matrices: Vec<f32> = (0..32).map(|k| identity(k % 16)).collect();
    [
        floats(&[1.0, 1.0, 1.0, 1.0, -1.0, -1.0, -1.0, 1.0, -1.0, -1.0, -1.0, 1.0]), // 0: positions
        shorts(&[0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2]),                               // 1: indices
        [0, 1, 0, 0].repeat(4),                                                      // 2: joints
        floats(&[0.5, 0.5, 0.0, 0.0].repeat(4)),                                     // 3: weights
        floats(&[0.25; 12]),                                                         // 4: morph deltas
        shorts(&[1, 3]),                                                             // 5: sparse indices
        floats(&[0.5; 6]),                                                           // 6: sparse deltas
        floats(&matrices),                                 // 7: inverse bind matrices
        floats(&[0.0, 1.0]),                               // 8: seconds
        floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0]), // 9: rotations
    ]
    .concat()
}

/// A tetrahedron with two joints, two morph targets (one of them sparse) and an animation.
pub fn document() -> Value {
    let lengths = [48, 24, 16, 64, 48, 4, 24, 128, 8, 32];
    let views: Vec<Value> = lengths
        .iter()
        .scan(0, |offset, length| {
            let begin = *offset;
            *offset += length;
            Some(json!({"buffer": 0, "byteOffset": begin, "byteLength": length}))
        })
        .collect();
    let accessor = |view: usize, component: u32, count: usize, kind: &str| json!({"bufferView": view, "componentType": component, "count": count, "type": kind});
    let mut positions = accessor(0, 5126, 4, "VEC3");
    positions["min"] = json!([-1, -1, -1]);
    positions["max"] = json!([1, 1, 1]);
    let mut seconds = accessor(8, 5126, 2, "SCALAR");
    seconds["min"] = json!([0]);
    seconds["max"] = json!([1]);
    json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"children": [1, 2]}, {"mesh": 0, "skin": 0}, {"children": [3]}, {}],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0, "JOINTS_0": 2, "WEIGHTS_0": 3},
            "indices": 1,
            "targets": [{"POSITION": 4}, {"POSITION": 5}],
        }]}],
        "skins": [{"joints": [2, 3], "inverseBindMatrices": 6}],
        "animations": [{
            "channels": [{"sampler": 0, "target": {"node": 3, "path": "rotation"}}],
            "samplers": [{"input": 7, "output": 8}],
        }],
        "accessors": [
            positions,
            accessor(1, 5123, 12, "SCALAR"),
            accessor(2, 5121, 4, "VEC4"),
            accessor(3, 5126, 4, "VEC4"),
            accessor(4, 5126, 4, "VEC3"),
            {"componentType": 5126, "count": 4, "type": "VEC3", "sparse": {
                "count": 2,
                "indices": {"bufferView": 5, "componentType": 5123},
                "values": {"bufferView": 6},
            }},
            accessor(7, 5126, 2, "MAT4"),
            seconds,
            accessor(9, 5126, 2, "VEC4"),
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": buffer().len()}],
    })
}

/// A GLB of a document and its binary chunk.
pub fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let json = format!("{json}{}", " ".repeat(json.len().next_multiple_of(4) - json.len()));
    let word = |n: usize| (n as u32).to_le_bytes();
    let header = [*b"glTF", word(2), word(28 + json.len() + binary.len())].concat();
    let chunks =
        [&word(json.len()), b"JSON".as_slice(), json.as_bytes(), &word(binary.len()), b"BIN\0", binary];
    [header, chunks.concat()].concat()
}

/// The document with one value changed, by its place in the JSON, as GLB.
fn with(place: &'static str, value: Value) -> impl Fn() -> Vec<u8> {
    changed(move |document| *at(document, place) = value.clone())
}

/// The document after any change, as GLB.
fn changed(change: impl Fn(&mut Value)) -> impl Fn() -> Vec<u8> {
    move || {
        let mut document = document();
        change(&mut document);
        glb(&document.to_string(), &buffer())
    }
}

/// The value at a place; the last step may be new.
fn at<'a>(document: &'a mut Value, place: &str) -> &'a mut Value {
    let (parent, last) = place.rsplit_once('/').unwrap();
    let parent = document.pointer_mut(parent).unwrap();
    match last.parse::<usize>() {
        Ok(index) if parent.is_array() => &mut parent[index],
        _ => &mut parent[last],
    }
}

/// The document as text whose buffer is elsewhere.
fn beside(uri: &'static str) -> impl Fn() -> String {
    move || {
        let mut document = document();
        document["buffers"][0]["uri"] = uri.into();
        document.to_string()
    }
}

/// Vertices that are used again and again: one mesh on many nodes, many targets of one delta.
fn large(vertices: usize, nodes: usize, targets: usize) -> Vec<u8> {
    let roots: Vec<String> = (0..nodes).map(|node| node.to_string()).collect();
    let bytes = vertices * 12;
    // Text, not values: those would take more memory than the loader may.
    let document = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[{}]}}],"nodes":[{}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"targets":[{}]}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{vertices},"type":"VEC3",
            "min":[0,0,0],"max":[1,1,1]}}],
        "bufferViews":[{{"buffer":0,"byteLength":{bytes}}}],"buffers":[{{"byteLength":{bytes}}}]}}"#,
        roots.join(","),
        vec![r#"{"mesh":0}"#; nodes].join(","),
        vec![r#"{"POSITION":0}"#; targets].join(","),
    );
    let numbers =
        noise(b"", vertices * 3).into_iter().flat_map(|byte| (f32::from(byte) / 255.0).to_le_bytes());
    glb(&document, &numbers.collect::<Vec<u8>>())
}

/// A chain of nodes, each with the same transform, and the mesh at its end.
pub fn chain(length: usize, scale: f64) -> Vec<u8> {
    let mut document = document();
    let mut nodes: Vec<Value> =
        (1..length).map(|child| json!({"children": [child], "scale": [scale, scale, scale]})).collect();
    nodes.push(json!({"mesh": 0}));
    document["nodes"] = nodes.into();
    let whole = document.as_object_mut().unwrap();
    whole.remove("skins");
    whole.remove("animations");
    glb(&document.to_string(), &buffer())
}

pub fn rows() -> Vec<Row> {
    [containers(), texts(), scenes(), accessors(), primitives(), bombs(), rigs()]
        .into_iter()
        .flatten()
        .collect()
}

fn containers() -> Vec<Row> {
    let cut = |length: usize| move || glb(&document().to_string(), &buffer())[..length].to_vec();
    let word = |place: usize, value: u32| {
        move || {
            let mut bytes = glb(&document().to_string(), &buffer());
            bytes[place..place + 4].copy_from_slice(&value.to_le_bytes());
            bytes
        }
    };
    vec![
        row("empty.glb", || ""),
        row("magic.glb", || "glTF"),
        row("cut in the version.glb", cut(6)),
        row("cut in the length.glb", cut(10)),
        row("cut after the header.glb", cut(12)),
        row("cut in the length of a chunk.glb", cut(14)),
        row("cut in the document.glb", cut(1000)),
        row("cut in the buffer.glb", || {
            let bytes = glb(&document().to_string(), &buffer());
            bytes[..bytes.len() - 100].to_vec()
        }),
        row("noise.glb", || noise(b"", 100_000)),
        row("noise after the magic.glb", || noise(b"glTF\x02\0\0\0", 100_000)),
        row("noise after the header.glb", || noise(b"glTF\x02\0\0\0\xa0\x86\x01\0", 100_000)),
        row("length 0.glb", word(8, 0)),
        row("length of 4 GB.glb", word(8, u32::MAX)),
        row("document of 4 GB.glb", word(12, u32::MAX)),
        row("document of 0 bytes.glb", word(12, 0)),
        row("chunk of another kind.glb", word(16, 0x4c4d_5458)),
        row("version 1.glb", word(4, 1)),
        row("buffer of 0 bytes.glb", || glb(&document().to_string(), b"")),
        row("binary chunk missing.glb", || {
            let bytes = glb(&document().to_string(), b"");
            let length = bytes.len() - 8;
            [&bytes[..8], &(length as u32).to_le_bytes(), &bytes[12..length]].concat()
        }),
    ]
}

fn texts() -> Vec<Row> {
    let nested = |open: &'static str, close: &'static str, depth: usize| {
        move || {
            format!(
                r#"{{"asset":{{"version":"2.0"}},"nodes":[{}{}]}}"#,
                open.repeat(depth),
                close.repeat(depth)
            )
        }
    };
    vec![
        row("empty.gltf", || ""),
        row("null.gltf", || "null"),
        row("object.gltf", || "{}"),
        row("list.gltf", || "[]"),
        row("asset alone.gltf", || r#"{"asset":{"version":"2.0"}}"#),
        row("noise.gltf", || noise(b"{", 100_000)),
        row("page.gltf", || "<html></html>"),
        row("utf-16.gltf", || {
            document().to_string().encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>()
        }),
        row("cut.gltf", || document().to_string()[..1500].to_owned()),
        row("lists in lists.gltf", || "[".repeat(100_000)),
        row("objects in objects.gltf", || r#"{"a":"#.repeat(100_000)),
        row("nodes in nodes.gltf", nested("[", "]", 100_000)),
        row("extras in extras.gltf", nested(r#"{"extras":"#, "}", 100_000)),
        row("a name of ten megabytes.gltf", || format!(r#"{{"{}"#, "x".repeat(10_000_000))),
        row("a number of a million digits.gltf", || format!(r#"{{"scene":{}}}"#, "9".repeat(1_000_000))),
        row("buffer without a place.gltf", || document().to_string()),
        row("buffer not there.gltf", beside("missing.bin")),
        row("buffer that is the folder.gltf", beside(".")),
        row("buffer from the root.gltf", beside("/etc/hostname")),
        row("buffer from the network.gltf", beside("https://example.com/mesh.bin")),
        row("buffer with half an escape.gltf", beside("a%2")),
        row("buffer in an empty uri.gltf", beside("")),
        row("data without comma.gltf", beside("data:application/octet-stream;base64")),
        row("data not in base64.gltf", beside("data:application/octet-stream,tetrahedron")),
        row("data in broken base64.gltf", beside("data:application/octet-stream;base64,AAAA!AAA")),
        row("data in half a digit.gltf", beside("data:application/octet-stream;base64,A")),
        row("data too short.gltf", beside("data:application/octet-stream;base64,AAAA")),
        row("data of ten megabytes that breaks off.gltf", || {
            let mut document = document();
            document["buffers"][0]["uri"] =
                format!("data:application/octet-stream;base64,{}*", "A".repeat(10_000_000)).into();
            document.to_string()
        }),
    ]
}

fn scenes() -> Vec<Row> {
    vec![
        row("of version 3.glb", with("/asset/version", json!("3.0"))),
        row("for version 3.glb", with("/asset/minVersion", json!("3.0"))),
        row("extension required.glb", with("/extensionsRequired", json!(["KHR_draco_mesh_compression"]))),
        row("scene not there.glb", with("/scene", json!(1))),
        row("scene of a billion.glb", with("/scene", json!(1_000_000_000))),
        row("scene without nodes.glb", with("/scenes/0/nodes", json!([]))),
        row("node not there.glb", with("/scenes/0/nodes", json!([4]))),
        row("node of minus one.glb", with("/scenes/0/nodes", json!([-1]))),
        row("node twice in a scene.glb", with("/scenes/0/nodes", json!([0, 0]))),
        row("child not there.glb", with("/nodes/0/children", json!([1, 4]))),
        row("node its own child.glb", with("/nodes/0/children", json!([0]))),
        row("nodes in a circle.glb", with("/nodes/3/children", json!([2]))),
        row("nodes in a circle through the root.glb", with("/nodes/3/children", json!([0]))),
        row("node of two parents.glb", with("/nodes/0/children", json!([1, 2, 3]))),
        row(
            "a hundred thousand parents.glb",
            changed(|document| {
                document["scenes"][0]["nodes"] = (0..100_000).collect::<Vec<_>>().into();
                document["nodes"] = vec![json!({"children": [0]}); 100_000].into();
            }),
        ),
        row("a hundred thousand levels that grow.glb", || chain(100_000, 2.0)),
        row("mesh not there.glb", with("/nodes/1/mesh", json!(1))),
        row("mesh without primitives.glb", with("/meshes/0/primitives", json!([]))),
        row("no node with a mesh.glb", with("/nodes/1", json!({}))),
        row("matrix of three numbers.glb", with("/nodes/0/matrix", json!([1, 2, 3]))),
        row("translation in words.glb", with("/nodes/0/translation", json!("up"))),
        row(
            "scale beyond f32.glb",
            changed(|document| {
                document["nodes"][1] = json!({"mesh": 0, "scale": [1e39, 1, 1]});
            }),
        ),
        row(
            "scale of nothing.glb",
            changed(|document| document["nodes"][1] = json!({"mesh": 0, "scale": [0, 0, 0]})),
        ),
    ]
}

fn accessors() -> Vec<Row> {
    const MOST: u64 = u64::MAX;
    vec![
        row("a billion positions.glb", with("/accessors/0/count", json!(1_000_000_000))),
        row("a billion indices.glb", with("/accessors/1/count", json!(1_000_000_000))),
        row("a billion deltas.glb", with("/accessors/4/count", json!(1_000_000_000))),
        row("most positions.glb", with("/accessors/0/count", json!(MOST))),
        row("most indices.glb", with("/accessors/1/count", json!(MOST))),
        row("no positions.glb", with("/accessors/0/count", json!(0))),
        row("minus one positions.glb", with("/accessors/0/count", json!(-1))),
        row("half a position.glb", with("/accessors/0/count", json!(0.5))),
        row("too few positions.glb", with("/accessors/0/count", json!(3))),
        row("too few deltas.glb", with("/accessors/4/count", json!(3))),
        row("offset of a billion.glb", with("/accessors/0/byteOffset", json!(1_000_000_000))),
        row("offset near the largest.glb", with("/accessors/0/byteOffset", json!(MOST - 11))),
        row("offset of minus one.glb", with("/accessors/0/byteOffset", json!(-1))),
        row("offset past the indices.glb", with("/accessors/1/byteOffset", json!(2))),
        row("component type unknown.glb", with("/accessors/0/componentType", json!(5127))),
        row("component type in words.glb", with("/accessors/0/componentType", json!("float"))),
        row("positions in pairs.glb", with("/accessors/0/type", json!("VEC2"))),
        row("positions as matrices.glb", with("/accessors/0/type", json!("MAT4"))),
        row("positions as integers of 32 bits.glb", with("/accessors/0/componentType", json!(5125))),
        row("indices as floats.glb", with("/accessors/1/componentType", json!(5126))),
        row("indices as vectors.glb", with("/accessors/1/type", json!("VEC3"))),
        row("indices of 32 bits in 16.glb", with("/accessors/1/componentType", json!(5125))),
        row("view not there.glb", with("/accessors/0/bufferView", json!(10))),
        row(
            "positions without view.glb",
            changed(|document| {
                document["accessors"][0].as_object_mut().unwrap().remove("bufferView");
            }),
        ),
        row(
            "a billion positions without view.glb",
            changed(|document| {
                document["accessors"][0].as_object_mut().unwrap().remove("bufferView");
                document["accessors"][0]["count"] = json!(1_000_000_000);
            }),
        ),
        row("a billion sparse deltas.glb", with("/accessors/5/sparse/count", json!(1_000_000_000))),
        row("most sparse deltas.glb", with("/accessors/5/sparse/count", json!(MOST))),
        row("sparse element out of range.glb", with("/accessors/5/count", json!(3))),
        row("sparse indices past the end.glb", with("/accessors/5/sparse/indices/byteOffset", json!(MOST))),
        row("sparse values past the end.glb", with("/accessors/5/sparse/values/byteOffset", json!(4))),
        row("sparse view not there.glb", with("/accessors/5/sparse/values/bufferView", json!(99))),
        row("sparse indices as floats.glb", with("/accessors/5/sparse/indices/componentType", json!(5126))),
        row(
            "stride 0.glb",
            changed(|document| {
                document["bufferViews"][1]["byteStride"] = json!(0);
                document["accessors"][1]["count"] = json!(1_000_000_000);
            }),
        ),
        row("stride of minus four.glb", with("/bufferViews/0/byteStride", json!(-4))),
        row("stride of a billion.glb", with("/bufferViews/0/byteStride", json!(1_000_000_000))),
        row("stride near the largest.glb", with("/bufferViews/0/byteStride", json!(MOST - 3))),
        row("view past the buffer.glb", with("/bufferViews/0/byteLength", json!(1_000_000_000))),
        row("view from near the largest.glb", with("/bufferViews/0/byteOffset", json!(MOST - 47))),
        row("view as long as the largest.glb", with("/bufferViews/0/byteLength", json!(MOST))),
        row("view of nothing.glb", with("/bufferViews/0/byteLength", json!(0))),
        row("buffer not in the list.glb", with("/bufferViews/0/buffer", json!(1))),
        row("buffer of 1 GB.glb", with("/buffers/0/byteLength", json!(1 << 30))),
        row("buffer of the largest size.glb", with("/buffers/0/byteLength", json!(MOST))),
        row("buffer shorter than its views.glb", with("/buffers/0/byteLength", json!(40))),
    ]
}

fn primitives() -> Vec<Row> {
    let numbers = |place: usize, number: f32| {
        move || {
            let mut bytes = buffer();
            bytes[place..place + 4].copy_from_slice(&number.to_le_bytes());
            glb(&document().to_string(), &bytes)
        }
    };
    let shorts = |place: usize, number: u16| {
        move || {
            let mut bytes = buffer();
            bytes[place..place + 2].copy_from_slice(&number.to_le_bytes());
            glb(&document().to_string(), &bytes)
        }
    };
    let primitive = "/meshes/0/primitives/0";
    vec![
        row("position not a number.glb", numbers(0, f32::NAN)),
        row("position infinite.glb", numbers(4, f32::INFINITY)),
        row("position too far.glb", numbers(8, 3e38)),
        row("delta not a number.glb", numbers(152, f32::NAN)),
        row("index 4.glb", shorts(48, 4)),
        row("index 65535.glb", shorts(70, 65535)),
        row("sparse index 4.glb", shorts(202, 4)),
        row(
            "primitive without positions.glb",
            with("/meshes/0/primitives/0/attributes", json!({"NORMAL": 0})),
        ),
        row("primitive of points.glb", with("/meshes/0/primitives/0/mode", json!(0))),
        row("primitive of lines.glb", with("/meshes/0/primitives/0/mode", json!(1))),
        row("primitive of mode 7.glb", with("/meshes/0/primitives/0/mode", json!(7))),
        row("positions not there.glb", with("/meshes/0/primitives/0/attributes/POSITION", json!(9))),
        row(
            "positions of a billion.glb",
            with("/meshes/0/primitives/0/attributes/POSITION", json!(1_000_000_000)),
        ),
        row("normals not there.glb", with("/meshes/0/primitives/0/attributes/NORMAL", json!(99))),
        row("normals of another count.glb", with("/meshes/0/primitives/0/attributes/NORMAL", json!(1))),
        row("indices not there.glb", with("/meshes/0/primitives/0/indices", json!(9))),
        row("target not there.glb", with("/meshes/0/primitives/0/targets", json!([{"POSITION": 9}]))),
        row("target of another count.glb", with("/meshes/0/primitives/0/targets", json!([{"POSITION": 8}]))),
        row(
            "triangles without area.glb",
            changed(move |document| {
                *at(document, &format!("{primitive}/attributes")) = json!({"POSITION": 9});
                let list = document["accessors"].as_array_mut().unwrap();
                list.push(json!({"bufferView": 4, "componentType": 5126, "count": 4, "type": "VEC3",
                "min": [0, 0, 0], "max": [1, 1, 1]}));
            }),
        ),
    ]
}

/// Small files that unfold to more than any machine holds.
fn bombs() -> Vec<Row> {
    vec![
        row("a hundred thousand copies of a mesh.glb", || large(10_000, 100_000, 0)),
        row("a million copies of a mesh.glb", || large(300, 1_000_000, 0)),
        row("a hundred thousand targets.glb", || large(3_000, 1, 100_000)),
        row("a million targets that do nothing.glb", || {
            let mut document = document();
            let still = r#"{"attributes":{"POSITION":0}}"#;
            let primitives = [still.to_owned() + ","].concat().repeat(1000);
            document["meshes"][0]["primitives"] = json!("here");
            let targets = vec!["{}"; 1_000_000].join(",");
            let primitives =
                format!(r#"[{primitives}{{"attributes":{{"POSITION":0}},"targets":[{targets}]}}]"#);
            glb(&document.to_string().replace(r#""here""#, &primitives), &buffer())
        }),
        row("a hundred thousand primitives of the same vertices.glb", || {
            let mut document: Value = serde_json::from_slice(json_of(&large(10_000, 1, 0))).unwrap();
            let primitive = document["meshes"][0]["primitives"][0].clone();
            document["meshes"][0]["primitives"] = vec![primitive; 100_000].into();
            glb(&document.to_string(), &vec![0; 120_000])
        }),
    ]
}

/// The document inside a GLB.
fn json_of(glb: &[u8]) -> &[u8] {
    let length = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    &glb[20..20 + length]
}

fn rigs() -> Vec<Row> {
    vec![
        row("skin not there.glb", with("/nodes/1/skin", json!(1))),
        row("skin without joints.glb", with("/skins/0/joints", json!([]))),
        row("joint not there.glb", with("/skins/0/joints", json!([2, 9]))),
        row("joint of a billion.glb", with("/skins/0/joints", json!([2, 1_000_000_000]))),
        row("a hundred thousand joints.glb", with("/skins/0/joints", json!(vec![2; 100_000]))),
        row("a vertex on a joint too many.glb", with("/skins/0/joints", json!([2]))),
        row("too few bind matrices.glb", with("/accessors/6/count", json!(1))),
        row("a billion bind matrices.glb", with("/accessors/6/count", json!(1_000_000_000))),
        row("bind matrices as vectors.glb", with("/skins/0/inverseBindMatrices", json!(3))),
        row("bind matrices not there.glb", with("/skins/0/inverseBindMatrices", json!(77))),
        row(
            "joints without weights.glb",
            changed(|document| {
                document["meshes"][0]["primitives"][0]["attributes"]
                    .as_object_mut()
                    .unwrap()
                    .remove("WEIGHTS_0");
            }),
        ),
        row("joints as floats.glb", with("/meshes/0/primitives/0/attributes/JOINTS_0", json!(3))),
        row("a billion influences.glb", with("/accessors/2/count", json!(1_000_000_000))),
        row("channel without sampler.glb", with("/animations/0/channels/0/sampler", json!(5))),
        row("channel of a node not there.glb", with("/animations/0/channels/0/target/node", json!(50))),
        row("channel of colours.glb", with("/animations/0/channels/0/target/path", json!("colour"))),
        row("sampler without input.glb", with("/animations/0/samplers/0/input", json!(50))),
        row("interpolation unknown.glb", with("/animations/0/samplers/0/interpolation", json!("MAGIC"))),
        row(
            "spline without tangents.glb",
            with("/animations/0/samplers/0/interpolation", json!("CUBICSPLINE")),
        ),
        row("a billion keys.glb", with("/accessors/7/count", json!(1_000_000_000))),
        row("more values than keys.glb", with("/accessors/7/count", json!(1))),
        row("rotations of three.glb", with("/accessors/8/type", json!("VEC3"))),
        row("seconds not a number.glb", || {
            let mut bytes = buffer();
            bytes[356..360].copy_from_slice(&f32::NAN.to_le_bytes());
            glb(&document().to_string(), &bytes)
        }),
    ]
}
