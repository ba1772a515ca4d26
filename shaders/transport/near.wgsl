// Near: the sites around each, for whoever goes from sites to texels.

@group(0) @binding(0) var<uniform> transport: Transport;
@group(0) @binding(1) var<storage, read> nodes: array<Node>;
@group(0) @binding(2) var<storage, read> site_positions: array<vec4f>;
@group(0) @binding(3) var<storage, read> site_normals: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> surroundings: array<Surroundings>;

// Sites count so far from a texel, in widths of a site, and a texel is no further from its own than this.
const REACH: f32 = 1.3;
const ASIDE: f32 = 0.9;

@compute @workgroup_size(64)
fn near(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let site = item_index(group, groups, local);
    if site >= transport.site_count { return; }
    let position = site_positions[site].xyz;
    let normal = site_normals[site].xyz;
    let width = site_width(site_positions[site].w);
    let reach = (REACH + ASIDE) * width;
    var count = 0u;
    var level = transport.top_level;
    var node = 0u;
    loop {
        if level > 0u {
            let index = node_index(level, node);
            if distance(nodes[index].centre, position) < nodes[index].radius + reach {
                level -= 1u;
                node *= 4u;
                continue;
            }
        } else {
            let place = site_positions[node];
            let is_near = distance(place.xyz, position) < reach && dot(site_normals[node].xyz, normal) > 0.0;
            if is_near && place.w > 0.0 && count < MOST_NEAR {
                surroundings[site].sites[count] = node;
                count += 1u;
            }
        }
        let next = passed(transport.site_count, transport.top_level, Step(level, node));
        level = next.level;
        node = next.node;
        if level == transport.top_level { break; }
    }
    surroundings[site].count = count;
    surroundings[site].reach = REACH * width;
}
