// Deform: rest pose, morph targets, joints and warp → positions in mm and unit normals, per mesh vertex.

// Whether the mesh has a skin.
override SKINNED: bool = false;

struct Influence {
    joint: u32,
    weight: f32,
}

@group(0) @binding(0) var<uniform> deform: Deform;
// Nine floats a vertex: position, normal, direction of inflation; model space.
@group(0) @binding(1) var<storage, read> rest: array<f32>;
// Three floats a vertex, target after target; model space.
@group(0) @binding(2) var<storage, read> deltas: array<f32>;
@group(0) @binding(3) var<storage, read> weights: array<f32>;
// As many a vertex as `influences_per_vertex`.
@group(0) @binding(4) var<storage, read> influences: array<Influence>;
// From the mesh at rest to model space; affine.
@group(0) @binding(5) var<storage, read> joints: array<mat4x4f>;
@group(0) @binding(6) var<storage, read_write> positions: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> normals: array<vec4f>;

@compute @workgroup_size(64)
fn pose(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let vertex = item_index(group, groups, local);
    if vertex >= deform.vertex_count { return; }
    var position = rest_vector(vertex, 0u) + deform.warp.inflate * rest_vector(vertex, 2u);
    for (var k = 0u; k < deform.target_count; k++) {
        let delta = (k * deform.vertex_count + vertex) * 3u;
        position += weights[k] * vec3f(deltas[delta], deltas[delta + 1u], deltas[delta + 2u]);
    }
    if SKINNED { position = skinned(vertex, position); }
    position = warped(deform.warp, position);
    positions[vertex] = vec4f((deform.model * vec4f(position, 1.0)).xyz, 1.0);
    normals[vertex] = vec4f(normalize((deform.normal * vec4f(rest_vector(vertex, 1u), 0.0)).xyz), 0.0);
}

// Vector k of the three that a vertex has at rest.
fn rest_vector(vertex: u32, k: u32) -> vec3f {
    let at = vertex * 9u + k * 3u;
    return vec3f(rest[at], rest[at + 1u], rest[at + 2u]);
}

// Linear blend skinning.
fn skinned(vertex: u32, position: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var k = 0u; k < deform.influences_per_vertex; k++) {
        let influence = influences[vertex * deform.influences_per_vertex + k];
        sum += influence.weight * (joints[influence.joint] * vec4f(position, 1.0)).xyz;
    }
    return sum;
}
