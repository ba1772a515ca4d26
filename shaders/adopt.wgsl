// Adopt: vertices that the host computed → positions in mm and unit normals, per mesh vertex.

// Places are in words from where the host's buffers are bound.
struct Adopt {
    first_position: u32,
    position_stride: u32,
    first_normal: u32,
    // 0 where the host has no normals.
    normal_stride: u32,
}

@group(0) @binding(0) var<uniform> deform: Deform;
@group(0) @binding(1) var<uniform> adopt: Adopt;
@group(0) @binding(2) var<storage, read> host_positions: array<f32>;
@group(0) @binding(3) var<storage, read> host_normals: array<f32>;
// The host's number of each vertex.
@group(0) @binding(4) var<storage, read> numbers: array<u32>;
// Nine floats a vertex: position, normal, direction of inflation; model space.
@group(0) @binding(5) var<storage, read> rest: array<f32>;
@group(0) @binding(6) var<storage, read_write> positions: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> normals: array<vec4f>;

@compute @workgroup_size(64)
fn adopt_vertices(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let vertex = item_index(group, groups, local);
    if vertex >= deform.vertex_count { return; }
    let number = numbers[vertex];
    let p = adopt.first_position + number * adopt.position_stride;
    let position = vec3f(host_positions[p], host_positions[p + 1u], host_positions[p + 2u]);
    positions[vertex] = vec4f((deform.model * vec4f(position, 1.0)).xyz, 1.0);
    var normal = vec3f(rest[vertex * 9u + 3u], rest[vertex * 9u + 4u], rest[vertex * 9u + 5u]);
    if adopt.normal_stride > 0u {
        let n = adopt.first_normal + number * adopt.normal_stride;
        let theirs = vec3f(host_normals[n], host_normals[n + 1u], host_normals[n + 2u]);
        // One without a direction keeps that of the rest pose.
        normal = select(normal, theirs, dot(theirs, theirs) > 0.0);
    }
    normals[vertex] = vec4f(normalize((deform.normal * vec4f(normal, 0.0)).xyz), 0.0);
}
