// Sites: discs, summed up their tree, four to one, by area: middles, extents, and bounds for rays.

@group(0) @binding(0) var<uniform> level: Level;
@group(0) @binding(1) var<storage, read> site_positions: array<vec4f>;
@group(0) @binding(2) var<storage, read> site_normals: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> nodes: array<Node>;
// Centres and sizes, first of all sources, then of all receivers above the sites.
@group(0) @binding(4) var<storage, read_write> bounds: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> shapes: array<Shape>;
@group(0) @binding(6) var<uniform> transport: Transport;

// Where normals cancel, moments say less of what a cluster sends: sums take it to be larger by so much of what is lost of its mean normal, squared.
const MIXED: f32 = 2.0;

// Rays meet a disc within its own half diagonal or that of a usual one.
fn disc_node(index: u32) -> Node {
    let place = site_positions[index];
    let reach = sqrt(disc_reach_squared(place.w));
    return Node(place.xyz, reach, normalize(site_normals[index].xyz), 0.0, place.xyz, 0.0, 0.0, 1.0, 0.0, 0.0);
}

@compute @workgroup_size(64)
fn from_discs(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let node = item_index(group, groups, local);
    if node >= level.node_count { return; }
    var children: array<Node, 4>;
    for (var k = 0u; k < 4u; k++) {
        let site = node * 4u + k;
        if site < level.child_count {
            let area = site_positions[site].w;
            let normal = site_normals[site].xyz;
            children[k] = disc_node(site);
            bounds[site] = vec4f(site_positions[site].xyz, select(0.0, NO_SIZE, area > 0.0));
            let moments = packed_moments(disc_moments(normalize(normal)));
            shapes[site] = Shape(normal, disc_spread(area), moments, area, vec3u(0u), NO_SIZE);
        }
    }
    store(node, &children);
}

@compute @workgroup_size(64)
fn from_clusters(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let node = item_index(group, groups, local);
    if node >= level.node_count { return; }
    var children: array<Node, 4>;
    for (var k = 0u; k < 4u; k++) {
        if node * 4u + k < level.child_count { children[k] = nodes[level.child_offset + node * 4u + k]; }
    }
    store(node, &children);
}

fn store(node: u32, children: ptr<function, array<Node, 4>>) {
    let count = min(level.child_count - node * 4u, 4u);
    var area = 0.0;
    var sites = 0.0;
    for (var k = 0u; k < count; k++) {
        area += shapes[level.child_sources + node * 4u + k].area;
        sites += (*children)[k].sites;
    }
    var own: Node;
    own.sites = sites;
    var normal = vec3f(0.0);
    var weights = vec4f(0.0);
    for (var k = 0u; k < count; k++) {
        let shape = shapes[level.child_sources + node * 4u + k];
        weights[k] = 1.0 / f32(count);
        if area > 0.0 { weights[k] = shape.area / area; }
        own.centre += (*children)[k].centre * weights[k];
        own.middle += (*children)[k].middle * ((*children)[k].sites / sites);
        normal += shape.normal * weights[k];
    }
    own.axis = safe_normalize(normal, (*children)[0].axis);
    var sum = Moments(vec3f(0.0), vec3f(0.0));
    var turns = Moments(vec3f(0.0), vec3f(0.0));
    var receiving = 0.0;
    for (var k = 0u; k < count; k++) {
        let child = (*children)[k];
        let shape = shapes[level.child_sources + node * 4u + k];
        let offset = child.centre - own.centre;
        let m = unpacked_moments(shape.moments);
        let square = shape.spread * shape.spread;
        sum.diagonal += weights[k] * (square * m.diagonal + offset * offset);
        sum.mixed += weights[k] * (square * m.mixed + offset.xxy * offset.yzz);
        own.radius = max(own.radius, length(offset) + child.radius);
        own.thickness = max(own.thickness, abs(dot(offset, own.axis)) + extent_along(child, own.axis));
        let t = unpacked_moments(shape.turns);
        let n = shape.normal;
        turns.diagonal += weights[k] * (shape.spread * t.diagonal + n * offset);
        turns.mixed += weights[k] * (shape.spread * t.mixed + 0.5 * (n.xxy * offset.yzz + n.yzz * offset.xxy));
        let apart = child.middle - own.middle;
        receiving += child.sites / sites * (child.scatter * child.scatter + dot(apart, apart));
        own.reach = max(own.reach, length(apart) + child.reach);
    }
    own.scatter = sqrt(receiving);
    let trace = sum.diagonal.x + sum.diagonal.y + sum.diagonal.z;
    let spread = sqrt(trace);
    let scale = select(0.0, 1.0 / trace, trace > 0.0);
    let moments = packed_moments(Moments(scale * sum.diagonal, scale * sum.mixed));
    let unit = select(0.0, 1.0 / spread, spread > 0.0);
    let turning = packed_moments(Moments(unit * turns.diagonal, unit * turns.mixed));
    nodes[level.node_offset + node] = own;
    let size = select(0.0, max(size_of(spread, own.radius), NO_SIZE), area > 0.0);
    let mixed = max(1.0 - dot(normal, normal), 0.0);
    shapes[level.source_offset + node] = Shape(normal, spread, moments, area, turning, size);
    bounds[level.source_offset + node] = vec4f(own.centre, size * (1.0 + MIXED * mixed));
    bounds[level.receiver_offset + node] = vec4f(own.middle, size_of(own.scatter, own.reach));
}
