//! Files that contradict themselves: the error names the element.

use serde_json::json;

use super::asset::{Asset, UNSIGNED_BYTE};

fn animated() -> Asset {
    let mut asset = Asset::tetrahedron();
    let targets = json!([{ "POSITION": asset.floats("VEC3", &[1.0; 12]) }]);
    asset.json["meshes"][0]["primitives"][0]["targets"] = targets;
    asset.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[0.0; 6]);
    asset
}

fn skinned() -> Asset {
    let mut asset = Asset::tetrahedron();
    let joints = asset.accessor(UNSIGNED_BYTE, "VEC4", 4, &[0; 16]);
    let weights = asset.floats("VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(4));
    let attributes = &mut asset.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    asset.push("skins", json!({ "joints": [1] }));
    asset.json["nodes"] = json!([{ "mesh": 0, "skin": 0 }, {}]);
    asset.json["scenes"][0]["nodes"] = json!([0, 1]);
    asset
}

fn refused(mut asset: Asset, change: impl Fn(&mut Asset), what: &str) {
    asset.load().expect("it is the change that is refused");
    change(&mut asset);
    let error = asset.refuse();
    assert!(error.contains(what), "{what:?} is not in {error:?}");
}

/// Replaces the output or input of the only channel.
fn rekey(key: &'static str, kind: &'static str, numbers: &'static [f32]) -> impl Fn(&mut Asset) {
    move |asset| {
        let accessor = asset.floats(kind, numbers);
        asset.json["animations"][0]["samplers"][0][key] = json!(accessor);
    }
}

#[test]
fn channels_are_checked() {
    let channel = "animations[0].channels[0]: ";
    let at = |what: &str| format!("{channel}{what}");
    let target = |key: &'static str, value: serde_json::Value| {
        move |asset: &mut Asset| asset.json["animations"][0]["channels"][0]["target"][key] = value.clone()
    };
    refused(animated(), target("node", json!(7)), &at("it moves node 7, but there are 1"));
    refused(animated(), target("path", json!("color")), &at("its path is none of"));
    refused(
        animated(),
        target("path", json!("rotation")),
        "it holds Vec3 of F32, not vectors of four numbers",
    );
    refused(animated(), target("path", json!("weights")), channel);
    refused(animated(), rekey("input", "SCALAR", &[0.0, f32::NAN]), "number 1 (from 0) is NaN");
    refused(animated(), rekey("input", "SCALAR", &[0.0, f32::INFINITY]), "number 1 (from 0) is inf");
    refused(animated(), rekey("input", "SCALAR", &[1.0, 0.5]), "key 1 at 0.5 s does not come after 1 s");
    refused(animated(), rekey("input", "SCALAR", &[1.0, 1.0]), "key 1 at 1 s does not come after 1 s");
    refused(animated(), rekey("input", "SCALAR", &[]), channel);
    refused(animated(), rekey("input", "SCALAR", &[0.0, 1.0, 2.0]), "it has 2 elements, but the keys need 3");
    refused(animated(), rekey("output", "VEC3", &[0.0; 9]), "it has 3 elements, but the keys need 2");
    refused(animated(), rekey("output", "VEC3", &[f32::NAN; 6]), "number 0 (from 0) is NaN");
    let cubic = |asset: &mut Asset| {
        asset.json["animations"][0]["samplers"][0]["interpolation"] = json!("CUBICSPLINE");
    };
    refused(animated(), cubic, "it has 2 elements, but the keys need 6");
    let many = |asset: &mut Asset| {
        let input = asset.json["animations"][0]["samplers"][0]["input"].as_u64().unwrap() as usize;
        asset.json["accessors"][input]["count"] = json!(30_000_000);
    };
    refused(animated(), many, "30000000 elements of 4 bytes");
    let matrix = |asset: &mut Asset| {
        asset.json["nodes"][0]["matrix"] = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    };
    refused(animated(), matrix, &at("nodes[0] stands by a matrix, which cannot be animated"));
    let sampler = |asset: &mut Asset| asset.json["animations"][0]["channels"][0]["sampler"] = json!(3);
    refused(animated(), sampler, "animations[0].channels[0].sampler");
}

#[test]
fn skins_are_checked() {
    let attribute = |name: &'static str| {
        move |asset: &mut Asset| {
            let attributes = &mut asset.json["meshes"][0]["primitives"][0]["attributes"];
            attributes.as_object_mut().unwrap().remove(name);
        }
    };
    let primitive = "meshes[0].primitives[0]: its node has a skin, but it has no ";
    refused(skinned(), attribute("JOINTS_0"), &format!("{primitive}JOINTS_0"));
    refused(skinned(), attribute("WEIGHTS_0"), &format!("{primitive}WEIGHTS_0"));
    let unpaired = |asset: &mut Asset| {
        let attributes = &mut asset.json["meshes"][0]["primitives"][0]["attributes"];
        attributes["WEIGHTS_1"] = attributes["WEIGHTS_0"].clone();
    };
    refused(skinned(), unpaired, &format!("{primitive}JOINTS_1"));
    let joints = |asset: &mut Asset| {
        let joints =
            asset.accessor(UNSIGNED_BYTE, "VEC4", 4, &[0, 0, 0, 0, 5, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
        asset.json["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = json!(joints);
    };
    refused(skinned(), joints, "meshes[0].primitives[0]: vertex 1 follows joint 5, but its skin has 1");
    let floating = |asset: &mut Asset| {
        let joints = asset.floats("VEC4", &[0.0; 16]);
        asset.json["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = json!(joints);
    };
    refused(skinned(), floating, "not vectors of four joints in 8 or 16 bits");
    for bad in [-1.0, f32::NAN, f32::INFINITY] {
        let weights = move |asset: &mut Asset| {
            let weights = asset.floats("VEC4", &[bad; 16]);
            asset.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = json!(weights);
        };
        refused(skinned(), weights, "vertex 0 has the weights");
    }
    let binds = |count: usize, number: f32| {
        move |asset: &mut Asset| {
            let binds = asset.floats("MAT4", &vec![number; 16 * count]);
            asset.json["skins"][0]["inverseBindMatrices"] = json!(binds);
        }
    };
    refused(skinned(), binds(0, 1.0), "skins[0]: accessors[4]: it has 0 elements, but there are 1 joints");
    let vectors = |asset: &mut Asset| asset.json["skins"][0]["inverseBindMatrices"] = json!(3);
    refused(skinned(), vectors, "skins[0]: accessors[3]: it holds Vec4 of F32, not matrices");
    refused(skinned(), binds(1, f32::NAN), "skins[0]: accessors[4]: number 0 (from 0) is NaN");
    let missing = |asset: &mut Asset| asset.json["skins"][0]["inverseBindMatrices"] = json!(99);
    refused(skinned(), missing, "skins[0].inverseBindMatrices");
    refused(skinned(), |asset| asset.json["skins"][0]["joints"] = json!([]), "skins[0]: it has no joints");
    let outside = |asset: &mut Asset| asset.json["scenes"][0]["nodes"] = json!([0]);
    refused(skinned(), outside, "skins[0].joints[0]: nodes[1] is not in the scene");
}

#[test]
fn weights_and_coordinates_are_checked() {
    let weights =
        |numbers: &'static [f64]| move |asset: &mut Asset| asset.json["nodes"][0]["weights"] = json!(numbers);
    refused(animated(), weights(&[1.0, 2.0]), "nodes[0].weights: it has 2 weights for 1 morph targets");
    refused(animated(), weights(&[1e39]), "nodes[0].weights: number 0 (from 0) is inf");
    let uvs = |asset: &mut Asset| {
        let uvs = asset.floats("VEC2", &[0.0, 0.0, 0.0, f32::NAN, 0.0, 0.0, 0.0, 0.0]);
        asset.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(uvs);
    };
    refused(animated(), uvs, "number 3 (from 0) is NaN");
}

/// Many channels that share one long sampler, many nodes that share one mesh, and many empty objects.
#[test]
fn nothing_unfolds_without_bound() {
    let long = |asset: &mut Asset| {
        let keys: Vec<f32> = (0..20_000).map(|k| k as f32).collect();
        let input = asset.floats("SCALAR", &keys);
        let output = asset.floats("VEC3", &vec![0.0; 60_000]);
        asset.json["animations"][0]["samplers"][0] = json!({ "input": input, "output": output });
        let channel = asset.json["animations"][0]["channels"][0].clone();
        asset.json["animations"][0]["channels"] = json!(vec![channel; 2000]);
    };
    refused(animated(), long, "the scene unfolds to more than");
    let nodes = |asset: &mut Asset| {
        let primitive = asset.json["meshes"][0]["primitives"][0].clone();
        asset.json["meshes"][0]["primitives"] = json!(vec![primitive; 1000]);
        asset.json["nodes"] = json!(vec![json!({ "mesh": 0 }); 2000]);
        asset.json["scenes"][0]["nodes"] = json!((0..2000).collect::<Vec<_>>());
    };
    refused(animated(), nodes, "the scene unfolds to more than");
    let objects = |asset: &mut Asset| asset.json["extras"] = json!(vec![json!({}); 600_000]);
    refused(animated(), objects, "its JSON unfolds to more than 524288 objects");
}
