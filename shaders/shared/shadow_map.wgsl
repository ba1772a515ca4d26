// Depth maps as receivers see them. The including module declares `shadow_maps`.

// Which of the `count` views from `first` on sees a receiver in this direction.
fn shadow_view(first: u32, count: u32, to_light: vec3f) -> u32 {
    if count == 6u { return first + cube_face(-to_light); }
    return first;
}

// Position on the map and depth of a point.
fn on_map(view: ShadowView, point: vec3f) -> vec3f {
    let clip = view.matrix * vec4f(point, 1.0);
    // A point at the light itself is nearer than anything on the map.
    let ndc = clip.xyz / max(clip.w, 1e-12);
    let uv = (ndc.xy * vec2f(0.5, -0.5) + 0.5) * view.tile.z + view.tile.xy;
    return vec3f(uv * f32(textureDimensions(shadow_maps).x) - 0.5, ndc.z);
}

// The share of the four nearest texels of the map that see a plane through the point, each compared with the depth of the plane at its
// own middle: comparing all with the depth of the point would let a slanted surface shadow itself.
fn lit_at(view: ShadowView, point: vec3f, slope: vec2f) -> f32 {
    let here = on_map(view, point);
    return lit_texels(here.xy, here.z, slope, view.layer);
}

// place: in texels of the layer, the middle of the first one at 0      slope: of depth, per texel
fn lit_texels(place: vec2f, here: f32, slope: vec2f, layer: u32) -> f32 {
    let base = floor(place);
    let share = place - base;
    let first = vec2i(base);
    // Reversed depth: what lies nearer to the light is greater.
    let depth = here - dot(slope, share);
    let a = f32(textureLoad(shadow_maps, first, layer, 0) <= depth);
    let b = f32(textureLoad(shadow_maps, first + vec2i(1, 0), layer, 0) <= depth + slope.x);
    let c = f32(textureLoad(shadow_maps, first + vec2i(0, 1), layer, 0) <= depth + slope.y);
    let d = f32(textureLoad(shadow_maps, first + vec2i(1, 1), layer, 0) <= depth + slope.x + slope.y);
    return mix(mix(a, b, share.x), mix(c, d, share.x), share.y);
}

// Depth per texel of the map over a plane through the point.
fn depth_slope(view: ShadowView, point: vec3f, tangent: vec3f, bitangent: vec3f) -> vec2f {
    let clip = view.matrix * vec4f(point, 1.0);
    let t = view.matrix * vec4f(tangent, 0.0);
    let b = view.matrix * vec4f(bitangent, 0.0);
    // Derivatives of clip.xyz / clip.w, times clip.w².
    let along_t = t.xyz * clip.w - clip.xyz * t.w;
    let along_b = b.xyz * clip.w - clip.xyz * b.w;
    let area = along_t.x * along_b.y - along_t.y * along_b.x;
    if area == 0.0 { return vec2f(0.0); }
    let per_ndc = vec2f(along_t.z * along_b.y - along_t.y * along_b.z, along_t.x * along_b.z - along_t.z * along_b.x) / area;
    let texels = 0.5 * view.tile.z * f32(textureDimensions(shadow_maps).x);
    return per_ndc * vec2f(1.0, -1.0) / texels;
}

// Off the surface, so that it does not shadow itself where it leaves the plane that stands for it. It does so by about the angle between
// triangle and shading normal, over the reach of a look into the map (a texel along each axis) and over the square that is averaged. A
// quarter more than that, and a tenth of the reach where a surface is shaded flat, left the least error on scans.
// tilt: tangent of that angle      half_width: of the square, mm
fn lift(view: ShadowView, position: vec3f, face: vec3f, tilt: f32, half_width: f32) -> vec3f {
    let depth = mix(1.0, (view.matrix * vec4f(position, 1.0)).w, view.perspective);
    return position + face * lift_height(view.texel * depth, tilt, half_width);
}

// texel: width of a texel of the map there, mm
fn lift_height(texel: f32, tilt: f32, half_width: f32) -> f32 {
    let reach = 1.4142136 * texel;
    return 0.1 * reach + 1.25 * tilt * (reach + 1.4142136 * half_width);
}

// Faces in the order +x, −x, +y, −y, +z, −z.
fn cube_face(direction: vec3f) -> u32 {
    let size = abs(direction);
    if size.x >= size.y && size.x >= size.z { return select(1u, 0u, direction.x > 0.0); }
    if size.y >= size.z { return select(3u, 2u, direction.y > 0.0); }
    return select(5u, 4u, direction.z > 0.0);
}
