//! glTF and GLB files: one sound document, and what can be wrong with it.

mod data;
mod files;

use serde_json::{Value, json};

use crate::harness::Row;

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
    [files::rows(), data::rows()].into_iter().flatten().collect()
}
