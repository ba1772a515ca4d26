// Fan: rays from one place into several directions, followed together, for most nodes that one of them has to look at another has to look at, too. The module
// declares what `ray.wgsl` wants.

// Rays, four at a time.
const FANS: u32 = 2u;
const RAYS: u32 = 4u * FANS;

struct Fan {
    // Directions, component by component.
    x: array<vec4f, FANS>,
    y: array<vec4f, FANS>,
    z: array<vec4f, FANS>,
    // 1, or 0 of a ray that met the body.
    open: array<vec4f, FANS>,
}

fn point(fan: ptr<function, Fan>, ray: u32, direction: vec3f) {
    (*fan).x[ray / 4u][ray % 4u] = direction.x;
    (*fan).y[ray / 4u][ray % 4u] = direction.y;
    (*fan).z[ray / 4u][ray % 4u] = direction.z;
    (*fan).open[ray / 4u][ray % 4u] = 1.0;
}

fn along(fan: ptr<function, Fan>, k: u32, v: vec3f) -> vec4f {
    return (*fan).x[k] * v.x + (*fan).y[k] * v.y + (*fan).z[k] * v.z;
}

// Share of rays that enter the body beyond `begin`. None points below the plane through their origin.
fn share_that_enters(fan: ptr<function, Fan>, origin: vec3f, normal: vec3f, begin: f32) -> f32 {
    var level = transport.top_level;
    var node = 0u;
    loop {
        if level > 0u {
            if is_met_by_any(fan, nodes[node_index(level, node)], origin, normal, begin) {
                level -= 1u;
                node *= 4u;
                continue;
            }
        } else {
            meet(fan, node, origin, begin);
        }
        let next = passed(transport.site_count, transport.top_level, Step(level, node));
        level = next.level;
        node = next.node;
        if level == transport.top_level { break; }
    }
    var open = 0.0;
    for (var k = 0u; k < FANS; k++) { open += dot((*fan).open[k], vec4f(1.0)); }
    return 1.0 - open / f32(RAYS);
}

// As `is_met`, of rays that are still open.
fn is_met_by_any(fan: ptr<function, Fan>, node: Node, origin: vec3f, normal: vec3f, begin: f32) -> bool {
    let offset = node.centre - origin;
    if dot(offset, normal) + extent_along(node, normal) <= 0.0 { return false; }
    let up = dot(offset, node.axis);
    let thickness = node.thickness + FLATNESS * node.radius;
    let short = node.radius * node.radius - dot(offset, offset);
    var is_met = false;
    for (var k = 0u; k < FANS; k++) {
        let nearest = along(fan, k, offset);
        let half2 = short + nearest * nearest;
        let half = sqrt(max(half2, vec4f(0.0)));
        let rate = along(fan, k, node.axis);
        let inverse = select(vec4f(1.0), vec4f(-1.0), rate < vec4f(0.0)) / max(abs(rate), vec4f(1e-6));
        let middle = up * inverse;
        let between = thickness * abs(inverse);
        let first = max(max(nearest - half, middle - between), vec4f(begin));
        let last = min(nearest + half, middle + between);
        is_met |= any(((*fan).open[k] > vec4f(0.0)) & (half2 > vec4f(0.0)) & (last > first));
    }
    return is_met;
}

fn meet(fan: ptr<function, Fan>, site: u32, origin: vec3f, begin: f32) {
    let place = site_positions[site];
    let normal = site_normals[site].xyz;
    let offset = place.xyz - origin;
    let up = dot(offset, normal);
    let square = dot(offset, offset);
    let reach = disc_reach_squared(place.w);
    for (var k = 0u; k < FANS; k++) {
        let cosine = along(fan, k, normal);
        let t = up / min(cosine, vec4f(-LEAST_COSINE));
        let beside = square + t * (t - 2.0 * along(fan, k, offset));
        let enters = (cosine < vec4f(-LEAST_COSINE)) & (t > vec4f(begin)) & (beside < vec4f(reach));
        (*fan).open[k] = select((*fan).open[k], vec4f(0.0), enters);
    }
}
