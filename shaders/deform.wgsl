// Deform: rest pose and morph targets → positions in mm and unit normals, per mesh vertex.

struct Deform {
    // Model space to millimetres.
    model: mat4x4f,
    // Inverse transpose of the model matrix.
    normal: mat4x4f,
    vertex_count: u32,
    target_count: u32,
    // −1 where the model matrix mirrors, else 1.
    winding: f32,
    padding: u32,
}

@group(0) @binding(0) var<uniform> deform: Deform;
// Six floats a vertex: position, normal; model space.
@group(0) @binding(1) var<storage, read> rest: array<f32>;
// Three floats a vertex, target after target; model space.
@group(0) @binding(2) var<storage, read> deltas: array<f32>;
@group(0) @binding(3) var<storage, read> weights: array<f32>;
// Three vertex indices a triangle.
@group(0) @binding(4) var<storage, read> triangles: array<u32>;
// vertex_count + 1 offsets, then the triangles around each vertex.
@group(0) @binding(5) var<storage, read> adjacency: array<u32>;
@group(0) @binding(6) var<storage, read_write> positions: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> normals: array<vec4f>;

@compute @workgroup_size(64)
fn morph(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let vertex = item_index(group, groups, local);
    if vertex >= deform.vertex_count { return; }
    let at = vertex * 6u;
    var position = vec3f(rest[at], rest[at + 1u], rest[at + 2u]);
    for (var k = 0u; k < deform.target_count; k++) {
        let delta = (k * deform.vertex_count + vertex) * 3u;
        position += weights[k] * vec3f(deltas[delta], deltas[delta + 1u], deltas[delta + 2u]);
    }
    let normal = (deform.normal * vec4f(rest[at + 3u], rest[at + 4u], rest[at + 5u], 0.0)).xyz;
    positions[vertex] = vec4f((deform.model * vec4f(position, 1.0)).xyz, 1.0);
    normals[vertex] = vec4f(normalize(normal), 0.0);
}

fn corner(triangle: u32, k: u32) -> vec3f {
    return positions[triangles[triangle * 3u + k]].xyz;
}

// Area-weighted normals of the deformed surface. A vertex whose triangles all vanished keeps its rest normal.
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
