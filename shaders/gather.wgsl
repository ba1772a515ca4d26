// Gather: every light → position, normal, live area and irradiance of every texel.

// A frame without lights that have an area, or without a shadow on the sky, runs a pipeline without them.
override AREA_LIGHTS: bool = true;
override SHADOWED_SKY: bool = true;

@group(0) @binding(0) var<uniform> lighting: Gather;
@group(0) @binding(1) var<storage, read> texels: array<Texel>;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;
@group(0) @binding(3) var<storage, read> positions: array<vec4f>;
@group(0) @binding(4) var<storage, read> normals: array<vec4f>;
// Eight directions to a word: the share of the texel that sees each, in fifteenths; a row of all texels for each word.
@group(0) @binding(5) var<storage, read> visible: array<u32>;
// Position, live area in mm².
@group(0) @binding(6) var<storage, read_write> texel_positions: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> texel_normals: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> texel_irradiance: array<vec4f>;
@group(0) @binding(9) var shadow_maps: texture_depth_2d_array;

@compute @workgroup_size(64)
fn irradiance(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= lighting.texel_count { return; }
    let texel = texels[index];
    let a = triangles[texel.triangle * 3u];
    let pa = positions[a].xyz;
    let side_1 = positions[triangles[texel.triangle * 3u + 1u]].xyz - pa;
    let side_2 = positions[triangles[texel.triangle * 3u + 2u]].xyz - pa;
    let weights = vec2f(texel.barycentric_1, texel.barycentric_2);
    let area = texel.area_ratio * 0.5 * length(cross(side_1, side_2));
    let own = receiver_at(texel.triangle, clamped(weights), area);
    let normal = own.normal;
    // How far triangles lean from it.
    var least = dot(own.face, normal);

    var light = vec3f(0.0);
    var count = 0.0;
    var seen = vec3f(1.0);
    if SHADOWED_SKY { seen = sky_share(index, normal); }
    for (var k = 0u; k < POINTS; k++) {
        let point = texel.points[k];
        if point.triangle != NOWHERE {
            let receiver = receiver_at(point.triangle, unpack2x16unorm(point.weights), area);
            light += arriving(receiver, seen);
            least = min(least, dot(receiver.face, normal));
            count += 1.0;
        }
    }
    let beyond = pa + side_1 * weights.x + side_2 * weights.y;
    texel_positions[index] = vec4f(select(beyond, own.position, lighting.on_surface == 1u), area);
    texel_normals[index] = vec4f(normal, least);
    texel_irradiance[index] = vec4f(light / count, 0.0);
}

// Weights of the second and third corner moved into the triangle.
fn clamped(w: vec2f) -> vec2f {
    let all = max(vec3f(1.0 - w.x - w.y, w.x, w.y), vec3f(0.0));
    return all.yz / (all.x + all.y + all.z);
}

// seen: share of the shadowed sky
fn arriving(receiver: Receiver, seen: vec3f) -> vec3f {
    var light = sky(receiver, seen);
    for (var k = 0u; k < lighting.light_count; k++) {
        if AREA_LIGHTS && lighting.lights[k].kind >= RECTANGLE {
            light += area_light(k, receiver);
        } else {
            light += direct(k, receiver);
        }
    }
    return light;
}

fn direct(index: u32, receiver: Receiver) -> vec3f {
    // A light on the surface itself would be infinitely bright in one point: within the texel it shines as from its rim.
    let arriving = arrival(index, receiver.position, receiver.half_width * receiver.half_width, receiver.normal);
    let cosine = dot(receiver.normal, arriving.to_light);
    if cosine <= 0.0 { return vec3f(0.0); }
    let lit = cosine * region_fraction(index, receiver) * visibility(index, 0u, receiver, arriving.to_light);
    return arriving.strength * entering(cosine) * lit;
}

// Fresnel's share, and how much of it counts: what enters aslant starts less deep, and more of it returns.
fn entering(cosine: f32) -> vec3f {
    let outside = clamp(cosine, 0.0, 1.0);
    let lost = 1.0 - refracted_cosine(lighting.eta, outside);
    return fresnel_transmittance(lighting.eta, outside) / (1.0 - lighting.slant * lost);
}

// All of an area light's irradiance in closed form; Fresnel's share and the shadow by its emitters.
fn area_light(index: u32, receiver: Receiver) -> vec3f {
    let whole = area_irradiance(index, receiver.position, receiver.normal);
    if whole <= 0.0 { return vec3f(0.0); }
    var entered = vec3f(0.0);
    var sum = 0.0;
    for (var k = 0u; k < lighting.lights[index].emitter_count; k++) {
        let emitter = lighting.emitters[lighting.lights[index].first_emitter + k].xyz;
        let offset = emitter - receiver.position;
        let to_light = safe_normalize(offset, receiver.normal);
        let cosine = dot(receiver.normal, to_light);
        let weight = max(cosine, 0.0) * max(-dot(emitter_normal(index, emitter), to_light), 0.0)
            / max(dot(offset, offset), receiver.half_width * receiver.half_width);
        if weight > 0.0 {
            entered += entering(cosine) * (weight * visibility(index, k, receiver, to_light));
            sum += weight;
        }
    }
    // No emitter above the horizon, yet a sliver of the light: at grazing incidence nothing enters but at eta = 1.
    if sum == 0.0 { return vec3f(0.0); }
    return lighting.lights[index].colour * entered * (whole / sum);
}

// Part of the quarter inside the box where the light enters.
fn region_fraction(index: u32, receiver: Receiver) -> f32 {
    let extent = max(receiver.half_width * sqrt(max(vec3f(1.0) - receiver.face * receiver.face, vec3f(0.0))), vec3f(1e-6));
    let low = clamp((receiver.position - lighting.lights[index].region_low) / (2.0 * extent) + 0.5, vec3f(0.0), vec3f(1.0));
    let high = clamp((lighting.lights[index].region_high - receiver.position) / (2.0 * extent) + 0.5, vec3f(0.0), vec3f(1.0));
    let fraction = low * high;
    return fraction.x * fraction.y * fraction.z;
}

// Mean over the quarter, seen from a light or one of its emitters.
fn visibility(index: u32, emitter: u32, receiver: Receiver, to_light: vec3f) -> f32 {
    if lighting.lights[index].first_view == NO_SHADOW { return 1.0; }
    let count = lighting.lights[index].view_count;
    let view = shadow_view(lighting.lights[index].first_view + emitter * count, count, to_light);
    return lit_share(lighting.views[view], receiver, to_light, (lighting.filter_side + 1u) / 2u);
}

// Ambient lights and environments.
fn sky(receiver: Receiver, seen: vec3f) -> vec3f {
    let normal = receiver.normal;
    var open = environment_irradiance(lighting.open_sky, normal);
    var shadowed = environment_irradiance(lighting.shadowed_sky, normal);
    for (var k = 0u; k < lighting.ambient_count; k++) {
        var light = ambient(k, normal);
        if AREA_LIGHTS && lighting.ambients[k].emitter_count > 0u { light *= cone_share(k, receiver); }
        if lighting.ambients[k].shadow == 1u { shadowed += light; } else { open += light; }
    }
    return open + shadowed * seen;
}

// The share of a narrow cone's light that the body lets through, by directions of its own.
fn cone_share(index: u32, receiver: Receiver) -> vec3f {
    var lit = vec3f(0.0);
    var all = vec3f(0.0);
    for (var k = 0u; k < lighting.ambients[index].emitter_count; k++) {
        let direction = lighting.emitters[lighting.ambients[index].first_emitter + k].xyz;
        let cosine = dot(receiver.normal, direction);
        if cosine > 0.0 {
            let light = cosine * entering(cosine);
            let view = lighting.views[lighting.ambients[index].first_view + k];
            lit += light * lit_share(view, receiver, direction, (lighting.filter_side + 1u) / 2u);
            all += light;
        }
    }
    return select(lit / all, vec3f(1.0), all <= vec3f(0.0));
}

// The share of the sky's light that the body lets through, by the directions along which that is known.
fn sky_share(index: u32, normal: vec3f) -> vec3f {
    var lit = vec3f(0.0);
    var all = vec3f(0.0);
    for (var k = 0u; k < lighting.direction_count; k++) {
        let cosine = dot(normal, lighting.sky[k].direction);
        if cosine > 0.0 {
            let light = lighting.sky[k].radiance * entering(cosine) * cosine;
            let word = visible[(k / 8u) * lighting.texel_count + index];
            lit += light * (f32((word >> (4u * (k % 8u))) & 15u) / 15.0);
            all += light;
        }
    }
    return select(lit / all, vec3f(1.0), all <= vec3f(0.0));
}

fn ambient(index: u32, normal: vec3f) -> vec3f {
    let x = clamp(dot(normal, lighting.ambients[index].axis) * 0.5 + 0.5, 0.0, 1.0) * AMBIENT_INTERVALS;
    let cell = min(u32(x), u32(AMBIENT_INTERVALS) - 1u);
    let low = lighting.ambients[index].table[cell].rgb;
    let high = lighting.ambients[index].table[cell + 1u].rgb;
    return lighting.ambients[index].radiance * mix(low, high, x - f32(cell));
}
