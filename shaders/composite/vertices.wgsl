// Exitance as the scatter stage left it at the vertices.
@group(1) @binding(0) var<storage, read> vertex_exitance: array<vec4f>;

fn exitance_at_vertex(vertex: u32) -> vec3f {
    return vertex_exitance[vertex].rgb;
}

fn exitance_at_fragment(in: Fragment) -> vec3f {
    return in.exitance;
}
