// Bilinear look-up of radiant exitance. Needs no filterable float texture, so it runs on every WebGPU device.
// uv: atlas coordinate in [0, 1]²       returns B, linear RGB
fn translume_exitance(exitance: texture_2d<f32>, uv: vec2f) -> vec3f {
    let size = vec2i(textureDimensions(exitance));
    let position = uv * vec2f(size) - 0.5;
    let corner = vec2i(floor(position));
    let weight = position - floor(position);
    let low = clamp(corner, vec2i(0), size - 1);
    let high = clamp(corner + 1, vec2i(0), size - 1);
    return mix(
        mix(textureLoad(exitance, low, 0).rgb, textureLoad(exitance, vec2i(high.x, low.y), 0).rgb, weight.x),
        mix(textureLoad(exitance, vec2i(low.x, high.y), 0).rgb, textureLoad(exitance, high, 0).rgb, weight.x),
        weight.y);
}
