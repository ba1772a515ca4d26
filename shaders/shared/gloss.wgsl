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

struct Surface {
    position: vec3f,
    normal: vec3f,
    // Normal of the triangle, which shadows follow.
    face: vec3f,
    to_eye: vec3f,
}

// An area light's emitter as a point.
fn emitted(index: u32, emitter: u32, position: vec3f) -> Arrival {
    let point = lighting.emitters[lighting.lights[index].first_emitter + emitter];
    let offset = point.xyz - position;
    let to_light = safe_normalize(offset, vec3f(0.0, 1.0, 0.0));
    let cosine = max(-dot(emitter_normal(index, point.xyz), to_light), 0.0);
    return Arrival(to_light, lighting.lights[index].colour * (point.w * cosine / max(dot(offset, offset), point.w)));
}

fn gloss_of(index: u32, emitter: u32, arriving: Arrival, roughness: f32, surface: Surface) -> vec3f {
    let reflected = ggx(lighting.eta, roughness, surface.normal, surface.to_eye, arriving.to_light);
    if reflected <= 0.0 { return vec3f(0.0); }
    var lit = 1.0;
    if lighting.lights[index].first_view != NO_SHADOW {
        let count = lighting.lights[index].view_count;
        let view = lighting.views[shadow_view(lighting.lights[index].first_view + emitter * count, count, arriving.to_light)];
        let lifted = lift(view, surface.position, surface.face, tangent_between(surface.normal, surface.face), 0.0);
        let tangent = any_perpendicular(surface.face);
        lit = lit_at(view, lifted, depth_slope(view, lifted, tangent, cross(surface.face, tangent)));
    }
    return arriving.strength * (reflected * lit);
}

fn gloss(roughness: f32, position: vec3f, normal: vec3f, face: vec3f, to_eye: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var k = 0u; k < lighting.light_count; k++) {
        let surface = Surface(position, normal, face, to_eye);
        if lighting.lights[k].kind < RECTANGLE {
            sum += gloss_of(k, 0u, arrival(k, position, 0.0, normal), roughness, surface);
            continue;
        }
        for (var emitter = 0u; emitter < lighting.lights[k].emitter_count; emitter++) {
            sum += gloss_of(k, emitter, emitted(k, emitter, position), roughness, surface);
        }
    }
    let mirrored = reflect(-to_eye, normal);
    let reflected = 1.0 - fresnel_transmittance(lighting.eta, abs(dot(normal, to_eye)));
    // Nine harmonics hold no mirror image: the sky is seen as blurred as a matt surface would see it.
    let blurred = environment_irradiance(lighting.open_sky, mirrored) + environment_irradiance(lighting.shadowed_sky, mirrored);
    sum += blurred * (0.31830988 * reflected);
    for (var k = 0u; k < lighting.ambient_count; k++) {
        let inside = dot(mirrored, lighting.ambients[k].axis) >= lighting.ambients[k].cone_cosine;
        sum += select(vec3f(0.0), lighting.ambients[k].radiance * reflected, inside);
    }
    return sum;
}
