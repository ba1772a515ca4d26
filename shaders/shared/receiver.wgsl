// The texel's square as a receiver of light, and how much of it sees a view. The including module declares `lighting`, `texels`,
// `triangles`, `positions` and `normals`.

struct Texel {
    triangle: u32,
    barycentric_1: f32,
    barycentric_2: f32,
    // Rest area of the texel over that of its triangle.
    area_ratio: f32,
    // Change of the two weights over the width and the height of a texel.
    per_column: vec2f,
    per_row: vec2f,
}

struct Receiver {
    position: vec3f,
    // Shading normal.
    normal: vec3f,
    // Normal of the triangle itself: shadows follow the geometry.
    face: vec3f,
    // Half the side of the texel's square, mm.
    half_width: f32,
    // The texel's square: weights of its middle, and its sides on the surface, mm.
    weights: vec2f,
    per_column: vec2f,
    per_row: vec2f,
    corner: vec3f,
    side_1: vec3f,
    side_2: vec3f,
    partial: bool,
    // Where the texel's centre lies, which may be beyond its triangle, and its live area, mm².
    center: vec3f,
    area: f32,
}

fn receiver_at(index: u32) -> Receiver {
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
    let smooth_normal = safe_normalize(normals[a].xyz * inside.x + normals[b].xyz * inside.y + normals[c].xyz * inside.z, normals[a].xyz);
    var receiver: Receiver;
    receiver.position = pa * inside.x + pb * inside.y + pc * inside.z;
    receiver.center = pa * weights.x + pb * weights.y + pc * weights.z;
    receiver.face = safe_normalize(doubled * lighting.winding, smooth_normal);
    receiver.normal = select(smooth_normal, receiver.face, lighting.flat_normals == 1u);
    receiver.area = texel.area_ratio * 0.5 * length(doubled);
    let column = (pb - pa) * texel.per_column.x + (pc - pa) * texel.per_column.y;
    let row = (pb - pa) * texel.per_row.x + (pc - pa) * texel.per_row.y;
    let square = length(cross(column, row));
    receiver.half_width = 0.5 * sqrt(square);
    receiver.weights = vec2f(texel.barycentric_1, texel.barycentric_2);
    receiver.per_column = texel.per_column;
    receiver.per_row = texel.per_row;
    receiver.corner = pa;
    receiver.side_1 = pb - pa;
    receiver.side_2 = pc - pa;
    receiver.partial = receiver.area < 0.98 * square;
    return receiver;
}

// Mean over side² points of the square. A triangle that faces away is in its own shadow.
fn lit_share(view: ShadowView, receiver: Receiver, to_light: vec3f, side: u32) -> f32 {
    if dot(receiver.face, to_light) <= 0.0 { return 0.0; }
    let lifted = lift(view, receiver.position, receiver.face, receiver.half_width);
    let slope = depth_slope(view, lifted, receiver.side_1, receiver.side_2);
    let up = lifted - receiver.position;
    var lit = 0.0;
    let count = select(side, 1u, receiver.half_width == 0.0);
    for (var v = 0u; v < count; v++) {
        for (var u = 0u; u < count; u++) {
            let offset = (vec2f(f32(u), f32(v)) + 0.5) / f32(count) - 0.5;
            var w = receiver.weights + receiver.per_column * offset.x + receiver.per_row * offset.y;
            if receiver.partial { w = clamped(w); }
            lit += lit_at(view, receiver.corner + receiver.side_1 * w.x + receiver.side_2 * w.y + up, slope);
        }
    }
    return lit / f32(count * count);
}

// Weights of the second and third corner moved into the triangle.
fn clamped(w: vec2f) -> vec2f {
    let all = max(vec3f(1.0 - w.x - w.y, w.x, w.y), vec3f(0.0));
    return all.yz / (all.x + all.y + all.z);
}
