// The engine's skinning: linear blend of four joints a vertex, from a buffer of rest poses into the vertex buffer that it also draws.

struct Skinned {
    position: array<f32, 3>,
    normal: array<f32, 3>,
    uv: array<f32, 2>,
}

struct Influences {
    joints: vec4u,
    weights: vec4f,
}

@group(0) @binding(0) var<storage, read> rest: array<Skinned>;
@group(0) @binding(1) var<storage, read> influences: array<Influences>;
@group(0) @binding(2) var<storage, read> joints: array<mat4x4f>;
@group(0) @binding(3) var<storage, read_write> vertices: array<Skinned>;

@compute @workgroup_size(64)
fn skin(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&rest) { return; }
    let vertex = rest[id.x];
    let bound = influences[id.x];
    var position = vec3f(0.0);
    var normal = vec3f(0.0);
    for (var k = 0u; k < 4u; k++) {
        let joint = joints[bound.joints[k]];
        position += bound.weights[k] * (joint * vec4f(vertex.position[0], vertex.position[1], vertex.position[2], 1.0)).xyz;
        normal += bound.weights[k] * (joint * vec4f(vertex.normal[0], vertex.normal[1], vertex.normal[2], 0.0)).xyz;
    }
    normal = normalize(normal);
    vertices[id.x] = Skinned(
        array<f32, 3>(position.x, position.y, position.z),
        array<f32, 3>(normal.x, normal.y, normal.z),
        vertex.uv);
}
