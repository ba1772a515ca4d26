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

// A depth, for all sites whose light gets there.
struct Deep {
    // Mean free paths, and by how many that is shallower with Hopf's function.
    optical: vec3f,
    shift: vec3f,
    // Mean way from there to what an even sky's light scatters deeper.
    sky: vec3f,
}

fn deep_at(depth: vec3f) -> Deep {
    let optical = transport.extinction.rgb * depth;
    let x = max(optical, vec3f(transport.hopf.z));
    let shift = hopf_shift(optical);
    if transport.eta > 1.0 {
        // Within the critical angle all is nearly as deep.
        return Deep(optical, shift, mean_way(x, min(shift, vec3f(transport.hopf.z)), 1.0 / mean_sky_cosine()));
    }
    // 2 E₂(x) by two exponentials.
    let sky = 0.3 * mean_way(x, min(shift, vec3f(transport.hopf.z)), 0.9) + 0.7 * mean_way(x, min(shift, vec3f(transport.hopf.z)), 2.1);
    return Deep(optical, shift, sky);
}

// Minus the particular solution of light that enters at a place, αE/D times the mean way from a depth to what scatters deeper, with depths as Hopf's function
// makes them: of a beam e^−kx, and of an even sky.
fn beam_at(p: Parabola, at: Deep) -> vec3f {
    let beam = mean_way(max(at.optical, vec3f(transport.hopf.z)), min(at.shift, vec3f(transport.hopf.z)), 1.0 / max(p.cosine, 0.05));
    let above = max(at.shift - at.optical, vec3f(0.0));
    return transport.albedo.rgb * p.light / (transport.diffusion.rgb * transport.extinction.rgb) * (mix(beam, at.sky, p.around) + above);
}

fn mean_way(x: vec3f, shift: vec3f, k: f32) -> vec3f {
    return exp(-k * x) * (1.0 / k + shift * (transport.hopf.y / (k + transport.hopf.y)));
}
