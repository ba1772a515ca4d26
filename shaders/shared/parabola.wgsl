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
    // Mean curvature of the surface, 1/mm.
    bulge: f32,
    // Irradiance of that light.
    light: vec3f,
    padding0: f32,
}

// How much is left at a depth of what light that enters leaves behind at the surface: e^−σ_t z/μ₀, and 3 E₄(σ_t z) of an even sky, by two exponentials
// within .01 down to a mean free path.
fn left_behind(cosine: f32, around: f32, depth: vec3f) -> vec3f {
    let x = transport.extinction.rgb * depth;
    return mix(exp(-x / max(cosine, 0.05)), 0.5 * (exp(-0.9 * x) + exp(-2.1 * x)), around);
}
