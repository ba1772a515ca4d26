// The lights of a frame, as every stage that sees them reads them.

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
    padding: u32,
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
