// Exitance as the scatter stage left it in the texture.
fn exitance_at_vertex(vertex: u32) -> vec3f {
    return vec3f(0.0);
}

fn exitance_at_fragment(in: Fragment) -> vec3f {
    return translume_exitance(exitance, in.uv);
}
