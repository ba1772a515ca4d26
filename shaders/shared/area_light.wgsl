// Irradiance from lights with an area, for unit radiance on a surface that everything enters (eta = 1), cut off by its horizon.
// The including module declares the uniform `lighting`.

fn area_irradiance(index: u32, position: vec3f, normal: vec3f) -> f32 {
    if lighting.lights[index].kind == SPHERE {
        return sphere_irradiance(lighting.lights[index].vector - position, lighting.lights[index].half_right.x, normal);
    }
    let offset = lighting.lights[index].vector - position;
    return rectangle_irradiance(offset, lighting.lights[index].half_right, lighting.lights[index].half_up, lighting.lights[index].axis, normal);
}

// Outwards from an area light's emitter.
fn emitter_normal(index: u32, emitter: vec3f) -> vec3f {
    if lighting.lights[index].kind == SPHERE { return safe_normalize(emitter - lighting.lights[index].vector, vec3f(0.0, 1.0, 0.0)); }
    return lighting.lights[index].axis;
}

// Snyder 1969, "Radiant Interchange Configuration Factors between Spheres and …", for a sphere that the horizon may cut.
// offset: to its middle, mm
fn sphere_irradiance(offset: vec3f, radius: f32, normal: vec3f) -> f32 {
    let distance_squared = dot(offset, offset);
    if distance_squared <= radius * radius { return 0.0; }
    let cosine = dot(normal, offset) * inverseSqrt(distance_squared);
    let share = radius * radius / distance_squared;
    if cosine * cosine > share { return 3.14159265 * share * max(cosine, 0.0); }
    let sine = sqrt(max(1.0 - cosine * cosine, 1e-12));
    let x = sqrt(max(1.0 / share - 1.0, 1e-12));
    let y = clamp(-x * cosine / sine, -1.0, 1.0);
    let cut = sine * sqrt(1.0 - y * y);
    return max((cosine * acos(y) - x * cut) * share + atan(cut / x), 0.0);
}

// Lambert's formula: half the sum over the edges of the angle they subtend times the cosine of the plane through them.
fn rectangle_irradiance(offset: vec3f, right: vec3f, up: vec3f, axis: vec3f, normal: vec3f) -> f32 {
    let front = -dot(axis, offset);
    if front <= 0.0 { return 0.0; }
    let distance_squared = dot(offset, offset);
    // Far off the edges' terms cancel, and the rectangle is a point to within a ten thousandth.
    if distance_squared > 1e4 * max(dot(right, right), dot(up, up)) {
        let area = 4.0 * length(cross(right, up));
        return area * front * max(dot(normal, offset), 0.0) / (distance_squared * distance_squared);
    }
    // Seen from the front, in the order that makes the sum positive.
    var corner = offset + right + up;
    var sum = 0.0;
    var leaves = vec3f(0.0);
    var enters = vec3f(0.0);
    for (var k = 0u; k < 4u; k++) {
        let next = offset + select(right, -right, k == 0u || k == 1u) + select(up, -up, k == 1u || k == 2u);
        let height = dot(normal, corner);
        let next_height = dot(normal, next);
        var a = corner;
        var b = next;
        if height * next_height < 0.0 {
            let horizon = mix(corner, next, height / (height - next_height));
            if height > 0.0 {
                b = horizon;
                leaves = horizon;
            } else {
                a = horizon;
                enters = horizon;
            }
        }
        if height > 0.0 || next_height > 0.0 { sum += edge_irradiance(a, b, normal); }
        corner = next;
    }
    // The cut runs along the horizon.
    sum += edge_irradiance(leaves, enters, normal);
    return max(-0.5 * sum, 0.0);
}

fn edge_irradiance(a: vec3f, b: vec3f, normal: vec3f) -> f32 {
    let first = safe_normalize(a, vec3f(0.0));
    let last = safe_normalize(b, vec3f(0.0));
    let across = cross(first, last);
    let sine = length(across);
    let angle = atan2(sine, dot(first, last));
    return dot(normal, across) * select(angle / sine, 1.0, sine < 1e-6);
}
