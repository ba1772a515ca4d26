// Visibility: which share of each texel sees the sky along eight directions.

struct Directions {
    // Word of a texel that they fill.
    word: u32,
    padding0: u32,
    padding1: u32,
    padding2: u32,
    views: array<ShadowView, 8>,
}

@group(0) @binding(0) var<uniform> lighting: Gather;
@group(0) @binding(1) var<storage, read> texels: array<Texel>;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;
@group(0) @binding(3) var<storage, read> positions: array<vec4f>;
@group(0) @binding(4) var<storage, read> normals: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> visible: array<u32>;
@group(0) @binding(6) var shadow_maps: texture_depth_2d_array;
@group(0) @binding(7) var<uniform> directions: Directions;

@compute @workgroup_size(64)
fn visibility(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= lighting.texel_count { return; }
    let texel = texels[index];
    var shares = array<f32, 8>();
    var count = 0.0;
    for (var p = 0u; p < POINTS; p++) {
        let point = texel.points[p];
        if point.triangle == NOWHERE { continue; }
        let receiver = receiver_at(point.triangle, unpack2x16unorm(point.weights), 0.0);
        for (var k = 0u; k < 8u; k++) {
            shares[k] += lit_share(directions.views[k], receiver, lighting.sky[directions.word * 8u + k].direction, 1u);
        }
        count += 1.0;
    }
    var word = 0u;
    for (var k = 0u; k < 8u; k++) {
        word |= u32(shares[k] / count * 15.0 + 0.5) << (4u * k);
    }
    visible[directions.word * lighting.texel_count + index] = word;
}
