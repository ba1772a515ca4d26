// What comes from one side: lights with a position or a direction, and from their middles those with an extent and narrow cones of the sky. The module declares
// the uniform `lighting`.

// Shares of a hemisphere, by cosines, between which a light ceases to come from one side and becomes a sky: 33° and 57° around its middle.
const NARROW: f32 = 0.3;
const BROAD: f32 = 0.7;

struct Beam {
    // Unit vector.
    to_light: vec3f,
    // Irradiance on a surface that faces the light; 0 where there is none.
    strength: vec3f,
    // To the light, mm.
    far: f32,
    // Light enters only inside this box, mm.
    low: vec3f,
    high: vec3f,
}

// A direction outside, away from a surface with this normal, as it is inside.
fn bent(outwards: vec3f, normal: vec3f) -> vec3f {
    let cosine = dot(normal, outwards);
    return (outwards - cosine * normal) / transport.eta + refracted_cosine(transport.eta, cosine) * normal;
}

fn beam_count() -> u32 {
    return lighting.light_count + lighting.ambient_count;
}

fn cone_fills(index: u32) -> f32 {
    let cosine = lighting.ambients[index].cone_cosine;
    return select(1.0, 1.0 - cosine * cosine, cosine > 0.0);
}

// Of a light that fills so much of a hemisphere, the strength of its beam over its radiance.
fn from_one_side(fills: f32) -> f32 {
    return 3.14159265 * fills * (1.0 - smoothstep(NARROW, BROAD, fills));
}

// Whether light comes from all sides, too.
fn has_sky() -> bool {
    var has = any(lighting.open_sky[0].rgb + lighting.shadowed_sky[0].rgb > vec3f(0.0));
    for (var k = 0u; k < lighting.ambient_count; k++) { has |= cone_fills(k) > NARROW; }
    return has;
}

// nearest_squared, fallback: as `arrival` takes them
fn beam(index: u32, position: vec3f, nearest_squared: f32, fallback: vec3f) -> Beam {
    if index >= lighting.light_count {
        let sky = index - lighting.light_count;
        let strength = from_one_side(cone_fills(sky)) * lighting.ambients[sky].radiance;
        return Beam(lighting.ambients[sky].axis, strength, FAR, vec3f(-FAR), vec3f(FAR));
    }
    let low = lighting.lights[index].region_low;
    let high = lighting.lights[index].region_high;
    let kind = lighting.lights[index].kind;
    let offset = lighting.lights[index].vector - position;
    if kind <= POINT {
        let comes = arrival(index, position, nearest_squared, fallback);
        return Beam(comes.to_light, comes.strength, select(FAR, length(offset), kind == POINT), low, high);
    }
    let square = max(dot(offset, offset), max(nearest_squared, 1e-12));
    let to_light = safe_normalize(offset, fallback);
    let right = lighting.lights[index].half_right;
    var fills = right.x * right.x / square;
    if kind == RECTANGLE {
        let front = max(-dot(lighting.lights[index].axis, to_light), 0.0);
        fills = 0.31830988 * 4.0 * length(cross(right, lighting.lights[index].half_up)) * front / square;
    }
    return Beam(to_light, lighting.lights[index].colour * from_one_side(fills), length(offset), low, high);
}
