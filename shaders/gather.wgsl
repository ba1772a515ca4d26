// Gather: every light → position, normal, live area and irradiance of every texel.

// Samples along each side of a texel's square; shadow edges are filtered at this footprint.
const FOOTPRINT: u32 = 4u;

struct Texel {
    triangle: u32,
    barycentric_1: f32,
    barycentric_2: f32,
    // Rest area of the texel over that of its triangle.
    area_ratio: f32,
}

@group(0) @binding(0) var<uniform> lighting: Gather;
@group(0) @binding(1) var<storage, read> texels: array<Texel>;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;
@group(0) @binding(3) var<storage, read> positions: array<vec4f>;
@group(0) @binding(4) var<storage, read> normals: array<vec4f>;
// Position, live area in mm².
@group(0) @binding(5) var<storage, read_write> texel_positions: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> texel_normals: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> texel_irradiance: array<vec4f>;
@group(0) @binding(8) var shadow_maps: texture_depth_2d_array;
@group(0) @binding(9) var shadow_sampler: sampler_comparison;

// What a light needs to know of a texel.
struct Receiver {
    position: vec3f,
    // Shading normal.
    normal: vec3f,
    // Normal of the triangle itself: shadows follow the geometry.
    face: vec3f,
    // Half the side of the texel's square, mm.
    half_width: f32,
    tangent: vec3f,
    bitangent: vec3f,
}

@compute @workgroup_size(64)
fn irradiance(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= lighting.texel_count { return; }
    let texel = texels[index];
    let a = triangles[texel.triangle * 3u];
    let b = triangles[texel.triangle * 3u + 1u];
    let c = triangles[texel.triangle * 3u + 2u];
    let pa = positions[a].xyz;
    let pb = positions[b].xyz;
    let pc = positions[c].xyz;
    let weights = vec3f(1.0 - texel.barycentric_1 - texel.barycentric_2, texel.barycentric_1, texel.barycentric_2);
    // Light is looked up on the triangle even where the texel's centre lies beyond its chart.
    let inside = max(weights, vec3f(0.0)) / (max(weights.x, 0.0) + max(weights.y, 0.0) + max(weights.z, 0.0));

    let doubled = cross(pb - pa, pc - pa);
    let doubled_area = length(doubled);
    let smooth_normal = safe_normalize(normals[a].xyz * inside.x + normals[b].xyz * inside.y + normals[c].xyz * inside.z, normals[a].xyz);
    var receiver: Receiver;
    receiver.position = pa * inside.x + pb * inside.y + pc * inside.z;
    receiver.face = safe_normalize(doubled * lighting.winding, smooth_normal);
    receiver.normal = select(smooth_normal, receiver.face, lighting.flat_normals == 1u);
    let area = texel.area_ratio * 0.5 * doubled_area;
    receiver.half_width = 0.5 * sqrt(area);
    receiver.tangent = any_perpendicular(receiver.face);
    receiver.bitangent = cross(receiver.face, receiver.tangent);

    var light = vec3f(0.0);
    for (var k = 0u; k < lighting.light_count; k++) {
        light += direct(k, receiver);
    }
    for (var k = 0u; k < lighting.ambient_count; k++) {
        light += ambient(k, receiver.normal);
    }
    texel_positions[index] = vec4f(pa * weights.x + pb * weights.y + pc * weights.z, area);
    texel_normals[index] = vec4f(receiver.normal, 0.0);
    texel_irradiance[index] = vec4f(light, 0.0);
}

fn direct(index: u32, receiver: Receiver) -> vec3f {
    // A light on the surface itself would be infinitely bright in one point: within the texel it shines as from its rim.
    let arriving = arrival(index, receiver.position, receiver.half_width * receiver.half_width, receiver.normal);
    let cosine = dot(receiver.normal, arriving.to_light);
    if cosine <= 0.0 { return vec3f(0.0); }
    let entered = fresnel_transmittance(lighting.eta, cosine) * cosine * region_fraction(index, receiver);
    return arriving.strength * (entered * visibility(index, receiver, arriving.to_light));
}

// Part of the texel's square inside the box where the light enters.
fn region_fraction(index: u32, receiver: Receiver) -> f32 {
    let extent = max(receiver.half_width * sqrt(max(vec3f(1.0) - receiver.face * receiver.face, vec3f(0.0))), vec3f(1e-6));
    let low = clamp((receiver.position - lighting.lights[index].region_low) / (2.0 * extent) + 0.5, vec3f(0.0), vec3f(1.0));
    let high = clamp((lighting.lights[index].region_high - receiver.position) / (2.0 * extent) + 0.5, vec3f(0.0), vec3f(1.0));
    let fraction = low * high;
    return fraction.x * fraction.y * fraction.z;
}

// Mean over the texel's square.
fn visibility(index: u32, receiver: Receiver, to_light: vec3f) -> f32 {
    if lighting.lights[index].first_view == NO_SHADOW { return 1.0; }
    let view = shadow_view(index, to_light);
    let lifted = lift(view, receiver.position, receiver.face, to_light, receiver.half_width);
    var lit = 0.0;
    let side = select(FOOTPRINT, 1u, receiver.half_width == 0.0);
    for (var v = 0u; v < side; v++) {
        for (var u = 0u; u < side; u++) {
            let offset = (2.0 * vec2f(f32(u), f32(v)) + 1.0) / f32(side) - 1.0;
            lit += lit_at(view, lifted + (receiver.tangent * offset.x + receiver.bitangent * offset.y) * receiver.half_width);
        }
    }
    return lit / f32(side * side);
}

fn ambient(index: u32, normal: vec3f) -> vec3f {
    let x = clamp(dot(normal, lighting.ambients[index].axis) * 0.5 + 0.5, 0.0, 1.0) * AMBIENT_INTERVALS;
    let cell = min(u32(x), u32(AMBIENT_INTERVALS) - 1u);
    let low = lighting.ambients[index].table[cell / 4u][cell % 4u];
    let high = lighting.ambients[index].table[(cell + 1u) / 4u][(cell + 1u) % 4u];
    return lighting.ambients[index].radiance * mix(low, high, x - f32(cell));
}

fn any_perpendicular(n: vec3f) -> vec3f {
    let axis = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(n.x) > 0.7);
    return safe_normalize(cross(axis, n), axis);
}
