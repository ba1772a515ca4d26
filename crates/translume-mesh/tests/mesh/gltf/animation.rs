//! Interpolation, storage of keys, and targets.

use serde_json::json;
use translume_mesh::rig::Target;

use super::asset::{Asset, BYTE, UNSIGNED_SHORT};
use super::{agree, differ};

const TIMES: [f32; 4] = [0.25, 0.5, 1.25, 2.0];

/// Values for four keys, and tangents around them where they are asked for.
fn keys(path: &str, cubic: bool) -> Vec<f32> {
    let values: &[&[f32]] = match path {
        "translation" => &[&[0.0, 0.0, 0.0], &[2.0, 1.0, -1.0], &[2.0, -3.0, 0.0], &[1.0, 1.0, 1.0]],
        // The third is on the far side of the second: the shorter arc goes through its negative.
        "rotation" => {
            &[&[0.0, 0.0, 0.0, 1.0], &[0.6, 0.0, 0.0, 0.8], &[-0.36, 0.48, 0.0, -0.8], &[0.0, 1.0, 0.0, 0.0]]
        }
        "scale" => &[&[1.0, 1.0, 1.0], &[2.0, 0.5, 1.0], &[1.0, 3.0, -1.0], &[0.5, 0.5, 0.5]],
        _ => &[&[0.0, 0.0], &[1.0, 0.25], &[-0.5, 1.0], &[0.5, 0.5]],
    };
    let with_tangents = |(k, value): (usize, &&[f32])| {
        let tangent = |sign: f32| value.iter().map(move |x| sign * (0.7 - x) + 0.1 * k as f32);
        tangent(1.5).chain(value.iter().copied()).chain(tangent(-0.5)).collect::<Vec<f32>>()
    };
    if cubic { values.iter().enumerate().flat_map(with_tangents).collect() } else { values.concat() }
}

/// A tetrahedron with two morph targets, one property of it animated.
fn animated(path: &str, mode: &str) -> Asset {
    let mut asset = Asset::tetrahedron();
    let deltas = [[1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], [0.5; 12]];
    let targets: Vec<_> =
        deltas.iter().map(|deltas| json!({ "POSITION": asset.floats("VEC3", deltas) })).collect();
    asset.json["meshes"][0]["primitives"][0]["targets"] = json!(targets);
    asset.animate(0, path, mode, &TIMES, &keys(path, mode == "CUBICSPLINE"));
    asset
}

#[test]
fn every_property_moves_in_every_mode() {
    for path in ["translation", "rotation", "scale", "weights"] {
        for mode in ["STEP", "LINEAR", "CUBICSPLINE"] {
            let asset = animated(path, mode);
            let loaded = agree(&asset);
            assert_eq!(loaded.rig.unwrap().animations[0].duration, 2.0);

            let mut broken = asset.clone();
            // Later keys are worth the first one's, or tangents swap with values.
            let other = if mode == "STEP" { "LINEAR" } else { "STEP" };
            broken.json["animations"][0]["samplers"][0]["interpolation"] = json!(other);
            differ(&asset, &broken);
        }
    }
}

#[test]
fn linear_is_the_default_and_names_are_kept() {
    let mut asset = animated("translation", "LINEAR");
    let mut sampler = asset.json["animations"][0]["samplers"][0].take();
    sampler.as_object_mut().unwrap().remove("interpolation");
    asset.json["animations"][0]["samplers"][0] = sampler;
    asset.json["animations"][0]["name"] = json!("wander");
    let rig = agree(&asset).rig.unwrap();
    assert_eq!((rig.animations[0].name.as_str(), rig.nodes[0].name.as_str()), ("wander", "root"));
}

#[test]
fn integers_stand_for_rotations_and_weights() {
    let mut asset = animated("rotation", "LINEAR");
    let bytes: Vec<u8> = keys("rotation", false).iter().map(|x| (x * 127.0).round() as i8 as u8).collect();
    let output = asset.accessor(BYTE, "VEC4", 4, &bytes);
    asset.json["accessors"][output]["normalized"] = json!(true);
    asset.json["animations"][0]["samplers"][0]["output"] = json!(output);
    agree(&asset);
    let mut broken = asset.clone();
    let end = broken.bytes.len();
    broken.bytes[end - 3] = 0;
    broken.bytes[end - 4] = 127;
    differ(&asset, &broken);

    let mut asset = animated("weights", "LINEAR");
    let words = [0_u16, 65535, 65535, 0, 30000, 20000, 0, 0];
    let bytes: Vec<u8> = words.iter().flat_map(|x| x.to_le_bytes()).collect();
    let output = asset.accessor(UNSIGNED_SHORT, "SCALAR", 8, &bytes);
    asset.json["accessors"][output]["normalized"] = json!(true);
    asset.json["animations"][0]["samplers"][0]["output"] = json!(output);
    agree(&asset);
    let mut broken = asset.clone();
    let end = broken.bytes.len();
    broken.bytes[end - 14..end - 12].fill(0);
    differ(&asset, &broken);
}

#[test]
fn two_meshes_with_their_own_weights_stay_apart() {
    let mut asset = animated("weights", "LINEAR");
    let mut second = asset.tetrahedron_primitive();
    second["targets"] = json!([{ "POSITION": asset.floats("VEC3", &[2.0; 12]) }]);
    asset.push("meshes", json!({ "primitives": [second], "extras": { "targetNames": ["up"] } }));
    asset.push("nodes", json!({ "mesh": 1, "translation": [5, 0, 0] }));
    asset.json["scenes"][0]["nodes"] = json!([0, 1]);
    asset.animate(1, "weights", "STEP", &[0.0, 1.0], &[1.0, -1.0]);
    let loaded = agree(&asset);
    assert_eq!(loaded.mesh.targets.len(), 3);
    assert_eq!(loaded.mesh.targets[2].name, "up");
    assert_eq!(loaded.mesh.targets[2].position_deltas[..4], [[0.0; 3]; 4], "the first mesh stays");
    let channels = &loaded.rig.unwrap().animations[0].channels;
    assert_eq!(channels[0].target, Target::Weights { first: 0, count: 2 });
    assert_eq!(channels[1].target, Target::Weights { first: 2, count: 1 });

    let mut broken = asset.clone();
    broken.json["animations"][0]["channels"][1]["target"]["node"] = json!(7);
    differ(&asset, &broken);
}

#[test]
fn channels_without_a_node_or_outside_the_scene_are_left_out() {
    let mut asset = animated("translation", "LINEAR");
    asset.push("nodes", json!({ "name": "elsewhere" }));
    asset.animate(1, "translation", "STEP", &[9.0], &[1.0, 2.0, 3.0]);
    let pointer =
        json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": "/x" } } });
    let channels = asset.json["animations"][0]["channels"].as_array_mut().unwrap();
    channels.push(json!({ "sampler": 0, "target": pointer }));
    asset.json["extensionsUsed"] = json!(["KHR_animation_pointer"]);
    asset.json["extensionsRequired"] = json!(["KHR_animation_pointer"]);
    let rig = asset.load().unwrap().rig.unwrap();
    assert_eq!((rig.animations[0].channels.len(), rig.animations[0].duration), (1, 2.0));
}
