// Twist and bend about an upright axis, after Barr 1984, "Global and Local Deformations of Solid Primitives".

struct Warp {
    // Lower end of the axis, model units.
    foot: vec3f,
    // Along the smooth normal at rest, model units.
    inflate: f32,
    height: f32,
    // 1 / height; 0 where nothing twists or bends.
    per_height: f32,
    // Angles in turns: what is left of whole ones is then exact.
    twist: f32,
    bend: f32,
}

const TAU: f32 = 6.28318531;

// Taylor's series to the eleventh power, within 6e-8. WGSL's own sine may be 5e-4 off, which would show.
fn sine(turns: f32) -> f32 {
    let part = turns - round(turns);
    let x = TAU * select(part, sign(part) * 0.5 - part, abs(part) > 0.25);
    let q = x * x;
    return x * (1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0 * (1.0 - q / 72.0 * (1.0 - q / 110.0)))));
}

// 1 − cos, to full precision near 0.
fn versine(turns: f32) -> f32 {
    let half = sine(0.5 * turns);
    return 2.0 * half * half;
}

// sin x / x − 1.
fn sinc_less_one(turns: f32) -> f32 {
    let x = TAU * turns;
    if abs(x) < 0.03 { return -x * x / 6.0; }
    return sine(turns) / x - 1.0;
}

// Everything below adds displacements, so that no angle is exactly no movement.
fn twisted(warp: Warp, point: vec3f) -> vec3f {
    let from_foot = point - warp.foot;
    let turns = warp.twist * clamp(from_foot.y * warp.per_height, 0.0, 1.0);
    let s = sine(turns);
    let v = versine(turns);
    return point + vec3f(from_foot.z * s - from_foot.x * v, 0.0, -from_foot.x * s - from_foot.z * v);
}

fn bent(warp: Warp, point: vec3f) -> vec3f {
    let from_foot = point - warp.foot;
    let on_axis = clamp(from_foot.y, 0.0, warp.height);
    let beyond = from_foot.y - on_axis;
    let turns = warp.bend * (on_axis * warp.per_height);
    let s = sine(turns);
    let v = versine(turns);
    let up = sinc_less_one(turns);
    // (1 − cos x) / x = sin (x/2) · sin (x/2) / (x/2)
    let aside = sine(0.5 * turns) * (1.0 + sinc_less_one(0.5 * turns));
    return point + vec3f(on_axis * aside + beyond * s - from_foot.x * v, on_axis * up - beyond * v - from_foot.x * s, 0.0);
}

fn warped(warp: Warp, point: vec3f) -> vec3f {
    return bent(warp, twisted(warp, point));
}
