// Camera and lights, as both rivals read them. Lengths are millimetres.

struct Light {
    // Where depth and the two other axes start: the light itself, or the middle of the body for a directional one.
    origin: vec3f,
    // 1 for a point light, 0 for a directional one.
    perspective: f32,
    right: vec3f,
    // Half the width of its map, mm; for a point light at a depth of 1 mm.
    half_width: f32,
    up: vec3f,
    near: f32,
    // Away from the light.
    forward: vec3f,
    far: f32,
    // Irradiance on a facing surface; radiant intensity in units of mm² times irradiance.
    colour: vec3f,
    // 0 where the body casts no shadow.
    shadow: f32,
    // Light enters only inside this box.
    region_low: vec3f,
    padding0: u32,
    region_high: vec3f,
    padding1: u32,
}

struct Scene {
    view_projection: mat4x4f,
    eye: vec3f,
    // Index of refraction inside over outside.
    eta: f32,
    // What F_t·B is multiplied with on the way to the eye, 1/(π·(1 − F_dr,ext)).
    exit_scale: f32,
    light_count: u32,
    padding0: u32,
    padding1: u32,
    lights: array<Light, 4>,
}

@group(0) @binding(0) var<uniform> scene: Scene;

// Right, up and forward of a point, mm.
fn in_light(light: Light, point: vec3f) -> vec3f {
    let offset = point - light.origin;
    return vec3f(dot(offset, light.right), dot(offset, light.up), dot(offset, light.forward));
}

// Clip space of a light, depth 0 at the near plane.
fn light_clip(light: Light, point: vec3f) -> vec4f {
    let p = in_light(light, point);
    let w = mix(1.0, p.z, light.perspective);
    let depth = (p.z - light.near) / (light.far - light.near);
    return vec4f(p.xy / light.half_width, depth * mix(1.0, light.far, light.perspective), w);
}

fn map_place(ndc: vec2f) -> vec2f {
    return ndc * vec2f(0.5, -0.5) + 0.5;
}

fn to_light(light: Light, point: vec3f) -> vec3f {
    if light.perspective == 0.0 { return -light.forward; }
    return normalize(light.origin - point);
}

fn enters(light: Light, point: vec3f) -> bool {
    return all(point >= light.region_low) && all(point <= light.region_high);
}
