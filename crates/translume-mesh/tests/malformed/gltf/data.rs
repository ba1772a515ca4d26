//! Accessors, what they hold, how often it is used, and rigs.

use serde_json::{Value, json};

use super::{at, buffer, changed, document, glb, with};
use crate::harness::{Row, row};
use crate::obj::noise;

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

pub fn rows() -> Vec<Row> {
    [accessors(), primitives(), bombs(), rigs()].into_iter().flatten().collect()
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
