//! Files as such, their text, and the nodes of their scenes.

use serde_json::json;

use super::{buffer, chain, changed, document, glb, with};
use crate::harness::{Row, row};
use crate::obj::noise;

/// The document as text whose buffer is elsewhere.
fn beside(uri: &'static str) -> impl Fn() -> String {
    move || {
        let mut document = document();
        document["buffers"][0]["uri"] = uri.into();
        document.to_string()
    }
}

pub fn rows() -> Vec<Row> {
    [containers(), texts(), scenes()].into_iter().flatten().collect()
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
