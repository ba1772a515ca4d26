// Resolve: the dense texels → the square texture that materials sample, gutters filled.

@group(0) @binding(0) var<storage, read> values: array<vec4f>;
// One entry a pixel: its texel, or EMPTY.
@group(0) @binding(1) var<storage, read> pixels: array<u32>;
@group(0) @binding(2) var texture: texture_storage_2d<rgba32float, write>;

const EMPTY: u32 = 0xffffffffu;

@compute @workgroup_size(8, 8)
fn resolve(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(texture);
    if id.x >= size.x || id.y >= size.y { return; }
    let texel = pixels[id.y * size.x + id.x];
    var value = vec4f(0.0);
    if texel != EMPTY { value = vec4f(values[texel].rgb, 1.0); }
    textureStore(texture, id.xy, value);
}
