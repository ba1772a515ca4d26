// The texel's square as a receiver of light, and how much of it sees a view. The including module declares `lighting`, `texels`,
// `triangles`, `positions` and `normals`.

struct Texel {
    triangle: u32,
    barycentric_1: f32,
    barycentric_2: f32,
    // Rest area of the texel over that of its triangle.
    area_ratio: f32,
}

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
    receiver.half_width = 0.5 * sqrt(receiver.area);
    receiver.tangent = any_perpendicular(receiver.face);
    receiver.bitangent = cross(receiver.face, receiver.tangent);
    return receiver;
}

fn any_perpendicular(n: vec3f) -> vec3f {
    let axis = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(n.x) > 0.7);
    return safe_normalize(cross(axis, n), axis);
}

// Mean over side² points of the square. A triangle that faces away is in its own shadow.
fn lit_share(view: ShadowView, receiver: Receiver, to_light: vec3f, side: u32) -> f32 {
    if dot(receiver.face, to_light) <= 0.0 { return 0.0; }
    let lifted = lift(view, receiver.position, receiver.face, to_light, receiver.half_width);
    var lit = 0.0;
    let count = select(side, 1u, receiver.half_width == 0.0);
    for (var v = 0u; v < count; v++) {
        for (var u = 0u; u < count; u++) {
            let offset = (2.0 * vec2f(f32(u), f32(v)) + 1.0) / f32(count) - 1.0;
            lit += lit_at(view, lifted + (receiver.tangent * offset.x + receiver.bitangent * offset.y) * receiver.half_width);
        }
    }
    return lit / f32(count * count);
}
