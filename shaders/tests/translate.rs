//! Every module is valid WGSL and becomes SPIR-V, Metal and HLSL without help from a device.

use naga::back::{hlsl, msl, spv};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use translume_shaders::{ALL, MATERIAL};

fn validate(name: &str, source: &str) -> Result<(naga::Module, ModuleInfo), String> {
    let module =
        naga::front::wgsl::parse_str(source).map_err(|e| e.emit_to_string_with_path(source, name))?;
    // No capability beyond core WebGPU.
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::default());
    let info = validator.validate(&module).map_err(|e| e.emit_to_string_with_path(source, name))?;
    Ok((module, info))
}

fn translate(name: &str, source: &str) -> Result<(), String> {
    let (module, info) = validate(name, source)?;
    let constants = naga::back::PipelineConstants::default();
    let (module, info) = naga::back::pipeline_constants::process_overrides(&module, &info, None, &constants)
        .map_err(|error| format!("{name}: overrides: {error}"))?;
    spv::write_vec(&module, &info, &spv::Options::default(), None)
        .map_err(|error| format!("{name}: SPIR-V: {error}"))?;
    let metal = msl::Options { fake_missing_bindings: true, lang_version: (2, 4), ..Default::default() };
    msl::write_string(&module, &info, &metal, &msl::PipelineOptions::default())
        .map_err(|error| format!("{name}: Metal: {error}"))?;
    let direct = hlsl::Options { shader_model: hlsl::ShaderModel::V6_0, ..Default::default() };
    let mut text = String::new();
    hlsl::Writer::new(&mut text, &direct, &hlsl::PipelineOptions::default())
        .write(&module, &info, None)
        .map_err(|error| format!("{name}: HLSL: {error}"))?;
    Ok(())
}

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
