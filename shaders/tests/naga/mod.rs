//! WGSL through naga, for every crate that has some.

use naga::back::{hlsl, msl, spv};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};

/// Checks a module against core WebGPU.
pub fn validate(name: &str, source: &str) -> Result<(naga::Module, ModuleInfo), String> {
    let module =
        naga::front::wgsl::parse_str(source).map_err(|e| e.emit_to_string_with_path(source, name))?;
    // No capability beyond core WebGPU.
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::default());
    let info = validator.validate(&module).map_err(|e| e.emit_to_string_with_path(source, name))?;
    Ok((module, info))
}

/// The same, and into SPIR-V, Metal and HLSL.
pub fn translate(name: &str, source: &str) -> Result<(), String> {
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
