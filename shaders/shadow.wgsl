// Shadow: depth of the deformed mesh seen from a light.

struct View {
    matrix: mat4x4f,
}

@group(0) @binding(0) var<uniform> view: View;

@vertex
fn vertex(@location(0) position: vec4f) -> @builtin(position) vec4f {
    return view.matrix * vec4f(position.xyz, 1.0);
}
