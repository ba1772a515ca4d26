// Pattern: every texel collects from the same 57 places of the atlas around it, whatever lies there.
// Gong, Chen, Zhang, Zeng, Peng 2008, "GPU-based rendering for deformable translucent objects", The Visual Computer 24.

struct Pattern {
    table: KernelTable,
    texel_count: u32,
    // Width of the atlas.
    size: u32,
    // From one near sample to the next, and from the middle to the far ones, pixels.
    near_step: f32,
    far_step: f32,
    // What a sample stands for, mm²: every pixel is taken to hold the same area.
    near_area: f32,
    far_area: f32,
    padding0: u32,
    padding1: u32,
}

@group(0) @binding(0) var<uniform> pattern: Pattern;
@group(0) @binding(1) var<storage, read> texel_positions: array<vec4f>;
@group(0) @binding(2) var<storage, read> texel_irradiance: array<vec4f>;
// Row · size + column of each texel.
@group(0) @binding(3) var<storage, read> texel_pixels: array<u32>;
// One entry a pixel: its texel, or EMPTY.
@group(0) @binding(4) var<storage, read> pixels: array<u32>;
@group(0) @binding(5) var<storage, read_write> exitance: array<vec4f>;
@group(0) @binding(6) var kernel_table: texture_2d<f32>;
@group(0) @binding(7) var<storage, read> marks: array<u32>;

const EMPTY: u32 = 0xffffffffu;
// Samples along a side of the near grid, and of the ring around it.
const NEAR: u32 = 7u;
const FAR: u32 = 3u;

// What light at a place of the atlas sends to the receiver, and 1 where there is any surface.
fn collected(receiver: vec3f, place: vec2f, area: f32) -> vec4f {
    let corner = floor(place);
    if any(corner < vec2f(0.0)) || any(corner >= vec2f(f32(pattern.size))) { return vec4f(0.0); }
    let pixel = u32(corner.y) * pattern.size + u32(corner.x);
    let texel = pixels[pixel];
    if texel == EMPTY { return vec4f(0.0); }
    // Gutters repeat what is elsewhere, and the rim is no surface.
    let source = texel_positions[texel];
    if texel_pixels[texel] != pixel || source.w == 0.0 { return vec4f(0.0); }
    let offset = receiver - source.xyz;
    let power = texel_irradiance[texel].rgb * marked_tint(marks[texel]) * area;
    return vec4f(power * area_averaged_profile(pattern.table, kernel_table, dot(offset, offset), 0.0, 0.0), 1.0);
}

@compute @workgroup_size(64)
fn collect(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= pattern.texel_count { return; }
    let receiver = texel_positions[index].xyz;
    let pixel = texel_pixels[index];
    let centre = vec2f(f32(pixel % pattern.size), f32(pixel / pattern.size)) + 0.5;
    var sum = vec4f(0.0);
    for (var k = 0u; k < NEAR * NEAR; k++) {
        let steps = vec2f(f32(k % NEAR), f32(k / NEAR)) - f32(NEAR / 2u);
        sum += collected(receiver, centre + steps * pattern.near_step, pattern.near_area);
    }
    for (var k = 0u; k < FAR * FAR; k++) {
        let steps = vec2f(f32(k % FAR), f32(k / FAR)) - f32(FAR / 2u);
        if all(steps == vec2f(0.0)) { continue; }
        sum += collected(receiver, centre + steps * pattern.far_step, pattern.far_area);
    }
    exitance[index] = sum * vec4f(marked_tint(marks[index]), 1.0);
}
