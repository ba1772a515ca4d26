// A group of texels seen as one source. Lengths in mm.
struct Cluster {
    // Power-weighted centroid.
    centroid: vec3f,
    // Power-weighted rms radius, the members' own discs included.
    spread: f32,
    // Sum of E·A, RGB.
    power: vec3f,
    // No member's centre is further from the centroid.
    radius: f32,
    // Power-weighted mean normal, unit length, or zero where it cancels.
    normal: vec3f,
    // Sum of live areas, mm².
    area: f32,
}

// The same texels seen as one receiver, each counting alike, lit or not. Lengths in mm.
struct Receiver {
    // Mean of the texels' positions.
    centre: vec3f,
    // Rms distance of the texels from it.
    spread: f32,
    // No texel is further from the centre.
    radius: f32,
    // Those that are needed, and the only ones that count.
    texels: u32,
    padding0: u32,
    padding1: u32,
}

// Size of a group of receivers of which no picture needs one.
const NOT_NEEDED: f32 = -1.0;

// Texels are squares and tile the surface; discs of their areas overlap along the axes and leave gaps at the corners. Seen from the
// middle of a texel, its neighbours' discs reach too far in: by up to 1.9 %, or narrower by this factor 0.6 %, which the kernel table takes
// from what a texel sends to itself.
const NEIGHBOUR_NARROWING: f32 = 0.945;

// A cluster or, as any other sees it, a texel as a source whose place is known.
struct Lamp {
    power: vec3f,
    spread: f32,
    normal: vec3f,
    // Of a texel all its marks, of a cluster those of how far light wanders.
    marks: u32,
    // Second moments of the power over their trace, spread²: xx yy, zz xy, xz yz.
    moments: vec3u,
    padding: u32,
}

// A symmetric matrix.
struct Moments {
    // xx yy zz
    diagonal: vec3f,
    // xy xz yz
    mixed: vec3f,
}

// Of a texel: a disc.
fn disc_moments(normal: vec3f) -> Moments {
    return Moments(0.5 - 0.5 * normal * normal, -0.5 * normal.xxy * normal.yzz);
}

fn packed_moments(m: Moments) -> vec3u {
    return vec3u(
        pack2x16snorm(m.diagonal.xy), pack2x16snorm(vec2f(m.diagonal.z, m.mixed.x)), pack2x16snorm(m.mixed.yz));
}

fn unpacked_moments(m: vec3u) -> Moments {
    let a = unpack2x16snorm(m.x);
    let b = unpack2x16snorm(m.y);
    return Moments(vec3f(a, b.x), vec3f(b.y, unpack2x16snorm(m.z)));
}

// What a texel is marked with, in one word: whether a vertex stands on it, how far light wanders under it, and the square root of its albedo.
const VERTEX_MARK: u32 = 0x80000000u;

// Factor on the scattering coefficients, in thirtieths of an octave from 1/4 to 4.
fn marked_scale(marks: u32) -> f32 {
    return exp2((f32((marks >> 24u) & 127u) - 64.0) / 30.0);
}

fn scale_mark(scale: f32) -> u32 {
    return u32(clamp(round(30.0 * log2(scale)) + 64.0, 0.0, 127.0)) << 24u;
}

// What albedo lets in, and again what it lets out.
fn marked_tint(marks: u32) -> vec3f {
    return unpack4x8unorm(marks).rgb;
}

// Size of a lit texel, which has none: the least that is not 0.
const NO_SIZE: f32 = 1e-30;

// How far a group of texels reaches, for opening angles. The rms radius alone would forget the odd texel far out, the bound alone take every
// group for as large as its worst.
fn size_of(spread: f32, radius: f32) -> f32 {
    return max(1.6 * spread, 0.9 * radius);
}

// Rms radius of a disc of this area.
fn disc_spread(area: f32) -> f32 {
    return sqrt(area * 0.15915494);
}

// Nodes of a level of the tree; level 0 is the texels.
fn level_count(texel_count: u32, level: u32) -> u32 {
    return ((texel_count - 1u) >> (2u * level)) + 1u;
}

// A node of a level.
struct Step {
    level: u32,
    node: u32,
}

// From a node that is done with all below it to the next in a walk down from the top level, which ends there.
fn passed(texel_count: u32, top_level: u32, at: Step) -> Step {
    var next = Step(at.level, at.node + 1u);
    while next.level < top_level && (next.node % 4u == 0u || next.node >= level_count(texel_count, next.level)) {
        next.node = (next.node + 3u) / 4u;
        next.level += 1u;
    }
    return next;
}
