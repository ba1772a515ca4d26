// The kernel of sources off the surface: each term is a potential K about a point on the source's normal, and what leaves is its flux
// through the receiver's, −∇K·n. The table holds K.

// With scattering c times as strong depths become c times shorter, and K(r) becomes c·K(c·r).

// From each channel's source of a term to the receiver.
fn offsets(term: Term, lamp: Lamp, d: vec3f) -> Offsets {
    let depth = term.depth * inverseSqrt(scale_square(lamp));
    return Offsets(d.x + depth * lamp.normal.x, d.y + depth * lamp.normal.y, d.z + depth * lamp.normal.z);
}

// K and its derivatives by r², each channel at its own r.
fn jet_of_term(o: Offsets, lamp: Lamp, spread: f32, least_r2: f32) -> Jet {
    if MONOCHROME { return jet_of_channel(vec3f(o.x.x, o.y.x, o.z.x), lamp, spread, least_r2); }
    let red = jet_of_channel(vec3f(o.x.x, o.y.x, o.z.x), lamp, spread, least_r2);
    let green = jet_of_channel(vec3f(o.x.y, o.y.y, o.z.y), lamp, spread, least_r2);
    let blue = jet_of_channel(vec3f(o.x.z, o.y.z, o.z.z), lamp, spread, least_r2);
    return Jet(
        vec3f(red.value.x, green.value.y, blue.value.z),
        vec3f(red.first.x, green.first.y, blue.first.z),
        vec3f(red.second.x, green.second.y, blue.second.z));
}

fn jet_of_channel(d: vec3f, lamp: Lamp, spread: f32, least_r2: f32) -> Jet {
    let c2 = scale_square(lamp);
    let jet = profile_jet(scatter.table, kernel_table, max(c2 * dot(d, d), least_r2), c2 * spread * spread, facing(d, lamp));
    let c = sqrt(c2);
    return Jet(c * jet.value, c * c2 * jet.first, c * c2 * c2 * jet.second);
}

// What a source sends to a point, and the one evaluation it took. own: the texel in whose middle the point is
fn sent(source: u32, own: u32, receiver: vec3f, normal: vec3f) -> vec4f {
    let lamp = lamps[source];
    let spread = lamp.spread * select(1.0, 1.0 / NEIGHBOUR_NARROWING, source == own);
    var flux = vec3f(0.0);
    for (var k = 0u; k < 2u; k++) {
        let o = offsets(scatter.terms[k], lamp, receiver - bounds[source].xyz);
        let jet = jet_of_term(o, lamp, spread, scatter.table.least_r2);
        flux -= scatter.terms[k].weight * jet.first * (o.x * normal.x + o.y * normal.y + o.z * normal.z);
    }
    return vec4f(2.0 * lamp.power * flux, 1.0);
}

// Adds what one source sends to the receivers about a point `d` from it.
fn collect_lamp(e: ptr<function, Expansion>, lamp: Lamp, d: vec3f, least_r2: f32) {
    for (var k = 0u; k < 2u; k++) {
        let o = offsets(scatter.terms[k], lamp, d);
        let jet = jet_of_term(o, lamp, lamp.spread, least_r2);
        add(e, lamp.power * scatter.terms[k].weight, jet, o);
    }
}

// What an expansion says that leaves along a normal.
fn leaving(e: Expansion, normal: vec3f) -> vec3f {
    return -(e.x * normal.x + e.y * normal.y + e.z * normal.z);
}
