// Normals: area-weighted normals of the deformed surface, per mesh vertex.

@group(0) @binding(0) var<uniform> deform: Deform;
// Three vertex indices a triangle.
@group(0) @binding(1) var<storage, read> triangles: array<u32>;
// vertex_count + 1 offsets, then the triangles around each vertex.
@group(0) @binding(2) var<storage, read> adjacency: array<u32>;
@group(0) @binding(3) var<storage, read> positions: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> normals: array<vec4f>;

fn corner(triangle: u32, k: u32) -> vec3f {
    return positions[triangles[triangle * 3u + k]].xyz;
}

// A vertex whose triangles all vanished keeps its rest normal.
@compute @workgroup_size(64)
fn recompute_normals(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let vertex = item_index(group, groups, local);
    if vertex >= deform.vertex_count { return; }
    var sum = vec3f(0.0);
    for (var k = adjacency[vertex]; k < adjacency[vertex + 1u]; k++) {
        let triangle = adjacency[deform.vertex_count + 1u + k];
        let p = corner(triangle, 0u);
        sum += cross(corner(triangle, 1u) - p, corner(triangle, 2u) - p);
    }
    let length_squared = dot(sum, sum);
    if length_squared > 0.0 {
        normals[vertex] = vec4f(sum * (deform.winding * inverseSqrt(length_squared)), 0.0);
    }
}
