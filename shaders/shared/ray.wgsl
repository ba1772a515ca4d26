// Rays through the body, whose surface is the sites' discs. The module declares `transport`, `nodes`, `site_positions` and `site_normals`.

// Further than any body is large, mm.
const FAR: f32 = 1e30;
const NO_SITE: u32 = 0xffffffffu;
// Discs that a ray grazes by less are not met.
const LEAST_COSINE: f32 = 0.02;

// A flat node is as thick as this share of its radius: rounding must not let rays through.
const FLATNESS: f32 = 0.01;

struct Crossing {
    // Along the ray, mm; FAR where there is none.
    t: f32,
    // Texel.
    site: u32,
}

// The first crossing beyond `begin` that leaves the body (side 1) or enters it (side −1).
fn first_crossing(origin: vec3f, direction: vec3f, begin: f32, side: f32) -> Crossing {
    return crossing(origin, direction, begin, FAR, side);
}

fn crossing(origin: vec3f, direction: vec3f, begin: f32, most: f32, side: f32) -> Crossing {
    var best = Crossing(most, NO_SITE);
    var level = transport.top_level;
    var node = 0u;
    loop {
        if level > 0u {
            if is_met(nodes[node_index(level, node)], origin, direction, begin, best.t) {
                level -= 1u;
                node *= 4u;
                continue;
            }
        } else {
            let place = site_positions[node];
            let normal = site_normals[node].xyz;
            let cosine = dot(normal, direction);
            if cosine * side > LEAST_COSINE {
                let offset = place.xyz - origin;
                let t = dot(offset, normal) / cosine;
                let beside = offset - direction * t;
                if t > begin && t < best.t && dot(beside, beside) < disc_reach_squared(place.w) { best = Crossing(t, node); }
            }
        }
        let next = passed(transport.site_count, transport.top_level, Step(level, node));
        level = next.level;
        node = next.node;
        if level == transport.top_level { break; }
    }
    if best.site == NO_SITE { best.t = FAR; }
    return best;
}

// Whether some of a ray lies in a node's ball and between its two planes.
fn is_met(node: Node, origin: vec3f, direction: vec3f, begin: f32, end: f32) -> bool {
    let offset = node.centre - origin;
    let along = dot(offset, direction);
    let away = offset - along * direction;
    let half2 = node.radius * node.radius - dot(away, away);
    if half2 <= 0.0 { return false; }
    let half = sqrt(half2);
    let up = dot(offset, node.axis);
    let rate = dot(direction, node.axis);
    let inverse = select(1.0, -1.0, rate < 0.0) / max(abs(rate), 1e-6);
    let middle = up * inverse;
    let between = (node.thickness + FLATNESS * node.radius) * abs(inverse);
    return min(min(along + half, middle + between), end) > max(max(along - half, middle - between), begin);
}

// Parts of a ray inside are followed so often.
const MOST_SEGMENTS: u32 = 4u;

// How much of a ray from outside is inside, mm.
fn way_inside(origin: vec3f, direction: vec3f, begin: f32, most: f32) -> f32 {
    var inside = 0.0;
    var t = begin;
    for (var k = 0u; k < MOST_SEGMENTS; k++) {
        let enters = first_crossing(origin, direction, t, -1.0).t;
        if enters >= most { break; }
        let leaves = min(first_crossing(origin, direction, enters, 1.0).t, most);
        // An edge of an open surface.
        if leaves == FAR { break; }
        inside += leaves - enters;
        t = leaves;
        if t >= most { break; }
    }
    return inside;
}
