// The kernel of radial profiles: R_d of the straight line from source to receiver. A kernel is `sent`, `collect_lamp` and `leaving`.
// The module declares `scatter`, with its table and terms, `bounds`, `lamps` and `kernel_table`.

// What a source sends to a point, and the one evaluation it took. own: the texel in whose middle the point is
fn sent(source: u32, own: u32, receiver: vec3f, normal: vec3f) -> vec4f {
    return vec4f(received(scatter.table, receiver - bounds[source].xyz, lamps[source], source == own), 1.0);
}

// Adds what one source sends to the receivers about a point `d` from it.
fn collect_lamp(e: ptr<function, Expansion>, lamp: Lamp, d: vec3f, least_r2: f32) {
    let c2 = scale_square(lamp);
    let r2 = max(c2 * dot(d, d), least_r2);
    let jet = profile_jet(scatter.table, kernel_table, r2, c2 * lamp.spread * lamp.spread, facing(d, lamp));
    add(e, c2 * lamp.power, Jet(jet.value, c2 * jet.first, c2 * c2 * jet.second), Offsets(vec3f(d.x), vec3f(d.y), vec3f(d.z)));
}

// What an expansion says that leaves along a normal.
fn leaving(e: Expansion, normal: vec3f) -> vec3f {
    return e.value;
}
