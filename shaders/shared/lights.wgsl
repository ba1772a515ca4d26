// The lights of a frame, as every stage that sees them reads them. The including module declares the uniform `lighting`.

const DIRECTIONAL: u32 = 0u;
const POINT: u32 = 1u;
const NO_SHADOW: u32 = 0xffffffffu;
// Intervals of an ambient light's table over the cosine −1..1.
const AMBIENT_INTERVALS: f32 = 32.0;

struct Light {
    // Unit vector towards a directional light; position of a point light, mm.
    vector: vec3f,
    kind: u32,
    // Irradiance on a facing surface; radiant intensity in units of mm² times irradiance.
    colour: vec3f,
    // First of its shadow views, or NO_SHADOW.
    first_view: u32,
    // Light enters the body only inside this box, mm.
    region_low: vec3f,
    view_count: u32,
    region_high: vec3f,
    // Strength towards cosine c of the angle from the axis: clamp(cone_scale·c + cone_offset, 0, 1)², 1 for a plain point light.
    cone_scale: f32,
    axis: vec3f,
    cone_offset: f32,
}

// Unoccluded light from a cone of the sky.
struct Ambient {
    radiance: vec3f,
    // Cosine of the cone's half angle.
    cone_cosine: f32,
    axis: vec3f,
    padding: u32,
    // Irradiance inside the surface for unit radiance, over the cosine between normal and axis; 33 values.
    table: array<vec4f, 9>,
}

struct ShadowView {
    matrix: mat4x4f,
    // Width of a texel of the map, mm; for a perspective view at a depth of 1 mm.
    texel: f32,
    // 1 for a perspective view.
    perspective: f32,
    padding0: f32,
    padding1: f32,
}

struct Gather {
    texel_count: u32,
    light_count: u32,
    ambient_count: u32,
    // 1 where every triangle keeps its own normal.
    flat_normals: u32,
    eta: f32,
    winding: f32,
    padding0: u32,
    padding1: u32,
    lights: array<Light, 64>,
    views: array<ShadowView, 64>,
    ambients: array<Ambient, 8>,
}

// What comes from a directional, point or spot light.
struct Arrival {
    // Unit vector.
    to_light: vec3f,
    // Irradiance on a surface that faces the light.
    strength: vec3f,
}

// nearest_squared: least distance, squared, that the falloff of a point light knows, mm²
// fallback: direction towards a light that lies on the position itself
fn arrival(index: u32, position: vec3f, nearest_squared: f32, fallback: vec3f) -> Arrival {
    let light = lighting.lights[index].vector;
    let strength = lighting.lights[index].colour;
    if lighting.lights[index].kind != POINT { return Arrival(light, strength); }
    let offset = light - position;
    let distance_squared = max(dot(offset, offset), max(nearest_squared, 1e-12));
    let to_light = safe_normalize(offset, fallback);
    let cosine = -dot(lighting.lights[index].axis, to_light);
    let cone = saturate(lighting.lights[index].cone_scale * cosine + lighting.lights[index].cone_offset);
    return Arrival(to_light, strength * (cone * cone / distance_squared));
}

fn safe_normalize(v: vec3f, fallback: vec3f) -> vec3f {
    let length_squared = dot(v, v);
    if length_squared > 0.0 { return v * inverseSqrt(length_squared); }
    return fallback;
}
