// Light that a rough dielectric surface throws back before it enters. Walter et al. 2007 (GGX), with the height-correlated
// masking of Heitz 2014. The including module declares the uniform `lighting`.

// Radiance reflected towards the eye for unit irradiance on a surface that faces the light.
fn ggx(eta: f32, roughness: f32, normal: vec3f, to_eye: vec3f, to_light: vec3f) -> f32 {
    let light_cosine = dot(normal, to_light);
    let eye_cosine = max(dot(normal, to_eye), 1e-3);
    if light_cosine <= 0.0 { return 0.0; }
    let halfway = normalize(to_light + to_eye);
    let alpha2 = roughness * roughness * roughness * roughness;
    let half_cosine = dot(normal, halfway);
    let spread = half_cosine * half_cosine * (alpha2 - 1.0) + 1.0;
    let distribution = alpha2 * 0.31830988 / (spread * spread);
    let masking = 0.5 / (light_cosine * sqrt(eye_cosine * eye_cosine * (1.0 - alpha2) + alpha2)
        + eye_cosine * sqrt(light_cosine * light_cosine * (1.0 - alpha2) + alpha2));
    let reflected = 1.0 - fresnel_transmittance(eta, dot(to_eye, halfway));
    return distribution * masking * reflected * light_cosine;
}

// face: normal of the triangle, which shadows follow
fn gloss(roughness: f32, position: vec3f, normal: vec3f, face: vec3f, to_eye: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var k = 0u; k < lighting.light_count; k++) {
        let arriving = arrival(k, position, 0.0, normal);
        let reflected = ggx(lighting.eta, roughness, normal, to_eye, arriving.to_light);
        if reflected > 0.0 {
            var lit = 1.0;
            if lighting.lights[k].first_view != NO_SHADOW {
                let view = shadow_view(k, arriving.to_light);
                lit = lit_at(view, lift(view, position, face, arriving.to_light, 0.0));
            }
            sum += arriving.strength * (reflected * lit);
        }
    }
    let mirrored = reflect(-to_eye, normal);
    let reflected = 1.0 - fresnel_transmittance(lighting.eta, abs(dot(normal, to_eye)));
    for (var k = 0u; k < lighting.ambient_count; k++) {
        let inside = dot(mirrored, lighting.ambients[k].axis) >= lighting.ambients[k].cone_cosine;
        sum += select(vec3f(0.0), lighting.ambients[k].radiance * reflected, inside);
    }
    return sum;
}
