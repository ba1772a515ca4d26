// Depth maps as receivers see them. The including module declares `lighting`, `shadow_maps` and `shadow_sampler`.

// Which of the `count` views from `first` on sees a receiver in this direction.
fn shadow_view(first: u32, count: u32, to_light: vec3f) -> u32 {
    if count == 6u { return first + cube_face(-to_light); }
    return first;
}

// Comparing with the four nearest texels of the map reaches one texel sideways along each axis; lifted by what the surface falls
// over that distance, a surface cannot shadow itself. The square of a texel lies in the plane of its triangle while the surface
// curves away: a tenth of its half width is the sagitta at a radius of five half widths.
fn lift(view: ShadowView, position: vec3f, face: vec3f, to_light: vec3f, half_width: f32) -> vec3f {
    let depth = mix(1.0, (view.matrix * vec4f(position, 1.0)).w, view.perspective);
    let cosine = dot(face, to_light);
    let reach = 1.4142136 * view.texel * depth;
    return position + face * (reach * (sqrt(max(1.0 - cosine * cosine, 0.0)) + 0.05) + 0.1 * half_width);
}

fn lit_at(view: ShadowView, point: vec3f) -> f32 {
    let clip = view.matrix * vec4f(point, 1.0);
    let ndc = clip.xyz / clip.w;
    let uv = (ndc.xy * vec2f(0.5, -0.5) + 0.5) * view.tile.z + view.tile.xy;
    return textureSampleCompareLevel(shadow_maps, shadow_sampler, uv, view.layer, ndc.z);
}

// Faces in the order +x, −x, +y, −y, +z, −z.
fn cube_face(direction: vec3f) -> u32 {
    let size = abs(direction);
    if size.x >= size.y && size.x >= size.z { return select(1u, 0u, direction.x > 0.0); }
    if size.y >= size.z { return select(3u, 2u, direction.y > 0.0); }
    return select(5u, 4u, direction.z > 0.0);
}
