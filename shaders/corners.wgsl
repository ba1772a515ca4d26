// Corners: deformed vertices in the order of the atlas, which has one on each side of a seam, for pictures to draw.

// Three words each: the mesh vertex, and its place in the atlas.
@group(0) @binding(0) var<storage, read> atlas_vertices: array<u32>;
@group(0) @binding(1) var<storage, read> positions: array<vec4f>;
@group(0) @binding(2) var<storage, read> normals: array<vec4f>;
// Position and normal of each.
@group(0) @binding(3) var<storage, read_write> corners: array<vec4f>;

@compute @workgroup_size(64)
fn unfold(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let corner = item_index(group, groups, local);
    if corner >= arrayLength(&corners) / 2u { return; }
    let vertex = atlas_vertices[corner * 3u];
    corners[corner * 2u] = positions[vertex];
    corners[corner * 2u + 1u] = normals[vertex];
}
