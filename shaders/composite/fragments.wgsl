// Exitance summed up at the fragment itself.
fn exitance_at_vertex(vertex: u32) -> vec3f {
    return vec3f(0.0);
}

fn exitance_at_fragment(in: Fragment) -> vec3f {
    let size = textureDimensions(exitance);
    let pixel = min(vec2u(max(in.uv * vec2f(size), vec2f(0.0))), size - 1u);
    let texel = standing[pixel.y * size.x + pixel.x];
    if texel == NO_TEXEL { return vec3f(0.0); }
    return exitance_at(in.position, texel).rgb * marked_tint(lamps[texel].marks);
}
