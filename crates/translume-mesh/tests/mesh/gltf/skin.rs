//! Skins, in every form that joints and weights are stored in.

use serde_json::json;
use translume_mesh::rig;

use super::asset::{Asset, UNSIGNED_BYTE, UNSIGNED_SHORT};
use super::{TOLERANCE, agree, differ, difference};

/// A tetrahedron on two joints, the second in the first, which bends it.
fn skinned() -> Asset {
    let mut asset = Asset::tetrahedron();
    let joints = asset.accessor(UNSIGNED_BYTE, "VEC4", 4, &[0, 1, 0, 0].repeat(4));
    let weights = [[1.0, 0.0], [0.75, 0.25], [0.5, 0.5], [0.125, 0.875]];
    let weights: Vec<f32> = weights.iter().flat_map(|w| [w[0], w[1], 0.0, 0.0]).collect();
    let weights = asset.floats("VEC4", &weights);
    let attributes = &mut asset.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    // The second joint stands at (0, 1, 0) in the first, which stands at (0, −1, 0).
    let shifted = |y: f32| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, y, 0.0, 1.0];
    // More matrices than joints are allowed.
    let binds = asset.floats("MAT4", &[shifted(1.0), shifted(0.0), shifted(9.0)].concat());
    asset.push("skins", json!({ "joints": [1, 2], "inverseBindMatrices": binds }));
    asset.json["nodes"] = json!([{ "mesh": 0, "skin": 0, "translation": [9, 9, 9] },
        { "children": [2], "translation": [0, -1, 0] }, { "translation": [0, 1, 0] }]);
    asset.json["scenes"][0]["nodes"] = json!([0, 1]);
    asset.animate(2, "rotation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 0.6, 0.0, 0.0, 0.8]);
    asset.animate(1, "translation", "LINEAR", &[0.0, 1.0], &[0.0, -1.0, 0.0, 1.0, -1.0, 0.0]);
    asset
}

#[test]
fn a_skin_bends_and_ignores_its_own_node() {
    let asset = skinned();
    let loaded = agree(&asset);
    assert_eq!(loaded.mesh.skin.unwrap().per_vertex, 2, "empty influences are dropped");
    assert_eq!(loaded.mesh.positions[0], [1.0; 3]);

    let mut broken = asset.clone();
    broken.json["skins"][0]["joints"] = json!([2, 1]);
    differ(&asset, &broken);
}

#[test]
fn a_skin_without_inverse_bind_matrices_has_the_identity() {
    let mut asset = skinned();
    asset.json["skins"][0].as_object_mut().unwrap().remove("inverseBindMatrices");
    agree(&asset);
    differ(&asset, &skinned());
}

/// Eight influences a vertex, joints in 16 bits, weights in 8 and 16 bits.
#[test]
fn further_sets_and_integers_are_read() {
    let mut asset = skinned();
    let words = |numbers: &[u16]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let joints = asset.accessor(UNSIGNED_SHORT, "VEC4", 4, &words(&[1, 0, 1, 0].repeat(4)));
    let bytes =
        asset.accessor(UNSIGNED_BYTE, "VEC4", 4, &[[100, 50, 0, 0], [0; 4], [20; 4], [9, 0, 0, 3]].concat());
    let shorts = asset.accessor(UNSIGNED_SHORT, "VEC4", 4, &words(&[6553, 0, 13107, 0].repeat(4)));
    asset.json["accessors"][bytes]["normalized"] = json!(true);
    asset.json["accessors"][shorts]["normalized"] = json!(true);
    let attributes = &mut asset.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_1"] = json!(joints);
    attributes["WEIGHTS_1"] = json!(bytes);
    attributes["JOINTS_2"] = json!(joints);
    attributes["WEIGHTS_2"] = json!(shorts);
    let skin = agree(&asset).mesh.skin.unwrap();
    assert_eq!(skin.per_vertex, 8, "of 12, the third vertex uses 2 + 4 + 2");
    for influences in skin.influences.chunks(8) {
        let sum: f32 = influences.iter().map(|influence| influence.weight).sum();
        assert!((sum - 1.0).abs() < 1e-6, "{sum}");
    }
    let mut broken = asset.clone();
    broken.json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("JOINTS_2");
    differ(&asset, &broken);
}

/// A mesh in centimetres on an armature with scale 0.01 has the size and place it has in the scene.
#[test]
fn an_armature_in_other_units_gives_metres() {
    let armature = |scale: f32| {
        let mut asset = skinned();
        asset.json["scenes"][0]["nodes"] = json!([0, 3]);
        asset.push(
            "nodes",
            json!({ "children": [1], "scale": [scale, scale, scale], "translation": [0.5, 0, 0] }),
        );
        asset
    };
    let asset = armature(0.01);
    let loaded = agree(&asset);
    let near = |a: [f32; 3], b: [f32; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-6);
    assert!(near(loaded.mesh.positions[0], [0.51, 0.01, 0.01]), "{:?}", loaded.mesh.positions[0]);
    // Bound as it stands: the default pose is the rest pose.
    let rig = loaded.rig.as_ref().unwrap();
    let posed = rig::posed(&loaded.mesh, &rig.rest_pose()).unwrap();
    assert!(posed.iter().zip(&loaded.mesh.positions).all(|(a, b)| near(*a, *b)));
    differ(&asset, &armature(0.011));
}

#[test]
fn a_collapsed_first_joint_leaves_the_bind_pose() {
    let mut asset = skinned();
    asset.json["nodes"][1]["scale"] = json!([0, 0, 0]);
    asset.animate(1, "scale", "LINEAR", &[0.5, 1.0], &[0.5, 0.5, 0.5, 1.0, 1.0, 1.0]);
    let loaded = agree(&asset);
    assert_eq!(loaded.mesh.positions[0], [1.0; 3]);
    let mut broken = asset.clone();
    broken.json["nodes"][2]["translation"] = json!([0, 2, 0]);
    differ(&asset, &broken);
}

#[test]
fn weightless_vertices_follow_their_first_joint() {
    let mut asset = skinned();
    let weights = asset.floats("VEC4", &[0.0; 16]);
    let joints = asset.accessor(UNSIGNED_BYTE, "VEC4", 4, &[1, 0, 0, 0].repeat(4));
    let attributes = &mut asset.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["WEIGHTS_0"] = json!(weights);
    attributes["JOINTS_0"] = json!(joints);
    let loaded = asset.load().unwrap();
    let mut whole = asset.clone();
    whole.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] =
        json!(whole.floats("VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(4)));
    for seconds in [0.0, 0.5, 1.0] {
        assert!(difference(&loaded, &whole.reference(), Some(0), seconds) < TOLERANCE);
    }
    let mut broken = whole.clone();
    broken.json["skins"][0]["joints"] = json!([2, 1]);
    assert!(difference(&loaded, &broken.reference(), Some(0), 1.0) > TOLERANCE);
}

/// A sword in a hand: a part on a joint's node, beside two nodes with one skin.
#[test]
fn plain_parts_and_shared_skins_stand_beside_each_other() {
    let mut asset = skinned();
    let sword = asset.tetrahedron_primitive();
    let sword = asset.push("meshes", json!({ "primitives": [sword] }));
    let mut twin = asset.json["meshes"][0].clone();
    // In the same place its triangles would repeat those of the first.
    let shifted: Vec<f32> =
        crate::fixtures::tetrahedron().positions.iter().flat_map(|p| [p[0] + 3.0, p[1], p[2]]).collect();
    let shifted = asset.floats("VEC3", &shifted);
    asset.json["accessors"][shifted]["min"] = json!([2, -1, -1]);
    asset.json["accessors"][shifted]["max"] = json!([4, 1, 1]);
    twin["primitives"][0]["attributes"]["POSITION"] = json!(shifted);
    let twin = asset.push("meshes", twin);
    asset.json["nodes"][2]["children"] = json!([3]);
    asset.push("nodes", json!({ "mesh": sword, "translation": [0, 4, 0] }));
    asset.push("nodes", json!({ "mesh": twin, "skin": 0 }));
    asset.json["scenes"][0]["nodes"] = json!([0, 1, 4]);
    let loaded = agree(&asset);
    assert_eq!(loaded.rig.unwrap().joints.len(), 3, "two of the skin, one of the sword");
    let mut broken = asset.clone();
    broken.json["nodes"][3]["translation"] = json!([0, 3, 0]);
    differ(&asset, &broken);
}
