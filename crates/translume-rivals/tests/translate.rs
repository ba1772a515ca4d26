//! Both rivals' modules are valid WGSL and become SPIR-V, Metal and HLSL without help from a device.

#[path = "../../../shaders/tests/naga/mod.rs"]
mod through_naga;

use through_naga::translate;
use translume_rivals::{SCREEN_SPACE, TRANSLUCENT_SHADOW_MAP};

const BOTH: [(&str, [&str; 3]); 2] =
    [("translucent shadow map", TRANSLUCENT_SHADOW_MAP), ("screen space", SCREEN_SPACE)];

#[test]
fn both_modules_translate() {
    for (name, parts) in BOTH {
        translate(name, &parts.join("\n")).unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn a_broken_module_is_noticed() {
    for (name, parts) in BOTH {
        assert!(translate(name, &parts.join("\n").replace("vec3f", "vec4f")).is_err());
    }
}
