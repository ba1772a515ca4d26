// φ under a site, in each channel: a parabola of the depth, less what the light that enters there leaves behind.
struct Parabola {
    surface: vec3f,
    // Way straight inwards to the other side, mm.
    thickness: f32,
    slope: vec3f,
    // Mean cosine of the light that entered.
    cosine: f32,
    curve: vec3f,
    // Share of that light that comes from all around.
    around: f32,
    // Share of the light of lamps that gets there.
    open: vec3f,
    padding0: f32,
    // Irradiance of that light.
    light: vec3f,
    padding1: f32,
}
