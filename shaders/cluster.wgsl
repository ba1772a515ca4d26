// Cluster: the texels summed up their tree, four to one. Level 0 is the texels themselves.

// Which texels are needed as receivers.
struct Need {
    // Millimetres to clip space.
    view_projection: mat4x4f,
    // Millimetres.
    eye: vec3f,
    kind: u32,
}
const IN_VIEW: u32 = 1u;
const FACING: u32 = 2u;
const UNDER_VERTICES: u32 = 4u;
// Receivers are not the middles of texels but points anywhere on them.
const POINTS: u32 = 8u;
// From the middle of a square to its corner, over the rms radius of a disc of the same area.
const CORNER: f32 = 1.7724539;
// A picture blends a texel with its neighbours, so those count too that lie up to so many of their radii outside the picture, or are turned away
// from the eye by no more than twice the angle between the normals of their group, and by that between those and their triangles.
const BORDER: f32 = 8.0;
// For rounding.
const SLACK: f32 = 0.02;

@group(0) @binding(0) var<uniform> level: Level;
@group(0) @binding(1) var<storage, read> texel_positions: array<vec4f>;
// In w the cosine of how far triangles lean from the normal.
@group(0) @binding(2) var<storage, read> texel_normals: array<vec4f>;
@group(0) @binding(3) var<storage, read> texel_irradiance: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> clusters: array<Cluster>;
@group(0) @binding(5) var<storage, read_write> receivers: array<Receiver>;
// Centres and sizes: first of all sources, from the texels up, dark ones with size 0; then of all receivers above the texels.
@group(0) @binding(6) var<storage, read_write> bounds: array<vec4f>;
// What the sources of `bounds` send, in their order.
@group(0) @binding(7) var<storage, read_write> lamps: array<Lamp>;
@group(0) @binding(8) var<uniform> need: Need;
@group(0) @binding(9) var<storage, read> marks: array<u32>;

fn is_needed(index: u32, place: vec3f, spread: f32) -> bool {
    if (need.kind & UNDER_VERTICES) != 0u && (marks[index] & VERTEX_MARK) == 0u { return false; }
    if (need.kind & IN_VIEW) == 0u { return true; }
    // How far clip coordinates change over the border, at most.
    let m = transpose(need.view_projection);
    let border = BORDER * spread;
    let clip = need.view_projection * vec4f(place, 1.0);
    let reach = clip.w + border * length(m[3].xyz);
    return reach > 0.0
        && abs(clip.x) <= reach + border * length(m[0].xyz)
        && abs(clip.y) <= reach + border * length(m[1].xyz);
}

// Whether any texel of a group, or beside it, may be seen from in front.
fn is_facing(first: u32, count: u32) -> bool {
    if (need.kind & FACING) == 0u { return true; }
    var sum = vec3f(0.0);
    for (var k = 0u; k < count; k++) { sum += texel_normals[first + k].xyz; }
    // Both sides of a sheet in one group.
    if !(dot(sum, sum) > 0.25) { return true; }
    let mean = normalize(sum);
    var least = 1.0;
    var leaning = 1.0;
    for (var k = 0u; k < count; k++) {
        least = min(least, dot(mean, texel_normals[first + k].xyz));
        leaning = min(leaning, texel_normals[first + k].w);
    }
    let beyond = 2.0 * acos(clamp(least, -1.0, 1.0)) + acos(clamp(leaning, -1.0, 1.0)) + SLACK;
    if !(beyond < 1.5) { return true; }
    let to_eye = need.eye - texel_positions[first].xyz;
    return dot(to_eye, mean) >= -sin(beyond) * length(to_eye);
}

fn texel_cluster(index: u32) -> Cluster {
    let place = texel_positions[index];
    return Cluster(place.xyz, disc_spread(place.w), texel_irradiance[index].rgb * marked_tint(marks[index]) * place.w, 0.0, texel_normals[index].xyz, place.w);
}

@compute @workgroup_size(64)
fn from_texels(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let node = item_index(group, groups, local);
    if node >= level.node_count { return; }
    var children: array<Cluster, 4>;
    var receiving: array<Receiver, 4>;
    for (var k = 0u; k < 4u; k++) {
        if node * 4u + k < level.child_count {
            children[k] = texel_cluster(node * 4u + k);
            let needed = is_needed(node * 4u + k, children[k].centroid, children[k].spread);
            let extent = select(0.0, children[k].spread, (need.kind & POINTS) != 0u);
            receiving[k] = Receiver(children[k].centroid, extent, CORNER * extent, select(0u, 1u, needed), 0u, 0u);
            bounds[node * 4u + k] = vec4f(children[k].centroid, select(0.0, NO_SIZE, any(children[k].power > vec3f(0.0))));
            lamps[node * 4u + k] = Lamp(children[k].power, NEIGHBOUR_NARROWING * children[k].spread, children[k].normal, marks[node * 4u + k], packed_moments(disc_moments(children[k].normal)), 0u);
        }
    }
    let count = min(level.child_count - node * 4u, 4u);
    if !is_facing(node * 4u, count) {
        for (var k = 0u; k < 4u; k++) { receiving[k].texels = 0u; }
    }
    store(node, &children, count, merge_receivers(&receiving));
}

@compute @workgroup_size(64)
fn from_clusters(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let node = item_index(group, groups, local);
    if node >= level.node_count { return; }
    var children: array<Cluster, 4>;
    var receiving: array<Receiver, 4>;
    for (var k = 0u; k < 4u; k++) {
        if node * 4u + k < level.child_count {
            children[k] = clusters[level.child_offset + node * 4u + k];
            receiving[k] = receivers[level.child_offset + node * 4u + k];
        }
    }
    store(node, &children, min(level.child_count - node * 4u, 4u), merge_receivers(&receiving));
}

fn store(node: u32, children: ptr<function, array<Cluster, 4>>, count: u32, receiver: Receiver) {
    let weights = weigh(children, count);
    let cluster = merge(children, count, weights);
    clusters[level.node_offset + node] = cluster;
    receivers[level.node_offset + node] = receiver;
    let size = select(0.0, max(size_of(cluster.spread, cluster.radius), NO_SIZE), any(cluster.power > vec3f(0.0)));
    bounds[level.source_offset + node] = vec4f(cluster.centroid, size);
    lamps[level.source_offset + node] = Lamp(cluster.power, cluster.spread, cluster.normal, mean_scale(node, weights), packed_moments(moments(node, cluster, children, weights)), 0u);
    let extent = select(NOT_NEEDED, size_of(receiver.spread, receiver.radius), receiver.texels > 0u);
    bounds[level.receiver_offset + node] = vec4f(receiver.centre, extent);
}

// Second moments of a cluster over spread².
fn moments(node: u32, cluster: Cluster, children: ptr<function, array<Cluster, 4>>, weights: vec4f) -> Moments {
    var sum = Moments(vec3f(0.0), vec3f(0.0));
    for (var k = 0u; k < 4u; k++) {
        if weights[k] == 0.0 { continue; }
        let own = unpacked_moments(lamps[level.child_sources + node * 4u + k].moments);
        let offset = (*children)[k].centroid - cluster.centroid;
        let spread = (*children)[k].spread;
        sum.diagonal += weights[k] * (spread * spread * own.diagonal + offset * offset);
        sum.mixed += weights[k] * (spread * spread * own.mixed + offset.xxy * offset.yzz);
    }
    let trace = sum.diagonal.x + sum.diagonal.y + sum.diagonal.z;
    let scale = select(0.0, 1.0 / trace, trace > 0.0);
    return Moments(scale * sum.diagonal, scale * sum.mixed);
}

// How far light wanders from a cluster.
fn mean_scale(node: u32, weights: vec4f) -> u32 {
    var sum = 0.0;
    for (var k = 0u; k < 4u; k++) {
        if weights[k] > 0.0 { sum += weights[k] * marked_scale(lamps[level.child_sources + node * 4u + k].marks); }
    }
    return scale_mark(sum / dot(weights, vec4f(1.0)));
}

// Children weigh by their power; where none has any, by area; where none has that either, equally.
fn weigh(children: ptr<function, array<Cluster, 4>>, count: u32) -> vec4f {
    var total = 0.0;
    var area = 0.0;
    for (var k = 0u; k < count; k++) {
        total += dot((*children)[k].power, vec3f(1.0));
        area += (*children)[k].area;
    }
    var weights = vec4f(0.0);
    for (var k = 0u; k < count; k++) {
        weights[k] = 1.0;
        if total > 0.0 { weights[k] = dot((*children)[k].power, vec3f(1.0)) / total; }
        else if area > 0.0 { weights[k] = (*children)[k].area / area; }
    }
    return weights;
}

fn merge(children: ptr<function, array<Cluster, 4>>, count: u32, weights: vec4f) -> Cluster {
    var power = vec3f(0.0);
    var area = 0.0;
    for (var k = 0u; k < count; k++) {
        power += (*children)[k].power;
        area += (*children)[k].area;
    }
    let sum = dot(weights, vec4f(1.0));
    var centroid = vec3f(0.0);
    var normal = vec3f(0.0);
    for (var k = 0u; k < count; k++) {
        centroid += (*children)[k].centroid * (weights[k] / sum);
        normal += (*children)[k].normal * weights[k];
    }
    var spread_squared = 0.0;
    var radius = 0.0;
    for (var k = 0u; k < count; k++) {
        let offset = (*children)[k].centroid - centroid;
        let spread = (*children)[k].spread;
        spread_squared += (weights[k] / sum) * (spread * spread + dot(offset, offset));
        radius = max(radius, length(offset) + (*children)[k].radius);
    }
    let normal_squared = dot(normal, normal);
    normal *= select(0.0, inverseSqrt(max(normal_squared, 1e-30)), normal_squared > 1e-12 * sum * sum);
    return Cluster(centroid, sqrt(spread_squared), power, radius, normal, area);
}

// Children that are not there have no texels, nor have those that are not needed.
fn merge_receivers(children: ptr<function, array<Receiver, 4>>) -> Receiver {
    var texels = 0u;
    for (var k = 0u; k < 4u; k++) { texels += (*children)[k].texels; }
    if texels == 0u { return Receiver(vec3f(0.0), 0.0, 0.0, 0u, 0u, 0u); }
    var centre = vec3f(0.0);
    for (var k = 0u; k < 4u; k++) { centre += (*children)[k].centre * (f32((*children)[k].texels) / f32(texels)); }
    var spread_squared = 0.0;
    var radius = 0.0;
    for (var k = 0u; k < 4u; k++) {
        if (*children)[k].texels == 0u { continue; }
        let offset = (*children)[k].centre - centre;
        let spread = (*children)[k].spread;
        spread_squared += f32((*children)[k].texels) / f32(texels) * (spread * spread + dot(offset, offset));
        radius = max(radius, length(offset) + (*children)[k].radius);
    }
    return Receiver(centre, sqrt(spread_squared), radius, texels, 0u, 0u);
}
