// Translucent shadow maps: Dachsbacher, Stamminger 2003. The map holds where light entered and how much; every fragment of the picture sums
// the dipole over it by a pattern that takes coarser levels further out.

override RINGS: u32 = 4u;
override SPOKES: u32 = 5u;
// Whether the dipole's sources stand along the normal of the point of entry, or the dipole is that of the distance alone.
override DISPLACED: bool = false;

const TABLE_CELLS: f32 = 127.0;
const NOTHING: f32 = 1e30;
// Between the pattern and the map.
const LEAST_COSINE: f32 = 0.3;

struct Medium {
    // 1/mm.
    sigma_tr: vec3f,
    // −ln of energy per cell of the table.
    table_step: f32,
    // Depth of the real source and height of the virtual one, mm.
    z_real: vec3f,
    padding0: u32,
    z_virtual: vec3f,
    padding1: u32,
    // α'/2.
    half_albedo: vec3f,
    padding2: u32,
    // 1/(total reflectance · number of channels that scatter).
    share: vec3f,
    padding3: u32,
    // r², mm², beyond which a share of the energy lies, over −ln of that share.
    radii: array<vec4f, 32>,
}

@group(0) @binding(1) var<uniform> medium: Medium;
// What enters through a unit of map over what arrives there (a), times the normal (rgb).
@group(0) @binding(2) var entering: texture_2d_array<f32>;
// The same times depth, −1 at the near plane, 1 at the far one.
@group(0) @binding(3) var depths: texture_2d_array<f32>;
@group(0) @binding(4) var smooth_sampler: sampler;

struct Vertex {
    @builtin(position) @invariant clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) @interpolate(flat) light: u32,
}

struct Texel {
    @location(0) entering: vec4f,
    @location(1) depth: vec4f,
}

// ---- the map

@vertex
fn from_light(@location(0) position: vec3f, @location(1) normal: vec3f, @builtin(instance_index) index: u32) -> Vertex {
    return Vertex(light_clip(scene.lights[index], position), position, normal, index);
}

@fragment
fn store(in: Vertex) -> Texel {
    let light = scene.lights[in.light];
    let direction = to_light(light, in.position);
    let face = normalize(cross(dpdx(in.position), dpdy(in.position)));
    let normal = normalize(in.normal);
    let cosine = dot(normal, direction);
    let place = in_light(light, in.position);
    let depth = (2.0 * place.z - light.near - light.far) / (light.far - light.near);
    if cosine <= 0.0 || !enters(light, in.position) { return Texel(vec4f(0.0), vec4f(0.0)); }
    // A unit of map stands for 1/(n·l) of surface. Seen from the side it is so much that a texel cannot hold it.
    let surface = 1.0 / max(abs(dot(face, direction)), 0.05);
    // Solid angle over a unit of map at a distance of 1: the cube of the cosine to the axis.
    let axis = dot(-direction, light.forward);
    let weight = fresnel_transmittance(scene.eta, cosine) * cosine * surface * mix(1.0, axis * axis * axis, light.perspective);
    return Texel(vec4f(weight * normal, weight), vec4f(weight * depth, 0.0, 0.0, 0.0));
}

// ---- its coarser levels; `entering` and `depths` are the level above here

@vertex
fn whole(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn halve(@builtin(position) place: vec4f) -> Texel {
    let first = 2 * vec2i(place.xy);
    var sum = Texel(vec4f(0.0), vec4f(0.0));
    for (var k = 0; k < 4; k++) {
        let texel = first + vec2i(k & 1, k >> 1u);
        sum.entering += 0.25 * textureLoad(entering, texel, 0, 0);
        sum.depth += 0.25 * textureLoad(depths, texel, 0, 0);
    }
    return sum;
}

// ---- the picture

@vertex
fn from_eye(@location(0) position: vec3f, @location(1) normal: vec3f) -> Vertex {
    return Vertex(scene.view_projection * vec4f(position, 1.0), position, normal, 0u);
}

@fragment
fn depth_alone() -> @location(0) vec4f {
    return vec4f(0.0);
}

@fragment
fn picture(in: Vertex) -> @location(0) vec4f {
    let to_eye = normalize(scene.eye - in.position);
    let normal = normalize(in.normal);
    var exitance = vec3f(0.0);
    for (var k = 0u; k < scene.light_count; k++) { exitance += scattered(k, in.position, normal); }
    return vec4f(exitance * (scene.exit_scale * fresnel_transmittance(scene.eta, abs(dot(normal, to_eye)))), 1.0);
}

// A receiver as a light sees it.
struct Receiver {
    position: vec3f,
    // The plane of the pattern, and what a unit of it is on the map.
    right: vec3f,
    up: vec3f,
    foreshortening: f32,
    // Texels of the map per mm.
    texels: f32,
}

// What entered around a place of the map.
struct Entry {
    weight: f32,
    // From the receiver.
    offset: vec3f,
    normal: vec3f,
    // How much wider a cell of the map is there than at the receiver.
    widening: f32,
}

// offset: in the plane of the pattern, mm      level: of the map, its texels as wide as what is averaged
fn entry(index: u32, receiver: Receiver, offset: vec2f, level: f32) -> Entry {
    let light = scene.lights[index];
    let seen = in_light(light, receiver.position + receiver.right * offset.x + receiver.up * offset.y);
    let place = map_place(seen.xy / (light.half_width * mix(1.0, seen.z, light.perspective)));
    let found = textureSampleLevel(entering, smooth_sampler, place, index, level);
    let depth = textureSampleLevel(depths, smooth_sampler, place, index, level).x / max(found.a, 1e-20);
    // Nothing enters beside the map, whatever its outermost texels hold.
    let cell = exp2(level) / f32(textureDimensions(entering).x);
    let inside = saturate((0.5 * cell + 0.5 - abs(place - 0.5)) / cell);
    let z = 0.5 * (light.near + light.far + depth * (light.far - light.near));
    // A directional light counts depth from the middle of the body, where it is 0.
    let widening = select(1.0, z / seen.z, light.perspective > 0.0);
    let lateral = (place - 0.5) * vec2f(2.0, -2.0) * (light.half_width * mix(1.0, z, light.perspective));
    let position = light.origin + light.right * lateral.x + light.up * lateral.y + light.forward * z;
    // Power on a unit of the plane, as far away as what it fell on: for a point light less with the square of the depth.
    let weight = found.a * inside.x * inside.y * receiver.foreshortening / mix(1.0, z * z, light.perspective);
    return Entry(weight, position - receiver.position, found.xyz / max(found.a, 1e-20), widening);
}

// ∫ R_d 2πρ dρ beyond a distance, up to the factor α'/2: z·e^(−σ_tr d)/d of both sources.
fn beyond(real_squared: vec3f, virtual_squared: vec3f) -> vec3f {
    let real = sqrt(real_squared);
    let mirrored = sqrt(virtual_squared);
    return medium.z_real * exp(-medium.sigma_tr * real) / real + medium.z_virtual * exp(-medium.sigma_tr * mirrored) / mirrored;
}

// Squared radius on the flat beyond which e^(−x) of the energy lies.
fn radius_squared(x: f32) -> f32 {
    let cell = min(x / medium.table_step, TABLE_CELLS);
    let low = min(u32(cell), u32(TABLE_CELLS) - 1u);
    let high = low + 1u;
    return mix(medium.radii[low / 4u][low % 4u], medium.radii[high / 4u][high % 4u], cell - f32(low));
}

// Distance of the nearest place of entry, by a look at the middle and four around it: how wide the pattern has to be.
fn nearest_entry(index: u32, receiver: Receiver) -> f32 {
    let reach = sqrt(radius_squared(0.6931472));
    let level = max(log2(reach * receiver.texels), 0.0);
    var nearest = NOTHING;
    for (var k = 0; k < 5; k++) {
        let direction = select(vec2f(f32(k & 1) * 2.0 - 1.0, f32(k >> 1u) * 2.0 - 1.0) * 0.70710678, vec2f(0.0), k == 4);
        let there = entry(index, receiver, direction * reach, select(level, 0.0, k == 4));
        if there.weight > 0.0 { nearest = min(nearest, length(there.offset)); }
    }
    return select(nearest, 0.0, nearest == NOTHING);
}

// With the pattern in a plane of this normal.
fn receiver_at(index: u32, position: vec3f, normal: vec3f, direction: vec3f) -> Receiver {
    let light = scene.lights[index];
    let axis = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(normal.x) > 0.7);
    let right = normalize(cross(axis, normal));
    let foreshortening = dot(normal, direction) / dot(-light.forward, direction);
    let width = 2.0 * light.half_width * mix(1.0, in_light(light, position).z, light.perspective);
    let texels = f32(textureDimensions(entering).x) * sqrt(foreshortening) / width;
    return Receiver(position, right, cross(normal, right), foreshortening, texels);
}

fn scattered(index: u32, position: vec3f, normal: vec3f) -> vec3f {
    let light = scene.lights[index];
    let direction = to_light(light, position);
    let across = receiver_at(index, position, direction, direction);
    let nearest = nearest_entry(index, across);
    // Near where light enters the pattern lies on the surface, for light that comes through across the light.
    let flat = exp(-6.0 * nearest / dot(medium.z_real, vec3f(1.0)));
    let cosine = dot(normal, direction);
    let lifted = normal * select(-1.0, 1.0, cosine >= 0.0) + direction * max(LEAST_COSINE - abs(cosine), 0.0);
    let receiver = receiver_at(index, position, normalize(mix(direction, lifted, flat)), direction);

    let nearest_squared = nearest * nearest;
    let energy = dot(medium.half_albedo * medium.share, beyond(nearest_squared + medium.z_real * medium.z_real, nearest_squared + medium.z_virtual * medium.z_virtual));
    let start = -log(clamp(energy, 1e-30, 1.0));

    let count = 1.0 + f32(RINGS * SPOKES);
    var sum = vec3f(0.0);
    var inner_squared = 0.0;
    for (var ring = 0u; ring <= RINGS; ring++) {
        // Every sample stands for the same share of the energy, the one in the middle too.
        let spokes = select(SPOKES, 1u, ring == 0u);
        let first = select(1.0 + f32((ring - 1u) * SPOKES), 0.0, ring == 0u);
        let last = ring == RINGS;
        let end = first + f32(spokes) * select(1.0, 0.75, last);
        let outer_squared = max(radius_squared(start - log(1.0 - end / count)) - nearest_squared, inner_squared);
        let middle = max(radius_squared(start - log(1.0 - (first + 0.5 * f32(spokes)) / count)) - nearest_squared, 0.0);
        let radius = select(sqrt(clamp(middle, inner_squared, outer_squared)), 0.0, ring == 0u);
        let side = sqrt(3.14159265 * (outer_squared - inner_squared) / f32(spokes));
        // Filtering widens a texel: more where nothing is smooth, at the edges of shadows, than where light comes through.
        let level = max(log2(side * receiver.texels) - mix(0.5, 1.0, flat), 0.0);
        for (var spoke = 0u; spoke < spokes; spoke++) {
            let angle = 6.2831853 * (f32(spoke) + 0.5) / f32(spokes) + 2.3999632 * f32(ring);
            let there = entry(index, receiver, vec2f(cos(angle), sin(angle)) * radius, level);
            sum += there.weight / f32(spokes) * ring_energy(there, radius, vec2f(inner_squared, outer_squared), last);
        }
        inner_squared = outer_squared;
    }
    return sum * light.colour * medium.half_albedo;
}

// Energy from a ring of the pattern as far away as `there`, up to the factor α'/2. The ring's edges only change the part of the distance that
// lies in the plane of the pattern, so the integral is closed.
fn ring_energy(there: Entry, radius: f32, edges_squared: vec2f, endless: bool) -> vec3f {
    let widening = there.widening * there.widening;
    let distance_squared = dot(there.offset, there.offset);
    let flat_squared = radius * radius * widening;
    let apart = distance_squared - flat_squared;
    // A surface that bends back to the receiver is as good as a smaller ring.
    var shrinking = 1.0;
    if apart < 0.0 { shrinking = max(distance_squared / flat_squared, 1e-3); }
    let real_least = medium.z_real * medium.z_real;
    let virtual_least = medium.z_virtual * medium.z_virtual;
    var real = max(apart, 0.0) + real_least;
    var mirrored = max(apart, 0.0) + virtual_least;
    if DISPLACED {
        let along = dot(there.offset, there.normal);
        // A source may lie on the receiver, where a sheet is z_r thick: no dipole of Jensen's is nearer than z_r.
        real = max(apart - 2.0 * along * medium.z_real + real_least, real_least);
        mirrored = max(apart + 2.0 * along * medium.z_virtual + virtual_least, real_least);
    }
    let edges = edges_squared * (widening * shrinking);
    let all = beyond(real + edges.x, mirrored + edges.x);
    if endless { return all / shrinking; }
    return (all - beyond(real + edges.y, mirrored + edges.y)) / shrinking;
}
