// What the dual sum of exitance asks of a kernel of irradiance (`kernel/chord.wgsl`, `kernel/oriented.wgsl`).

@group(0) @binding(2) var<storage, read> lamps: array<Lamp>;
@group(0) @binding(7) var kernel_table: texture_2d<f32>;

// Where a group of receivers is.
alias Place = vec3f;

fn receiving_place(level: u32, node: u32, middle: vec3f) -> Place {
    return middle;
}

fn texel_place(texel: u32, position: vec3f) -> Place {
    return position;
}

// Where what a source sends comes from, and how large that is.
fn source_bounds(source: u32) -> vec4f {
    return bounds[source];
}

// From there to receivers, squared, mm².
fn distance_square(source: u32, seen: vec4f, place: Place) -> f32 {
    let offset = place - seen.xyz;
    return dot(offset, offset);
}

// Square of the length below which what is summed up is smooth around a texel, mm².
fn smooth_square(texel: u32) -> f32 {
    return scatter.z_r_squared;
}

// The expansion about another place.
fn moved_to(e: Expansion, before: Place, place: Place) -> Expansion {
    return moved(e, place - before);
}

// Adds what a source sends to a group of receivers of this size.
fn collect(e: ptr<function, Expansion>, source: u32, place: Place, size: f32) {
    // Derivatives by r² lose their digits where r hardly counts.
    collect_lamp(e, lamps[source], place - bounds[source].xyz, max(0.01 * size * size, scatter.table.least_r2));
}

fn count_evaluations(e: ptr<function, Expansion>, share: f32) {
    (*e).evaluations += share;
}

// What an expansion says of a texel.
fn settled(e: Expansion, texel: u32, place: Place) -> vec4f {
    return vec4f(leaving(moved(e, bounds[texel].xyz - place), lamps[texel].normal), e.evaluations);
}

// What a source sends to a texel, and the one evaluation it took.
fn arriving(source: u32, texel: u32, receiver: vec3f) -> vec4f {
    return sent(source, texel, receiver, lamps[texel].normal);
}

fn finished(sum: vec4f, texel: u32) -> vec4f {
    // Where hardly any light comes, an expansion may dip below none.
    return max(sum, vec4f(0.0)) * vec4f(marked_tint(lamps[texel].marks), 1.0);
}
