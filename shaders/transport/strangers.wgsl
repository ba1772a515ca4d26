// Strangers: texels that ended up in a site of the other side of a thin part → their exitance, from whatever sites are around.

@group(0) @binding(0) var<uniform> transport: Transport;
@group(0) @binding(1) var<storage, read> nodes: array<Node>;
@group(0) @binding(2) var<storage, read> site_positions: array<vec4f>;
@group(0) @binding(3) var<storage, read> site_normals: array<vec4f>;
@group(0) @binding(4) var<storage, read> site_exitance: array<vec4f>;
@group(0) @binding(5) var<storage, read> texel_positions: array<vec4f>;
@group(0) @binding(6) var<storage, read> texel_normals: array<vec4f>;
// Marks of texels, then their places in the order of sites.
@group(0) @binding(7) var<storage, read> marks: array<u32>;
@group(0) @binding(8) var<storage, read_write> exitance: array<vec4f>;

// Sites count so far away, in widths of a usual site.
const REACH: f32 = 2.0;

@compute @workgroup_size(64)
fn strangers(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let texel = item_index(group, groups, local);
    if texel >= transport.texel_count { return; }
    if exitance[texel].w != STRANGE { return; }
    let own = marks[transport.texel_count + texel] / transport.texels_per_site;
    let reach = REACH * site_width(site_positions[own].w);
    var plane = plane_at(texel_positions[texel].xyz, texel_normals[texel].xyz, reach);
    var level = transport.top_level;
    var node = 0u;
    loop {
        if level > 0u {
            let index = node_index(level, node);
            if distance(nodes[index].centre, plane.position) < nodes[index].radius + reach {
                level -= 1u;
                node *= 4u;
                continue;
            }
        } else {
            add_site(&plane, node);
        }
        let next = passed(transport.site_count, transport.top_level, Step(level, node));
        level = next.level;
        node = next.node;
        if level == transport.top_level { break; }
    }
    var value = site_exitance[own].rgb;
    if plane.weights > 0.0 { value = value_of(plane); }
    exitance[texel] = vec4f(value * marked_tint(marks[texel]), 0.0);
}
