//! From bytes to a document whose indices are all in range.

use gltf::json::animation::Channel;
use gltf::json::validation::Checked;
use gltf::json::{Root, Value, deserialize};
use gltf::mesh::Semantic;

use super::Fault;

/// Most objects in a document. One takes up to 1000 bytes of memory, from as little as 8 bytes of text.
const MAX_OBJECTS: usize = 1 << 19;

/// Most further members of objects and lists. One takes up to 200 bytes, from as little as 10.
const MAX_MEMBERS: usize = 1 << 21;

/// Required extensions that change nothing of what is read here, or that are read.
const HARMLESS: [&str; 6] = [
    "KHR_mesh_quantization",
    "KHR_animation_pointer",
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "KHR_lights_",
];

/// Parses and validates. The `gltf` crate panics on some malformed inputs, which are caught here first.
pub(super) fn parse(bytes: &[u8]) -> Result<(gltf::Document, Option<Vec<u8>>), Fault> {
    let glb = bytes.starts_with(b"glTF").then(|| glb(bytes)).transpose()?;
    let json = glb.as_ref().map_or(bytes, |glb| &glb.json);
    check_size(json)?;
    let mut root = root(json)?;
    check_version(&root)?;
    check_positions(&root)?;
    check_channels(&root)?;
    // The crate's own list of extensions does not know them.
    root.extensions_required.retain(|name| !HARMLESS.iter().any(|harmless| name.starts_with(harmless)));
    let document = gltf::Document::from_json(root).map_err(|e| match e {
        // One is enough to act on, and a malicious file may have millions.
        gltf::Error::Validation(errors) => {
            errors.first().map_or_else(String::new, |(path, error)| format!("{path}: {error}"))
        }
        other => other.to_string(),
    })?;
    let blob = glb.and_then(|glb| glb.bin).map(std::borrow::Cow::into_owned);
    Ok((document, blob))
}

fn glb(bytes: &[u8]) -> Result<gltf::Glb<'_>, String> {
    let stated = bytes.get(8..12).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    if stated.is_none_or(|stated| (stated as usize) < 12 || stated as usize > bytes.len()) {
        return Err(format!("it is a truncated GLB: {} bytes of {}", bytes.len(), stated.unwrap_or(12)));
    }
    gltf::Glb::from_slice(bytes).map_err(|e| e.to_string())
}

/// Bounds the memory that parsing takes.
fn check_size(json: &[u8]) -> Result<(), String> {
    let (mut objects, mut members) = (0, 0);
    let (mut quoted, mut escaped) = (false, false);
    for &byte in json {
        match byte {
            _ if escaped => escaped = false,
            b'\\' => escaped = quoted,
            b'"' => quoted = !quoted,
            b'{' if !quoted => objects += 1,
            b',' if !quoted => members += 1,
            _ => {}
        }
    }
    if objects > MAX_OBJECTS || members > MAX_MEMBERS {
        return Err(format!(
            "its JSON unfolds to more than {MAX_OBJECTS} objects or {MAX_MEMBERS} members: {objects} and {members}"
        ));
    }
    Ok(())
}

fn root(json: &[u8]) -> Result<Root, String> {
    deserialize::from_slice(json).or_else(|error| {
        without_pointers(json).and_then(|json| deserialize::from_value(json).ok()).ok_or(error.to_string())
    })
}

/// The document without channels that have no target node, as only extensions (`KHR_animation_pointer`) give them a
/// meaning; the `gltf` crate refuses them. `None` where there is none.
fn without_pointers(json: &[u8]) -> Option<Value> {
    let mut json: Value = deserialize::from_slice(json).ok()?;
    let mut found = false;
    for animation in json.get_mut("animations")?.as_array_mut()? {
        if let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) {
            let before = channels.len();
            channels.retain(|channel| channel.pointer("/target/node").is_some());
            found |= channels.len() < before;
        }
    }
    found.then_some(json)
}

/// Specification, section 3.2: a later minor version may be read as 2.0 unless it says which it needs.
fn check_version(root: &Root) -> Result<(), Fault> {
    let needed = root.asset.min_version.as_deref();
    let readable =
        needed.map_or(root.asset.version.split('.').next() == Some("2"), |version| version == "2.0");
    if readable {
        return Ok(());
    }
    let needed = needed.unwrap_or(&root.asset.version);
    Err(Fault::at("asset", format!("it needs glTF {needed}, and 2.0 is what is read")))
}

fn check_positions(root: &Root) -> Result<(), Fault> {
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let position = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
            if let Some(index) = position.filter(|index| index.value() >= root.accessors.len()) {
                let there = root.accessors.len();
                return Err(Fault::at(
                    format!("meshes[{m}].primitives[{p}]"),
                    format!("it uses accessor {}, but there are {there}", index.value()),
                ));
            }
        }
    }
    Ok(())
}

fn check_channels(root: &Root) -> Result<(), Fault> {
    for (a, animation) in root.animations.iter().enumerate() {
        for (c, channel) in animation.channels.iter().enumerate() {
            check_channel(root, channel)
                .map_err(|reason| Fault::at(format!("animations[{a}].channels[{c}]"), reason))?;
        }
    }
    Ok(())
}

fn check_channel(root: &Root, channel: &Channel) -> Result<(), String> {
    let (node, there) = (channel.target.node.value(), root.nodes.len());
    if node >= there {
        return Err(format!("it moves node {node}, but there are {there}"));
    }
    if channel.target.path == Checked::Invalid {
        return Err("its path is none of translation, rotation, scale and weights".into());
    }
    Ok(())
}
