// Vertices: radiant exitance at every vertex, from what the dual scatter left for points.

@group(0) @binding(0) var<storage, read> positions: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> vertex_exitance: array<vec4f>;

@compute @workgroup_size(64)
fn vertices(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= arrayLength(&vertex_exitance) { return; }
    let texel = standing[index];
    vertex_exitance[index] = exitance_at(positions[index].xyz, texel) * vec4f(marked_tint(lamps[texel].marks), 1.0);
}
