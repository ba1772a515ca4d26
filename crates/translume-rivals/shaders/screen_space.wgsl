// Screen-space normalised diffusion: irradiance is drawn as the eye sees it and averaged over a disc of the picture (Golubev 2018, 2019), with the
// profile of Christensen and Burley 2015, and light that comes through by its way in a depth map.

// Whether light passes through the body at all.
override TRANSMISSION: bool = true;
// Whether the disc is turned by another angle at every pixel.
override ROTATE: bool = false;

struct Profile {
    // Of the surface.
    albedo: vec3f,
    sample_count: u32,
    // 1/d, 1/mm.
    shape: vec3f,
    padding0: u32,
    // Pixels per mm at a depth of 1 mm.
    focal: vec2f,
    padding1: u32,
    padding2: u32,
}

@group(0) @binding(1) var<uniform> profile: Profile;

struct Vertex {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
}

// ---- depth from a light

@vertex
fn from_light(@location(0) position: vec3f, @location(1) normal: vec3f, @builtin(instance_index) index: u32) -> @builtin(position) vec4f {
    return light_clip(scene.lights[index], position);
}

// ---- irradiance as the eye sees it

@group(0) @binding(2) var shadow_maps: texture_depth_2d_array;

struct Pixel {
    // Irradiance, and depth along the axis of view, mm; 0 where nothing is.
    @location(0) irradiance: vec4f,
    // F_t over π and over its mean.
    @location(1) exit: vec4f,
}

@vertex
fn from_eye(@location(0) position: vec3f, @location(1) normal: vec3f) -> Vertex {
    return Vertex(scene.view_projection * vec4f(position, 1.0), position, normal);
}

@fragment
fn light_up(in: Vertex) -> Pixel {
    let across = dpdx(in.position);
    let down = dpdy(in.position);
    let to_eye = normalize(scene.eye - in.position);
    let shading = normalize(in.normal);
    let crossed = normalize(cross(across, down));
    let face = select(-crossed, crossed, dot(crossed, shading) >= 0.0);
    var irradiance = vec3f(0.0);
    for (var k = 0u; k < scene.light_count; k++) {
        irradiance += arriving(k, in.position, shading, face, across, down);
    }
    let exit = scene.exit_scale * fresnel_transmittance(scene.eta, abs(dot(shading, to_eye)));
    return Pixel(vec4f(irradiance, 1.0 / in.clip.w), vec4f(exit, 0.0, 0.0, 0.0));
}

fn arriving(index: u32, position: vec3f, normal: vec3f, face: vec3f, across: vec3f, down: vec3f) -> vec3f {
    let light = scene.lights[index];
    let direction = to_light(light, position);
    let offset = light.origin - position;
    let strength = light.colour / mix(1.0, max(dot(offset, offset), 1e-12), light.perspective);
    let cosine = dot(normal, direction);
    var irradiance = vec3f(0.0);
    if cosine > 0.0 && enters(light, position) {
        var lit = 1.0;
        if light.shadow > 0.0 { lit = lit_share(index, position, normal, face, across, down); }
        irradiance = strength * (lit * cosine * fresnel_transmittance(scene.eta, cosine));
    }
    if TRANSMISSION && cosine < 0.0 && enters(light, position) {
        // The far side is taken to face the light as this one faces away from it.
        irradiance += strength * transmitted(thickness(index, position, face)) * (-cosine * fresnel_transmittance(scene.eta, -cosine));
    }
    return irradiance;
}

// ∫ 2πr R(√(r² + d²)) dr over the albedo, for a thickness d, mm.
fn transmitted(d: f32) -> vec3f {
    let third = exp(profile.shape * (-d / 3.0));
    return 0.25 * third * (third * third + 3.0);
}

// How far light went from where it entered, mm: the mean of the four nearest texels.
fn thickness(index: u32, position: vec3f, face: vec3f) -> f32 {
    let light = scene.lights[index];
    // Off the outline by a texel, where the map shows what lies behind.
    let width = f32(textureDimensions(shadow_maps).x);
    let depth = in_light(light, position).z;
    let texel = 2.0 * light.half_width * mix(1.0, depth, light.perspective) / width;
    let clip = light_clip(light, position - face * texel);
    let place = map_place(clip.xy / clip.w) * width - 0.5;
    let first = vec2i(floor(place));
    let share = place - floor(place);
    let near = vec2f(way(index, first), way(index, first + vec2i(1, 0)));
    let far = vec2f(way(index, first + vec2i(0, 1)), way(index, first + vec2i(1, 1)));
    let rows = mix(near, far, vec2f(share.y));
    let entered = mix(rows.x, rows.y, share.x);
    // Along the ray of a point light depth grows with the cosine to its axis.
    let slant = mix(1.0, depth / max(length(position - light.origin), 1e-12), light.perspective);
    return max(depth - entered, 0.0) / slant;
}

// Depth of a texel, mm.
fn way(index: u32, texel: vec2i) -> f32 {
    let light = scene.lights[index];
    let stored = textureLoad(shadow_maps, texel, index, 0);
    let span = light.far - light.near;
    if light.perspective == 0.0 { return light.near + stored * span; }
    return light.near * light.far / (light.far - stored * span);
}

// The share of the pixel's surface that sees the light: four points of it, each by the four nearest texels, compared with the plane of the triangle.
fn lit_share(index: u32, position: vec3f, normal: vec3f, face: vec3f, across: vec3f, down: vec3f) -> f32 {
    let light = scene.lights[index];
    let direction = to_light(light, position);
    if dot(face, direction) <= 0.0 { return 0.0; }
    let width = f32(textureDimensions(shadow_maps).x);
    let depth = in_light(light, position).z;
    let reach = 1.4142136 * 2.0 * light.half_width * mix(1.0, depth, light.perspective) / width;
    let tilt = length(cross(normal, face)) / max(dot(normal, face), 0.2);
    let lifted = position + face * (0.1 * reach + 1.25 * tilt * reach);
    let slope = depth_slope(light, lifted, face) * vec2f(2.0, -2.0) / width;
    var lit = 0.0;
    for (var k = 0; k < 4; k++) {
        let part = vec2f(f32(k & 1), f32(k >> 1u)) * 0.5 - 0.25;
        let clip = light_clip(light, lifted + across * part.x + down * part.y);
        let ndc = clip.xyz / clip.w;
        lit += 0.25 * lit_texels(index, map_place(ndc.xy) * width - 0.5, ndc.z, slope);
    }
    return lit;
}

fn lit_texels(index: u32, place: vec2f, here: f32, slope: vec2f) -> f32 {
    let base = floor(place);
    let share = place - base;
    let first = vec2i(base);
    let depth = here - dot(slope, share);
    let a = f32(textureLoad(shadow_maps, first, index, 0) >= depth);
    let b = f32(textureLoad(shadow_maps, first + vec2i(1, 0), index, 0) >= depth + slope.x);
    let c = f32(textureLoad(shadow_maps, first + vec2i(0, 1), index, 0) >= depth + slope.y);
    let d = f32(textureLoad(shadow_maps, first + vec2i(1, 1), index, 0) >= depth + slope.x + slope.y);
    return mix(mix(a, b, share.x), mix(c, d, share.x), share.y);
}

// Depth per unit of normalised device coordinates over the plane of a triangle.
fn depth_slope(light: Light, point: vec3f, face: vec3f) -> vec2f {
    let axis = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(face.x) > 0.7);
    let tangent = normalize(cross(axis, face));
    let clip = light_clip(light, point);
    let t = light_clip(light, point + tangent) - clip;
    let b = light_clip(light, point + cross(face, tangent)) - clip;
    let along_t = t.xyz * clip.w - clip.xyz * t.w;
    let along_b = b.xyz * clip.w - clip.xyz * b.w;
    let area = along_t.x * along_b.y - along_t.y * along_b.x;
    if area == 0.0 { return vec2f(0.0); }
    return vec2f(along_t.z * along_b.y - along_t.y * along_b.z, along_t.x * along_b.z - along_t.z * along_b.x) / area;
}

// ---- the average

@group(0) @binding(3) var irradiances: texture_2d<f32>;
@group(0) @binding(4) var exits: texture_2d<f32>;
// Offset in the plane of the picture, its length, mm, and 1 over the density of the widest channel.
@group(0) @binding(5) var<storage, read> samples: array<vec4f>;

@vertex
fn whole(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn blur(@builtin(position) place: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(place.xy);
    let centre = textureLoad(irradiances, pixel, 0);
    if centre.a == 0.0 { return vec4f(0.0); }
    var turned = vec2f(1.0, 0.0);
    if ROTATE {
        let angle = 6.2831853 * interleaved_noise(place.xy);
        turned = vec2f(cos(angle), sin(angle));
    }
    let pixels_per_mm = profile.focal / centre.a;
    let size = vec2i(textureDimensions(irradiances));
    var sum = vec3f(0.0);
    var total = vec3f(0.0);
    for (var k = 0u; k < profile.sample_count; k++) {
        let s = samples[k];
        let offset = vec2f(s.x * turned.x - s.y * turned.y, s.x * turned.y + s.y * turned.x);
        let at = vec2i(floor(place.xy + offset * pixels_per_mm));
        if any(at < vec2i(0)) || any(at >= size) { continue; }
        let found = textureLoad(irradiances, at, 0);
        // What lies beside the body has no depth.
        if found.a > 0.0 {
            let apart = found.a - centre.a;
            let weight = polar(sqrt(s.z * s.z + apart * apart)) * s.w;
            sum += weight * found.rgb;
            total += weight;
        }
    }
    let exit = textureLoad(exits, pixel, 0).x;
    return vec4f(profile.albedo * sum / max(total, vec3f(1e-30)) * exit, 1.0);
}

// 2πr·R(r) over the albedo, up to a factor: what a ring of radius r holds.
fn polar(r: f32) -> vec3f {
    let third = exp(profile.shape * (-r / 3.0));
    return profile.shape * third * (third * third + 1.0);
}

// Jimenez 2014, "Next Generation Post Processing in Call of Duty: Advanced Warfare".
fn interleaved_noise(place: vec2f) -> f32 {
    return fract(52.9829189 * fract(dot(place, vec2f(0.06711056, 0.00583715))));
}
