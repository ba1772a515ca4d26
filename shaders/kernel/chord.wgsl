// The kernel of radial profiles: R_d of the straight line from source to receiver. A kernel is `sent`, `collect` and `leaving`.

// What a source sends to a point, and the one evaluation it took. own: the texel in whose middle the point is
fn sent(source: u32, own: u32, receiver: vec3f, normal: vec3f) -> vec4f {
    let lamp = lamps[source];
    let spread = lamp.spread * select(1.0, 1.0 / NEIGHBOUR_NARROWING, source == own);
    return vec4f(received(dual.table, receiver, Source(bounds[source].xyz, spread, lamp.normal, lamp.power)), 1.0);
}

// Adds what one source sends to the receivers about a point `d` from it.
fn collect(e: ptr<function, Expansion>, lamp: Lamp, d: vec3f, least_r2: f32) {
    let jet = profile_jet(dual.table, kernel_table, max(dot(d, d), least_r2), lamp.spread * lamp.spread, facing_square(d, lamp.normal));
    let first = 2.0 * lamp.power * jet.first;
    let second = 4.0 * lamp.power * jet.second;
    (*e).value += lamp.power * jet.value;
    (*e).x += first * d.x;
    (*e).y += first * d.y;
    (*e).z += first * d.z;
    (*e).xx += second * (d.x * d.x) + first;
    (*e).yy += second * (d.y * d.y) + first;
    (*e).zz += second * (d.z * d.z) + first;
    (*e).xy += second * (d.x * d.y);
    (*e).xz += second * (d.x * d.z);
    (*e).yz += second * (d.y * d.z);
}

// What an expansion says that leaves along a normal.
fn leaving(e: Expansion, normal: vec3f) -> vec3f {
    return e.value;
}
