//! Names and default weights of morph targets, and which parts share them.

use serde_json::json;
use translume_mesh::rig;

use super::asset::Asset;
use super::{agree, differ};

/// Two nodes, each with a mesh of its own of two targets.
fn two_nodes() -> Asset {
    let mut asset = Asset::new();
    for (k, names) in [json!(["smile", ""]), json!(["", "frown"])].into_iter().enumerate() {
        let mut primitive = asset.tetrahedron_primitive();
        let targets: Vec<_> = (0..2)
            .map(|t| json!({ "POSITION": asset.floats("VEC3", &[(1 + t + 2 * k) as f32; 12]) }))
            .collect();
        primitive["targets"] = json!(targets);
        asset.push("meshes", json!({ "primitives": [primitive], "extras": { "targetNames": names } }));
        asset.push("nodes", json!({ "mesh": k, "translation": [5 * k, 0, 0] }));
    }
    asset.json["scenes"][0]["nodes"] = json!([0, 1]);
    asset
}

#[test]
fn parts_that_are_driven_alike_share_their_targets() {
    let mut asset = two_nodes();
    let loaded = asset.load().unwrap();
    assert!(loaded.rig.is_none() && loaded.mesh.skin.is_none(), "nothing moves and nothing is moved");
    let names: Vec<_> = loaded.mesh.targets.iter().map(|target| target.name.as_str()).collect();
    assert_eq!(names, ["smile", "frown"]);
    assert_eq!(loaded.mesh.targets[1].position_deltas, [[[2.0; 3]; 4], [[4.0; 3]; 4]].concat());

    // One says it on the mesh, the other on the node, over its mesh.
    asset.json["meshes"][0]["weights"] = json!([0.25, -1.0]);
    asset.json["meshes"][1]["weights"] = json!([7.0, 7.0]);
    asset.json["nodes"][1]["weights"] = json!([0.25, -1.0]);
    let loaded = agree(&asset);
    let rig = loaded.rig.unwrap();
    assert_eq!((rig.weights.as_slice(), rig.joints.len(), rig.nodes.len()), (&[0.25, -1.0][..], 0, 0));
    assert!(loaded.mesh.skin.is_none());
    let posed = rig::posed(&loaded.mesh, &rig.rest_pose()).unwrap();
    assert_eq!(posed[0], [1.0 + 0.25 - 2.0; 3]);
    let mut broken = asset.clone();
    broken.json["nodes"][1]["weights"] = json!([0.5, -1.0]);
    differ(&asset, &broken);
}

#[test]
fn parts_that_stand_differently_have_their_own() {
    let mut asset = two_nodes();
    asset.json["meshes"][0]["weights"] = json!([0.5, 0.0]);
    let loaded = agree(&asset);
    let names: Vec<_> = loaded.mesh.targets.iter().map(|target| target.name.as_str()).collect();
    assert_eq!(names, ["smile", "", "", "frown"]);
    assert_eq!(loaded.rig.unwrap().weights, [0.5, 0.0, 0.0, 0.0]);
    assert_eq!(loaded.mesh.targets[0].position_deltas, [[[1.0; 3]; 4], [[0.0; 3]; 4]].concat());
    let mut broken = asset.clone();
    broken.json["nodes"][1]["weights"] = json!([0.5, 0.0]);
    differ(&asset, &broken);
}

#[test]
fn names_that_are_none_are_empty() {
    for extras in [json!(7), json!({ "targetNames": 7 }), json!({ "targetNames": [7, "x", "y", "z"] })] {
        let mut asset = two_nodes();
        asset.json["scenes"][0]["nodes"] = json!([0]);
        asset.json["meshes"][0]["extras"] = extras;
        let targets = asset.load().unwrap().mesh.targets;
        assert_eq!((targets.len(), targets[0].name.as_str()), (2, ""));
    }
}
