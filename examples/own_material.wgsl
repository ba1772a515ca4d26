// The engine's material. `translume_exitance` and `fresnel_transmittance` come from translume_shaders::MATERIAL, which stands in front.

struct Scene {
    // Millimetres to clip space: positions of the body are in millimetres.
    view_projection: mat4x4f,
    eye: vec3f,
    eta: f32,
    to_sun: vec3f,
    exit_scale: f32,
    sun: vec3f,
    // Of the engine's highlight; 0 shows what is under the surface alone.
    gloss: f32,
}

@group(0) @binding(0) var<uniform> scene: Scene;
@group(0) @binding(1) var exitance: texture_2d<f32>;

struct Surface {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
}

// Vertices as `translume::Geometry` lays them out.
@vertex
fn body_vertex(@location(1) uv: vec2f, @location(2) position: vec3f, @location(3) normal: vec3f) -> Surface {
    return Surface(scene.view_projection * vec4f(position, 1.0), position, normal, uv);
}

@fragment
fn body_fragment(in: Surface) -> @location(0) vec4f {
    let to_eye = normalize(scene.eye - in.position);
    let normal = normalize(in.normal);
    // Under the surface: what translume computed, as much of it as leaves towards the eye.
    let transmitted = scene.exit_scale * fresnel_transmittance(scene.eta, abs(dot(normal, to_eye)));
    let subsurface = translume_exitance(exitance, in.uv) * (transmitted / 3.14159265);
    // On the surface: whatever the engine likes. This is Blinn and Phong's.
    let halfway = normalize(to_eye + scene.to_sun);
    let lobe = scene.gloss * pow(max(dot(normal, halfway), 0.0), 60.0) * max(dot(normal, scene.to_sun), 0.0);
    return vec4f(subsurface + lobe * scene.sun, 1.0);
}

// A floor that knows nothing of translume: it shares depth with the body.
@vertex
fn floor_vertex(@builtin(vertex_index) index: u32) -> Surface {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let position = vec3f(corner.x * 160.0, 0.0, corner.y * 160.0);
    return Surface(scene.view_projection * vec4f(position, 1.0), position, vec3f(0.0, 1.0, 0.0), corner);
}

@fragment
fn floor_fragment(in: Surface) -> @location(0) vec4f {
    let tile = floor(in.position.xz / 20.0);
    let albedo = mix(0.25, 0.4, abs(tile.x + tile.y) % 2.0);
    let fade = smoothstep(1.0, 0.4, length(in.uv));
    return vec4f(vec3f(albedo * fade * max(scene.to_sun.y, 0.0) / 3.14159265) * scene.sun + vec3f(0.02, 0.02, 0.025), 1.0);
}
