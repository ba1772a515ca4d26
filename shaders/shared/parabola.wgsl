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

// Optical depth that Hopf's function makes the surface of.
const SURFACE: f32 = 0.096;

// Minus the particular solution of light that enters at a place, αE/D times the mean way from an optical depth to what scatters deeper, with depths as
// Hopf's function makes them: of a beam e^−kx, and of an even sky, 2 E₂(x), by two exponentials.
fn beam_at(p: Parabola, depth: vec3f) -> vec3f {
    let optical = transport.extinction.rgb * depth;
    let x = max(optical, vec3f(SURFACE));
    let shift = hopf_shift(x);
    let beam = beyond_depth(x, shift, 1.0 / max(p.cosine, 0.05));
    let sky = 0.3 * beyond_depth(x, shift, 0.9) + 0.7 * beyond_depth(x, shift, 2.1);
    let above = max(hopf_shift(optical) - optical, vec3f(0.0));
    return transport.albedo.rgb * p.light / (transport.diffusion.rgb * transport.extinction.rgb) * (mix(beam, sky, p.around) + above);
}

fn beyond_depth(x: vec3f, shift: vec3f, k: f32) -> vec3f {
    return exp(-k * x) * (1.0 / k + shift * (3.4 / (k + 3.4)));
}
