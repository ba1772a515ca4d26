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
    // Half the side of the square that a shadow is averaged over, mm; 0 on the rim.
    half_width: f32,
    // Tangent of the angle between triangle and shading normal: how steeply the surface leaves the plane of the triangle hereabouts.
    tilt: f32,
    tangent: vec3f,
    bitangent: vec3f,
}

// weights: of the triangle's second and third corner      area: of the texel, mm²; 0 on the rim
fn receiver_at(triangle: u32, weights: vec2f, area: f32) -> Receiver {
    let a = triangles[triangle * 3u];
    let b = triangles[triangle * 3u + 1u];
    let c = triangles[triangle * 3u + 2u];
    let pa = positions[a].xyz;
    let side_1 = positions[b].xyz - pa;
    let side_2 = positions[c].xyz - pa;
    let smooth_normal = normals[a].xyz * (1.0 - weights.x - weights.y) + normals[b].xyz * weights.x + normals[c].xyz * weights.y;
    var receiver: Receiver;
    receiver.position = pa + side_1 * weights.x + side_2 * weights.y;
    let smooth_unit = safe_normalize(smooth_normal, normals[a].xyz);
    let doubled = cross(side_1, side_2);
    receiver.face = safe_normalize(doubled * lighting.winding, smooth_unit);
    receiver.tilt = tangent_between(smooth_unit, receiver.face);
    receiver.normal = select(smooth_unit, receiver.face, lighting.flat_normals == 1u);
    // A quarter of the texel, but no more than its triangle can stand for: beyond that the surface goes elsewhere.
    receiver.half_width = 0.25 * sqrt(min(area, 0.5 * length(doubled)));
    receiver.tangent = any_perpendicular(receiver.face);
    receiver.bitangent = cross(receiver.face, receiver.tangent);
    return receiver;
}

// Mean over side² points of the square. A triangle that faces away is in its own shadow.
fn lit_share(view: ShadowView, receiver: Receiver, to_light: vec3f, side: u32) -> f32 {
    if dot(receiver.face, to_light) <= 0.0 { return 0.0; }
    let lifted = lift(view, receiver.position, receiver.face, receiver.tilt, receiver.half_width);
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
