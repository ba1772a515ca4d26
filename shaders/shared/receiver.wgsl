// Points of a texel as receivers of light, and how much of their surroundings sees a view. The including module declares `lighting`,
// `texels`, `triangles`, `positions` and `normals`.

const POINTS: u32 = 4u;
const NOWHERE: u32 = 0xffffffffu;

struct Texel {
    triangle: u32,
    barycentric_1: f32,
    barycentric_2: f32,
    // Rest area of the texel over that of its triangle.
    area_ratio: f32,
    points: array<LightPoint, 4>,
}

// The middle of a quarter of the texel.
struct LightPoint {
    // NOWHERE where no triangle lies there.
    triangle: u32,
    // Weights of the second and third corner, 16 bits each.
    weights: u32,
}

struct Receiver {
    position: vec3f,
    // Shading normal.
    normal: vec3f,
    // Normal of the triangle itself: shadows follow the geometry.
    face: vec3f,
    // Half the side of its quarter of the texel, mm; 0 on the rim.
    half_width: f32,
    tangent: vec3f,
    bitangent: vec3f,
}

// weights: of the triangle's second and third corner
fn receiver_at(triangle: u32, weights: vec2f, half_width: f32) -> Receiver {
    let a = triangles[triangle * 3u];
    let b = triangles[triangle * 3u + 1u];
    let c = triangles[triangle * 3u + 2u];
    let pa = positions[a].xyz;
    let side_1 = positions[b].xyz - pa;
    let side_2 = positions[c].xyz - pa;
    let smooth_normal = normals[a].xyz * (1.0 - weights.x - weights.y) + normals[b].xyz * weights.x + normals[c].xyz * weights.y;
    var receiver: Receiver;
    receiver.position = pa + side_1 * weights.x + side_2 * weights.y;
    receiver.normal = safe_normalize(smooth_normal, normals[a].xyz);
    receiver.face = safe_normalize(cross(side_1, side_2) * lighting.winding, receiver.normal);
    receiver.normal = select(receiver.normal, receiver.face, lighting.flat_normals == 1u);
    receiver.half_width = half_width;
    receiver.tangent = any_perpendicular(receiver.face);
    receiver.bitangent = cross(receiver.face, receiver.tangent);
    return receiver;
}

// Mean over side² points of the quarter. A triangle that faces away is in its own shadow.
fn lit_share(view: ShadowView, receiver: Receiver, to_light: vec3f, side: u32) -> f32 {
    if dot(receiver.face, to_light) <= 0.0 { return 0.0; }
    let lifted = lift(view, receiver.position, receiver.face, 0.25 * lighting.texel_width);
    let slope = depth_slope(view, lifted, receiver.tangent, receiver.bitangent);
    var lit = 0.0;
    for (var v = 0u; v < side; v++) {
        for (var u = 0u; u < side; u++) {
            let offset = (2.0 * vec2f(f32(u), f32(v)) + 1.0) / f32(side) - 1.0;
            lit += lit_at(view, lifted + (receiver.tangent * offset.x + receiver.bitangent * offset.y) * receiver.half_width, slope);
        }
    }
    return lit / f32(side * side);
}
