//! Materials out of files.

use serde_json::{Value, json};
use translume_mesh::Material;
use translume_mesh::material::{ScatterDraft, Volume};

use super::asset::Asset;

fn with_material(material: Value) -> Asset {
    let mut asset = Asset::tetrahedron();
    asset.push("materials", material);
    asset.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    asset
}

fn load(material: Value) -> Material {
    with_material(material).load().unwrap().material.unwrap()
}

/// The examples in the two drafts, up to what they leave out.
#[test]
fn both_drafts_are_read() {
    let older = load(json!({ "name": "skin", "extensions": {
        "KHR_materials_volume_scatter": {
            "multiscatterColorFactor": [0.572, 0.227, 0.075], "scatterAnisotropy": 0.3 },
        "KHR_materials_volume": { "attenuationColor": [0.9, 0.9, 0.9], "attenuationDistance": 0.01 },
        "KHR_materials_diffuse_transmission": {
            "diffuseTransmissionFactor": 1.0, "diffuseTransmissionColorFactor": [1.0, 0.9, 0.85] },
        "KHR_materials_ior": { "ior": 1.4 },
    }, "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.25, 0.125, 1.0] } }));
    assert_eq!((older.name.as_str(), older.ior), ("skin", 1.4));
    assert_eq!(older.base_color, [0.5, 0.25, 0.125, 1.0]);
    let volume = Volume { thickness: 0.0, attenuation_distance: 0.01, attenuation_color: [0.9; 3] };
    assert_eq!(older.volume, Some(volume));
    assert_eq!(older.diffuse_transmission.unwrap().color, [1.0, 0.9, 0.85]);
    let scatter = older.scatter.unwrap();
    assert_eq!((scatter.draft, scatter.anisotropy), (ScatterDraft::VolumeScatter, 0.3));
    assert_eq!(scatter.multiscatter_color, [0.572, 0.227, 0.075]);
    assert!(older.scattering().is_some());

    let newer = load(json!({ "extensions": {
        "KHR_materials_scatter": { "multiscatterColorFactor": [0.8, 0.6, 0.5], "scatterAnisotropy": 0.2 },
        "KHR_materials_transmission": { "transmissionFactor": 1.0 },
        "KHR_materials_volume": {
            "thicknessFactor": 1.0, "attenuationDistance": 0.01, "attenuationColor": [0.95, 0.85, 0.75] },
    } }));
    assert_eq!(newer.ior, 1.5);
    let scatter = newer.scatter.unwrap();
    assert_eq!((scatter.draft, scatter.anisotropy), (ScatterDraft::Scatter, 0.2));
    assert_eq!(scatter.multiscatter_color, [0.8, 0.6, 0.5]);
    assert!(newer.scattering().is_some());
    assert_ne!(newer.scattering(), older.scattering());
}

#[test]
fn other_names_and_strengths_are_read() {
    let color = |name: &str, extension: Value| {
        load(json!({ "extensions": { name: extension } })).scatter.unwrap().multiscatter_color
    };
    let older = "KHR_materials_volume_scatter";
    assert_eq!(color(older, json!({ "multiscatterColor": [0.1, 0.2, 0.3] })), [0.1, 0.2, 0.3]);
    assert_eq!(color(older, json!({})), [0.0; 3]);
    let newer = "KHR_materials_scatter";
    assert_eq!(color(newer, json!({})), [1.0; 3]);
    for strength in ["scatterFactor", "scatterStrengthFactor"] {
        assert_eq!(
            color(newer, json!({ strength: 0.5, "multiscatterColorFactor": [1, 0, 0.5] })),
            [0.5, 0.0, 0.25]
        );
    }
}

#[test]
fn a_plain_material_is_the_default_but_for_its_name() {
    assert_eq!(load(json!({ "name": "wax" })), Material { name: "wax".into(), ..Material::default() });
    assert_eq!(Asset::tetrahedron().load().unwrap().material, None);
}

/// A required extension of materials or textures is no reason to refuse the shape.
#[test]
fn required_extensions_of_materials_do_no_harm() {
    let mut asset = with_material(json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }));
    asset.push("textures", json!({ "extensions": { "KHR_texture_basisu": { "source": 0 } } }));
    asset.json["extensionsRequired"] =
        json!(["KHR_texture_basisu", "KHR_materials_volume", "KHR_materials_volume_scatter"]);
    asset.load().unwrap();
    asset.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert!(asset.refuse().contains("KHR_draco_mesh_compression"));
}

#[test]
fn the_widest_medium_is_the_one() {
    let mut asset = with_material(json!({ "name": "glass" }));
    let wax = json!({ "name": "wax", "extensions": {
        "KHR_materials_volume": { "attenuationDistance": 0.01, "attenuationColor": [0.5, 0.5, 0.5] },
        "KHR_materials_volume_scatter": { "multiscatterColorFactor": [0.5, 0.5, 0.5] } } });
    asset.push("materials", json!({ "name": "wood" }));
    asset.push("materials", wax.clone());
    let mut jade = wax;
    jade["name"] = json!("jade");
    asset.push("materials", jade);
    let named = |scales: [f32; 4]| {
        let mut asset = asset.clone();
        for (k, scale) in scales.into_iter().enumerate() {
            let mut primitive = asset.tetrahedron_primitive();
            primitive["material"] = json!(k);
            let mesh = asset.push("meshes", json!({ "primitives": [primitive] }));
            let node = json!({ "mesh": mesh, "translation": [20 * k, 9, 0], "scale": [scale, scale, scale] });
            let node = asset.push("nodes", node);
            asset.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(node));
        }
        asset.json["nodes"][0].as_object_mut().unwrap().remove("mesh");
        asset.load().unwrap().material.unwrap().name
    };
    assert_eq!(named([5.0, 4.0, 1.0, 2.0]), "jade");
    assert_eq!(named([5.0, 4.0, 2.0, 1.0]), "wax");
    asset.json["materials"][2].as_object_mut().unwrap().remove("extensions");
    asset.json["materials"][3].as_object_mut().unwrap().remove("extensions");
    let named = |asset: &Asset| asset.load().unwrap().material.unwrap().name;
    assert_eq!(named(&asset), "glass");
}

#[test]
fn impossible_numbers_are_named() {
    for (extension, key, value) in [
        ("KHR_materials_ior", "ior", json!(-1)),
        ("KHR_materials_ior", "ior", json!("1.4")),
        ("KHR_materials_volume", "attenuationDistance", json!(0)),
        ("KHR_materials_volume", "attenuationColor", json!([0, 2, 0])),
        ("KHR_materials_volume", "attenuationColor", json!([0, 0])),
        ("KHR_materials_volume", "thicknessFactor", json!(-1)),
        ("KHR_materials_scatter", "scatterAnisotropy", json!(1.5)),
        ("KHR_materials_scatter", "scatterStrengthFactor", json!(2)),
        ("KHR_materials_volume_scatter", "multiscatterColor", json!([null, 0, 0])),
        ("KHR_materials_diffuse_transmission", "diffuseTransmissionFactor", json!(2)),
    ] {
        let error = with_material(json!({ "extensions": { extension: { key: value } } })).refuse();
        assert!(error.contains(&format!("materials[0].extensions.{extension}.{key}: ")), "{error}");
    }
}
