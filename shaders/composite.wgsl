// Composite: the camera's view of the body, L_o = F_t(eta, ω_o)·B/π, with an optional surface reflection.

// Whether each triangle is seen with its own normal.
override FLAT_NORMALS: bool = false;

struct Composite {
    // Millimetres to clip space.
    view_projection: mat4x4f,
    // Millimetres.
    eye: vec3f,
    eta: f32,
    // 1/(1 − F_dr,ext) where the exit transmittance is normalised, else 1.
    exit_scale: f32,
    // Of the surface; 0 where it reflects nothing.
    roughness: f32,
    padding0: u32,
    padding1: u32,
}

@group(0) @binding(0) var<uniform> composite: Composite;
@group(0) @binding(1) var exitance: texture_2d<f32>;
@group(0) @binding(2) var<uniform> lighting: Gather;
@group(0) @binding(3) var shadow_maps: texture_depth_2d_array;

struct Fragment {
    // The depth pass and the picture must agree to the bit.
    @builtin(position) @invariant clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) exitance: vec3f,
}

@vertex
fn vertex(@location(0) xref: u32, @location(1) uv: vec2f, @location(2) position: vec3f, @location(3) normal: vec3f) -> Fragment {
    return Fragment(composite.view_projection * vec4f(position, 1.0), position, normal, uv, exitance_at_vertex(xref));
}

@fragment
fn fragment(in: Fragment) -> @location(0) vec4f {
    let to_eye = normalize(composite.eye - in.position);
    let cross_face = normalize(cross(dpdx(in.position), dpdy(in.position)));
    let face = select(-cross_face, cross_face, dot(cross_face, to_eye) >= 0.0);
    let shading = normalize(in.normal);
    let normal = select(select(-shading, shading, dot(shading, to_eye) >= 0.0), face, FLAT_NORMALS);
    let transmitted = fresnel_transmittance(composite.eta, dot(normal, to_eye));
    var radiance = exitance_at_fragment(in) * (0.31830988 * composite.exit_scale * transmitted);
    if composite.roughness > 0.0 {
        radiance += gloss(composite.roughness, in.position, normal, face, to_eye);
    }
    return vec4f(radiance, 1.0);
}

@fragment
fn depth_alone() -> @location(0) vec4f {
    return vec4f(0.0);
}
