fn safe_normalize(v: vec3f, fallback: vec3f) -> vec3f {
    let length_squared = dot(v, v);
    if length_squared > 0.0 { return v * inverseSqrt(length_squared); }
    return fallback;
}

fn any_perpendicular(n: vec3f) -> vec3f {
    let axis = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(n.x) > 0.7);
    return safe_normalize(cross(axis, n), axis);
}
