// Smooth: what leaves at sites → radiant exitance of texels, from the sites around their own.

@group(0) @binding(0) var<uniform> transport: Transport;
@group(0) @binding(1) var<storage, read> surroundings: array<Surroundings>;
@group(0) @binding(2) var<storage, read> site_positions: array<vec4f>;
@group(0) @binding(3) var<storage, read> site_normals: array<vec4f>;
@group(0) @binding(4) var<storage, read> site_exitance: array<vec4f>;
@group(0) @binding(5) var<storage, read> texel_positions: array<vec4f>;
@group(0) @binding(6) var<storage, read> texel_normals: array<vec4f>;
// Marks of texels, then their places in the order of sites.
@group(0) @binding(7) var<storage, read> marks: array<u32>;
@group(0) @binding(8) var<storage, read_write> exitance: array<vec4f>;

// Weight of sites over that of the area in reach, below which they say nothing about a texel.
const LEAST_WEIGHT: f32 = 0.05;

@compute @workgroup_size(64)
fn smooth_out(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let texel = item_index(group, groups, local);
    if texel >= transport.texel_count { return; }
    let own = marks[transport.texel_count + texel] / transport.texels_per_site;
    if transport.texels_per_site == 1u {
        exitance[texel] = vec4f(site_exitance[own].rgb * marked_tint(marks[texel]), 0.0);
        return;
    }
    var plane = plane_at(texel_positions[texel].xyz, texel_normals[texel].xyz, surroundings[own].reach);
    for (var k = 0u; k < surroundings[own].count; k++) { add_site(&plane, surroundings[own].sites[k]); }
    let is_strange = plane.weights < LEAST_WEIGHT * plane.reach2;
    exitance[texel] = vec4f(value_of(plane) * marked_tint(marks[texel]), select(0.0, STRANGE, is_strange));
}
