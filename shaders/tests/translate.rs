//! Every module is valid WGSL and becomes SPIR-V, Metal and HLSL without help from a device.

#[path = "naga/mod.rs"]
mod through_naga;

use through_naga::{translate, validate};
use translume_shaders::{ALL, MATERIAL};

#[test]
fn every_module_translates() {
    for shader in ALL {
        translate(shader.name, shader.source).unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn the_material_functions_stand_alone() {
    translate("material", MATERIAL).unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn the_environment_stands_alone() {
    let source = include_str!("../shared/environment.wgsl");
    translate("environment", source).unwrap_or_else(|error| panic!("{error}"));
    assert!(translate("broken", &source.replace("n: vec3f", "n: vec2f")).is_err());
}

#[test]
fn a_broken_module_is_noticed() {
    let broken = ALL[0].source.replace("vec3f", "vec4f");
    assert!(translate("broken", &broken).is_err());
}

#[test]
fn no_module_needs_more_than_webgpu_lends() {
    for shader in ALL {
        let (module, _) = validate(shader.name, shader.source).unwrap();
        let buffers = module
            .global_variables
            .iter()
            .filter(|(_, v)| matches!(v.space, naga::AddressSpace::Storage { .. }));
        assert!(buffers.count() <= 8, "{}: more than 8 storage buffers", shader.name);
        for entry in &module.entry_points {
            assert!(entry.workgroup_size.iter().product::<u32>() <= 256, "{}: {}", shader.name, entry.name);
        }
    }
}
