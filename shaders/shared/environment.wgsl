// Light from everywhere, held by nine spherical harmonics.

// Irradiance that enters through a surface with unit normal n. c: factors (RGB, 0) of these polynomials, in which the harmonics' norms
// and the lobe of the cosine and the Fresnel transmittance are contained. Where the sum swings below zero there is no light.
fn environment_irradiance(c: array<vec4f, 9>, n: vec3f) -> vec3f {
    let band_1 = c[1] * n.y + c[2] * n.z + c[3] * n.x;
    let products = c[4] * (n.x * n.y) + c[5] * (n.y * n.z) + c[7] * (n.x * n.z);
    let squares = c[6] * (3.0 * n.z * n.z - 1.0) + c[8] * (n.x * n.x - n.y * n.y);
    return max((c[0] + band_1 + products + squares).rgb, vec3f());
}
