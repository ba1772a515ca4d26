// Visibility: which share of each texel sees the sky along eight directions.

// Parallel views need no matrix: a point's place on the map and its depth are three affine functions.
struct Direction {
    // Of (x, y, z, 1) in mm: column and row of the map, the middle of the first texel at 0, and depth.
    column: vec4f,
    row: vec4f,
    depth: vec4f,
    to_sky: vec3f,
    // Width of a texel of the map, mm.
    texel: f32,
}

struct Directions {
    // Word of a texel that they fill.
    word: u32,
    padding0: u32,
    padding1: u32,
    padding2: u32,
    eight: array<Direction, 8>,
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
        for (var k = 0u; k < 8u; k++) { shares[k] += sees(receiver, k); }
        count += 1.0;
    }
    var word = 0u;
    for (var k = 0u; k < 8u; k++) {
        word |= u32(shares[k] / count * 15.0 + 0.5) << (4u * k);
    }
    visible[directions.word * lighting.texel_count + index] = word;
}

// As `lit_share` of one look, whose four texels blur as much as the sky needs.
fn sees(receiver: Receiver, k: u32) -> f32 {
    let cosine = dot(receiver.face, directions.eight[k].to_sky);
    if cosine <= 0.0 { return 0.0; }
    let width = directions.eight[k].texel;
    let lifted = vec4f(receiver.position + receiver.face * lift_height(width, receiver.tilt, 0.0), 1.0);
    let place = vec2f(dot(directions.eight[k].column, lifted), dot(directions.eight[k].row, lifted));
    // Along the plane depth changes by what it takes to come back to the plane in the direction of view.
    let across = vec2f(dot(directions.eight[k].column.xyz, receiver.face), dot(directions.eight[k].row.xyz, receiver.face));
    let slope = across * (-width * width * dot(directions.eight[k].depth.xyz, directions.eight[k].to_sky) / cosine);
    return lit_texels(place, dot(directions.eight[k].depth, lifted), slope, 0u);
}
