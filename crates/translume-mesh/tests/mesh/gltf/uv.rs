//! Texture coordinates.

use serde_json::json;

use super::asset::{Asset, UNSIGNED_SHORT};

const UVS: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [0.25, 0.5], [-2.0, 1.5]];

fn coordinated() -> Asset {
    let mut asset = Asset::tetrahedron();
    let uvs = asset.floats("VEC2", UVS.as_flattened());
    asset.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(uvs);
    asset
}

#[test]
fn corners_have_the_coordinates_of_their_vertices() {
    for scale in [1, -1] {
        let mut asset = coordinated();
        asset.json["nodes"][0]["scale"] = json!([scale, 1, 1]);
        let mesh = asset.load().unwrap().mesh;
        let expected: Vec<_> = mesh.triangles.iter().map(|t| t.map(|v| UVS[v as usize])).collect();
        assert_eq!(mesh.uvs, expected, "also where mirroring turns the winding");
    }
    assert!(Asset::tetrahedron().load().unwrap().mesh.uvs.is_empty());
}

#[test]
fn integers_stand_for_coordinates() {
    let mut asset = coordinated();
    let bytes: Vec<u8> =
        [0_u16, 0, 65535, 0, 0, 65535, 13107, 26214].iter().flat_map(|x| x.to_le_bytes()).collect();
    let uvs = asset.accessor(UNSIGNED_SHORT, "VEC2", 4, &bytes);
    asset.json["accessors"][uvs]["normalized"] = json!(true);
    asset.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(uvs);
    let mesh = asset.load().unwrap().mesh;
    let expected = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.2, 0.4]];
    let expected: Vec<_> = mesh.triangles.iter().map(|t| t.map(|v| expected[v as usize])).collect();
    for (found, expected) in mesh.uvs.as_flattened().iter().zip(expected.as_flattened()) {
        // Both are rounded to f32 once.
        assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-7), "{found:?} {expected:?}");
    }
}

#[test]
fn parts_without_coordinates_have_zeros_beside_others() {
    let mut asset = coordinated();
    let plain = asset.tetrahedron_primitive();
    asset.push("meshes", json!({ "primitives": [plain] }));
    asset.push("nodes", json!({ "mesh": 1, "translation": [5, 0, 0] }));
    for (order, zeros) in [([0, 1], 4..8), ([1, 0], 0..4)] {
        asset.json["scenes"][0]["nodes"] = json!(order);
        let mesh = asset.load().unwrap().mesh;
        assert_eq!(mesh.uvs.len(), 8);
        for (t, uvs) in mesh.uvs.iter().enumerate() {
            assert_eq!(uvs == &[[0.0; 2]; 3], zeros.contains(&t), "triangle {t}");
        }
    }
}
