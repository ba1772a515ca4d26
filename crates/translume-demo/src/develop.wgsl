// Samples of radiance and coverage → 8-bit sRGB, as `Picture::from_samples` and `Picture::to_srgb` do it.

struct Settings {
    // Of the picture, in pixels.
    size: vec2u,
    // Along each side of a pixel.
    samples: u32,
    // Factor of radiance.
    gain: f32,
    // Linear grey behind the body, in the middle and at the rim.
    backdrop: vec2f,
}

// Not a uniform: where a loop's end is one, Mesa 22.3's lavapipe compiles the shader anew for every dispatch, and keeps it.
@group(0) @binding(0) var<storage, read> settings: Settings;
@group(0) @binding(1) var radiance: texture_2d<f32>;
// RGBA, 8 bits each, row by row from the top.
@group(0) @binding(2) var<storage, read_write> picture: array<u32>;

// Khronos PBR Neutral tone mapper (Khronos Group 2024).
fn neutral(colour: vec3f) -> vec3f {
    const START = 0.8 - 0.04;
    const DESATURATION = 0.15;
    let least = max(min(colour.r, min(colour.g, colour.b)), 0.0);
    let offset = select(0.04, least - 6.25 * least * least, least < 0.08);
    let mapped = max(colour, vec3f(0.0)) - offset;
    let peak = max(mapped.r, max(mapped.g, max(mapped.b, 0.0)));
    if peak < START {
        return mapped;
    }
    let room = 1.0 - START;
    let new_peak = 1.0 - room * room / (peak + room - START);
    let whiteness = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    return mapped * (new_peak / peak) * (1.0 - whiteness) + new_peak * whiteness;
}

// IEC 61966-2-1.
fn srgb(linear: vec3f) -> vec3f {
    let low = 12.92 * linear;
    let high = 1.055 * pow(max(linear, vec3f(0.0)), vec3f(1.0 / 2.4)) - 0.055;
    return select(high, low, linear <= vec3f(0.0031308));
}

// Interleaved gradient noise (Jimenez 2014).
fn dither(pixel: vec2u) -> f32 {
    return fract(52.982918 * fract(dot(vec2f(pixel), vec2f(0.06711056, 0.00583715))));
}

@compute @workgroup_size(8, 8)
fn develop(@builtin(global_invocation_id) id: vec3u) {
    let pixel = id.xy;
    if any(pixel >= settings.size) {
        return;
    }
    let place = 2.0 * vec2f(pixel) / vec2f(settings.size) - 1.0;
    let rim = min(0.5 * dot(place, place), 1.0);
    let backdrop = mix(settings.backdrop.x, settings.backdrop.y, rim);
    var sum = vec3f(0.0);
    for (var y = 0u; y < settings.samples; y++) {
        for (var x = 0u; x < settings.samples; x++) {
            let sample = textureLoad(radiance, pixel * settings.samples + vec2u(x, y), 0);
            sum += neutral(sample.rgb * settings.gain + backdrop * (1.0 - sample.a));
        }
    }
    let mean = sum / f32(settings.samples * settings.samples);
    let bytes = vec3u(clamp(srgb(mean) * 255.0 + dither(pixel), vec3f(0.0), vec3f(255.0)));
    picture[pixel.y * settings.size.x + pixel.x] = bytes.r | (bytes.g << 8u) | (bytes.b << 16u) | (255u << 24u);
}
