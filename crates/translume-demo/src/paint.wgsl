// A body in colours of its texels, under a lamp on the camera.

struct View {
    // Millimetres to clip space.
    to_clip: mat4x4f,
    // mm
    eye: vec3f,
}

struct Vertex {
    // The mesh's vertex.
    xref: u32,
    u: f32,
    v: f32,
}

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec2f,
    // mm
    @location(1) place: vec3f,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> positions: array<vec4f>;
@group(0) @binding(2) var<storage, read> vertices: array<Vertex>;
@group(0) @binding(3) var colours: texture_2d<f32>;

@vertex
fn corner(@builtin(vertex_index) index: u32) -> Corner {
    let vertex = vertices[index];
    let place = positions[vertex.xref].xyz;
    return Corner(view.to_clip * vec4f(place, 1.0), vec2f(vertex.u, vertex.v), place);
}

@fragment
fn paint(corner: Corner) -> @location(0) vec4f {
    let size = vec2i(textureDimensions(colours));
    let pixel = clamp(vec2i(corner.uv * vec2f(size)), vec2i(0), size - 1);
    // Of the face, as what is shown belongs to texels and not to normals.
    let across = cross(dpdx(corner.place), dpdy(corner.place));
    let facing = abs(dot(across, normalize(view.eye - corner.place))) / max(length(across), 1e-30);
    return vec4f(textureLoad(colours, pixel, 0).rgb * (0.5 + 0.5 * facing), 1.0);
}
