// The engine's own lighting, for texels instead of pixels: a slide projector with a pattern of leaves, which no light of Translume is.

struct Projector {
    // Millimetres to the slide, −1..1.
    matrix: mat4x4f,
    position: vec3f,
    // Radiant intensity: irradiance times distance squared, mm².
    intensity: f32,
    eta: f32,
    texels: u32,
    padding0: u32,
    padding1: u32,
}

@group(0) @binding(0) var<uniform> projector: Projector;
// Of every texel: position in mm, and its area.
@group(0) @binding(1) var<storage, read> positions: array<vec4f>;
// Unit normals.
@group(0) @binding(2) var<storage, read> normals: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> irradiance: array<vec4f>;

@compute @workgroup_size(64)
fn light(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= projector.texels { return; }
    let position = positions[id.x].xyz;
    let to_light = projector.position - position;
    let cosine = max(dot(normals[id.x].xyz, normalize(to_light)), 0.0);
    let clip = projector.matrix * vec4f(position, 1.0);
    let slide = clip.xy / clip.w;
    let lit = select(0.0, leaves(slide), all(abs(slide) < vec2f(1.0)) && clip.w > 0.0);
    // What enters: the surface reflects the rest.
    let entering = fresnel_transmittance(projector.eta, cosine) * cosine;
    let received = projector.intensity * entering * lit / dot(to_light, to_light);
    irradiance[id.x] = vec4f(received * vec3f(1.0, 0.85, 0.6), 0.0);
}

fn leaves(slide: vec2f) -> f32 {
    let angle = atan2(slide.y, slide.x);
    let edge = 0.55 + 0.25 * cos(7.0 * angle);
    return smoothstep(edge + 0.03, edge - 0.03, length(slide));
}
