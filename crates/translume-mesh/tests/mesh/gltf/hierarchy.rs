//! Nodes in nodes.

use proptest::prelude::*;
use serde_json::json;

use super::algebra::cross;
use super::asset::Asset;
use super::{TOLERANCE, agree, differ, greatest_difference};

/// A root that turns, a node with a matrix in it, and a mesh on the last of the chain.
fn chain(middle: &serde_json::Value) -> Asset {
    let mut asset = Asset::tetrahedron();
    asset.json["nodes"] = json!([{ "children": [1], "translation": [1, 2, 3] }, middle, {
        "mesh": 0, "translation": [0, 3, 0], "rotation": [0.5, 0.5, 0.5, 0.5] }]);
    asset.json["nodes"][1]["children"] = json!([2]);
    asset.animate(0, "rotation", "LINEAR", &[0.0, 2.0], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.8, 0.0, 0.6]);
    asset.animate(2, "translation", "LINEAR", &[0.0, 1.0], &[0.0, 3.0, 0.0, 4.0, 0.0, 0.0]);
    asset
}

#[test]
fn a_matrix_in_the_middle_holds() {
    let asset = chain(&json!({ "matrix": [0, 2, 0, 0, -1, 0, 0, 0, 0, 0, 0.5, 0, 4, 5, 6, 1] }));
    agree(&asset);
    differ(&asset, &chain(&json!({ "matrix": [0, 2, 0, 0, -1, 0, 0, 0, 0, 0, 0.5, 0, 4, 5, 7, 1] })));
}

#[test]
fn mirrored_parts_face_outwards_and_move() {
    let asset = chain(&json!({ "scale": [1, -2, 1] }));
    let loaded = agree(&asset);
    let signed = |t: usize| {
        let [a, b, c] = loaded.mesh.corners(t).map(|p| p.map(f64::from));
        let normal = cross(b, c);
        (0..3).map(|k| a[k] * normal[k]).sum::<f64>()
    };
    assert!((0..4).map(signed).sum::<f64>() > 0.0, "the volume is negative");
    differ(&asset, &chain(&json!({ "scale": [1, 2, 1] })));
}

/// A node that is flat at rest keeps its place and follows its parent, and is not unfolded later.
#[test]
fn flat_nodes_rest_where_they_are() {
    let mut asset = Asset::tetrahedron();
    asset.json["nodes"] = json!([{ "children": [1, 2], "translation": [1, 2, 3] },
        { "mesh": 0, "scale": [2, 3, 0], "rotation": [0.6, 0, 0, 0.8] }, { "mesh": 0, "translation": [5, 0, 0] }]);
    asset.animate(0, "rotation", "LINEAR", &[0.0, 2.0], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.8, 0.0, 0.6]);
    agree(&asset);

    // The comparison notices what is lost.
    asset.animate(1, "scale", "LINEAR", &[0.0, 2.0], &[2.0, 3.0, 0.0, 2.0, 3.0, 1.0]);
    let loaded = asset.load().unwrap();
    assert!(greatest_difference(&loaded, &asset.reference()) > TOLERANCE);
}

/// Up to six nodes, each with a parent before it, a mesh on all of them, and one animated.
fn hierarchies() -> impl Strategy<Value = Asset> {
    let vector = |low: f32, high: f32| prop::array::uniform3(low..high);
    let quaternion = prop::array::uniform4(-1.0_f32..1.0)
        .prop_filter("no direction", |q| q.iter().map(|x| x * x).sum::<f32>() > 0.1)
        .prop_map(|q| {
            let length = q.iter().map(|x| x * x).sum::<f32>().sqrt();
            q.map(|x| x / length)
        });
    let scale = (vector(0.4, 2.0), any::<bool>()).prop_map(|(s, mirrored)| {
        let sign = if mirrored { -1.0 } else { 1.0 };
        [s[0] * sign, s[1], s[2]]
    });
    let node = (vector(-3.0, 3.0), quaternion.clone(), scale, any::<prop::sample::Index>());
    let moved = (prop::collection::vec(quaternion, 3), prop::collection::vec(vector(-2.0, 2.0), 3));
    (prop::collection::vec(node, 1..6), any::<prop::sample::Index>(), moved).prop_map(
        |(nodes, animated, (rotations, translations))| {
            let mut asset = Asset::tetrahedron();
            let mut json = Vec::new();
            for (k, (translation, rotation, scale, parent)) in nodes.iter().enumerate() {
                json.push(
                    json!({ "mesh": 0, "translation": translation, "rotation": rotation, "scale": scale,
                    "children": [] }),
                );
                if k > 0 {
                    let parent: &mut serde_json::Value = &mut json[parent.index(k)];
                    parent["children"].as_array_mut().unwrap().push(json!(k));
                }
            }
            for node in &mut json {
                if node["children"] == json!([]) {
                    node.as_object_mut().unwrap().remove("children");
                }
            }
            asset.json["nodes"] = json!(json);
            let animated = animated.index(nodes.len());
            asset.animate(animated, "rotation", "LINEAR", &[0.0, 1.0, 1.5], &rotations.concat());
            asset.animate(animated, "translation", "LINEAR", &[0.5, 1.0, 2.0], &translations.concat());
            asset
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn any_hierarchy_agrees(asset in hierarchies()) {
        agree(&asset);
    }

    #[test]
    fn any_hierarchy_notices_a_shifted_root(asset in hierarchies()) {
        let mut broken = asset.clone();
        broken.json["nodes"][0]["translation"] = json!([40, 0, 0]);
        differ(&asset, &broken);
    }
}
