// The lights of a frame, as every stage that sees them reads them. The including module declares the uniform `lighting`.

const DIRECTIONAL: u32 = 0u;
const POINT: u32 = 1u;
const RECTANGLE: u32 = 2u;
const SPHERE: u32 = 3u;
const NO_SHADOW: u32 = 0xffffffffu;
// Intervals of an ambient light's table over the cosine −1..1.
const AMBIENT_INTERVALS: f32 = 32.0;

struct Light {
    // Unit vector towards a directional light; position of a point light or middle of an area light, mm.
    vector: vec3f,
    kind: u32,
    // Irradiance on a facing surface; radiant intensity in units of mm² times irradiance; radiance of an area light.
    colour: vec3f,
    // First of its shadow views, or NO_SHADOW.
    first_view: u32,
    // Light enters the body only inside this box, mm.
    region_low: vec3f,
    // Shadow views, for an area light those of one emitter.
    view_count: u32,
    region_high: vec3f,
    // Strength towards cosine c of the angle from the axis: clamp(cone_scale·c + cone_offset, 0, 1)², 1 for a plain point light.
    cone_scale: f32,
    // Of a spot light's cone; where a rectangle shines to.
    axis: vec3f,
    cone_offset: f32,
    // Half a rectangle, mm; a sphere has its radius in x.
    half_right: vec3f,
    // Points of an area light.
    first_emitter: u32,
    half_up: vec3f,
    emitter_count: u32,
}

// Light from a cone of the sky.
struct Ambient {
    radiance: vec3f,
    // Cosine of the cone's half angle.
    cone_cosine: f32,
    axis: vec3f,
    // 1 where it is shadowed by what is known of the sky.
    shadow: u32,
    // Irradiance inside the surface for unit radiance, over the cosine between normal and axis.
    table: array<vec4f, 33>,
    // A narrow cone is shadowed along directions of its own, a view each.
    first_view: u32,
    first_emitter: u32,
    emitter_count: u32,
    padding: u32,
}

struct ShadowView {
    matrix: mat4x4f,
    // Corner and width of its square of the layer, in widths of a layer.
    tile: vec3f,
    layer: u32,
    // Width of a texel of the map, mm; for a perspective view at a depth of 1 mm.
    texel: f32,
    // 1 for a perspective view.
    perspective: f32,
    padding0: f32,
    padding1: f32,
}

// A direction in which the body's shadow is known, and the shadowed light of the sky from there.
struct Sky {
    direction: vec3f,
    padding0: u32,
    radiance: vec3f,
    padding1: u32,
}

struct Gather {
    texel_count: u32,
    light_count: u32,
    ambient_count: u32,
    // 1 where every triangle keeps its own normal.
    flat_normals: u32,
    eta: f32,
    winding: f32,
    // Comparisons with a depth map along each side of a texel's square.
    filter_side: u32,
    // 0 where no light of the sky is shadowed.
    direction_count: u32,
    // k of the gain of entry 1/(1 - k (1 - cosine inside)), per channel; 0 where all that enters counts alike.
    slant: vec3f,
    // 1 where texels beside a chart stand on it: discs that send must be where the surface is.
    on_surface: u32,
    // Environments that are seen from everywhere, and those that the body shadows, as `environment_irradiance` takes them.
    open_sky: array<vec4f, 9>,
    shadowed_sky: array<vec4f, 9>,
    lights: array<Light, 64>,
    ambients: array<Ambient, 8>,
    // Points of area lights: position, mm, and area, mm². Directions of narrow cones: unit vector and solid angle.
    emitters: array<vec4f, 256>,
    views: array<ShadowView, 256>,
    sky: array<Sky, 256>,
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

// Tangent of the angle between two unit vectors, up to 5.
fn tangent_between(a: vec3f, b: vec3f) -> f32 {
    return length(cross(a, b)) / max(dot(a, b), 0.2);
}
