// The kernels of the boundary equation: fluence G of point sources in the volume, and its derivative at sources along their first moment.
// The dual sum (`dual.wgsl`) adds up, channel by channel, at sites or under them,
//   light            φ_Q, of what entered
//   the surface      Σ A [(c_G φ − 4 c_G Γ) G + φ H], and in w how much of all directions is body: c

override LIGHT: bool = true;
// Whether receivers lie under the sites, in each channel as deep as `layer_depth` says, and in w at the mean of that.
override BELOW: bool = false;

@group(0) @binding(2) var<storage, read> charges: array<Charge>;
@group(0) @binding(7) var<uniform> transport: Transport;
@group(0) @binding(8) var<storage, read> shapes: array<Shape>;
@group(0) @binding(9) var<storage, read> strata: array<Strata>;

const QUARTER_PI_INVERSE: f32 = 0.07957747;
// The least square of a distance, mm².
const LEAST_R2: f32 = 1e-12;
// Where light scatters first no more than this share of the distance away, it is one source and how far that is spread out.
const SHALLOW: f32 = 0.6;
// A source's second moments change what it sends by no more than this share of it.
const MOST_CORRECTION: f32 = 1.0;

// Least square of a distance over those of the source's and the receivers' sizes.
const NEAREST: f32 = 4.0;
// Square of a mean normal that says which way its source faces.
const LEAST_NORMAL: f32 = 0.3;
// Over the square of a disc's radius.
const BLUNT: f32 = 0.03;

// To second order around a point, per mm⁰, mm¹, mm².
struct Expansion {
    value: vec4f,
    x: vec4f,
    y: vec4f,
    z: vec4f,
    xx: vec4f,
    yy: vec4f,
    zz: vec4f,
    xy: vec4f,
    xz: vec4f,
    yz: vec4f,
}

// The expansion about a point so far away in each channel.
fn moved_apart(e: Expansion, d: Places) -> Expansion {
    var m = e;
    let hx = e.xx * d.x + e.xy * d.y + e.xz * d.z;
    let hy = e.xy * d.x + e.yy * d.y + e.yz * d.z;
    let hz = e.xz * d.x + e.yz * d.y + e.zz * d.z;
    m.value += (e.x + 0.5 * hx) * d.x + (e.y + 0.5 * hy) * d.y + (e.z + 0.5 * hz) * d.z;
    m.x += hx;
    m.y += hy;
    m.z += hz;
    return m;
}

// A vector for each channel, component by component, mm. Groups of receivers are where their texels are that are looked at: in each channel elsewhere.
alias Place = Places;
struct Places {
    x: vec4f,
    y: vec4f,
    z: vec4f,
}

fn together(d: vec3f) -> Places {
    return Places(vec4f(d.x), vec4f(d.y), vec4f(d.z));
}

fn minus(p: Places, q: Places) -> Places {
    return Places(p.x - q.x, p.y - q.y, p.z - q.z);
}

fn beyond(p: Places, direction: vec3f, ways: vec4f) -> Places {
    return Places(p.x + direction.x * ways, p.y + direction.y * ways, p.z + direction.z * ways);
}

fn square(p: Places) -> vec4f {
    return p.x * p.x + p.y * p.y + p.z * p.z;
}

// G and its derivatives by r².
struct Jet {
    value: vec4f,
    first: vec4f,
    second: vec4f,
    third: vec4f,
}

fn potential_jet(r2: vec4f) -> Jet {
    let inverse = 1.0 / r2;
    let r = sqrt(r2);
    let x = transport.decay * r;
    let value = QUARTER_PI_INVERSE / transport.diffusion * exp(-x) * r * inverse;
    let first = -0.5 * inverse * (1.0 + x);
    let second = 0.25 * inverse * inverse * (3.0 + x * (3.0 + x));
    let third = -0.125 * inverse * inverse * inverse * (15.0 + x * (15.0 + x * (6.0 + x)));
    return Jet(value, value * first, value * second, value * third);
}

// A symmetric matrix between a vector and itself.
fn between(m: Moments, o: Places) -> vec4f {
    return m.diagonal.x * o.x * o.x + m.diagonal.y * o.y * o.y + m.diagonal.z * o.z * o.z
        + 2.0 * (m.mixed.x * o.x * o.y + m.mixed.y * o.x * o.z + m.mixed.z * o.y * o.z);
}

// By how much more a source sends than a point, its power and its moment: half its second moments times the second derivatives, over the value.
struct More {
    power: vec4f,
    moment: vec4f,
}

// Power that is spread out along a direction, too: the mean square of its way, mm².
struct Line {
    direction: vec3f,
    square: vec4f,
}

fn spread_out(jet: Jet, o: Places, shape: Shape, line: Line) -> More {
    let along = 2.0 * between(unpacked_moments(shape.moments), o);
    let square = shape.spread * shape.spread;
    let u = line.direction;
    let down = o.x * u.x + o.y * u.y + o.z * u.z;
    let of_line = line.square * (2.0 * down * down * jet.second + dot(u, u) * jet.first);
    let power = (square * (along * jet.second + jet.first) + of_line) / max(jet.value, vec4f(1e-30));
    let moment = square * (along * jet.third + jet.second) / min(jet.first, vec4f(-1e-30));
    let least = vec4f(-0.5 * MOST_CORRECTION);
    return More(1.0 + clamp(power, least, vec4f(MOST_CORRECTION)), 1.0 + clamp(moment, least, vec4f(MOST_CORRECTION)));
}

// What dipoles send that do not all stand in the middle, nor all the same way: their normals' first moments times the second derivatives.
fn turned(c: Charge, jet: Jet, o: Places, shape: Shape) -> vec4f {
    let n = shape.normal;
    let square = dot(n, n);
    // Flux through the area, were it flat. Where normals cancel nobody knows it; light has none.
    if LIGHT || square < LEAST_NORMAL { return vec4f(0.0); }
    let whole = (c.x * n.x + c.y * n.y + c.z * n.z) / square;
    let turns = unpacked_moments(shape.turns);
    let trace = turns.diagonal.x + turns.diagonal.y + turns.diagonal.z;
    return shape.spread * whole * (4.0 * between(turns, o) * jet.second + 2.0 * trace * jet.first);
}

// Adds power and first moment so far from receivers of this size. Light that came in aslant may scatter under them although its cluster is not near:
// then it is taken to be as far as clusters are that count.
fn add(e: ptr<function, Expansion>, c: Charge, o: Places, shape: Shape, size: f32, line: Line) {
    let jet = potential_jet(max(square(o), vec4f(NEAREST * (shape.spread * shape.spread + size * size) + LEAST_R2)));
    let more = spread_out(jet, o, shape, line);
    let q = c.power * more.power;
    let v = Places(c.x * more.moment, c.y * more.moment, c.z * more.moment);
    let t = v.x * o.x + v.y * o.y + v.z * o.z;
    (*e).value += q * jet.value - 2.0 * t * jet.first + turned(c, jet, o, shape);
    // Of the offset, of the moment, of both.
    let a = 2.0 * q * jet.first - 4.0 * t * jet.second;
    let b = -2.0 * jet.first;
    (*e).x += a * o.x + b * v.x;
    (*e).y += a * o.y + b * v.y;
    (*e).z += a * o.z + b * v.z;
    let s = 4.0 * q * jet.second - 8.0 * t * jet.third;
    let m = -4.0 * jet.second;
    (*e).xx += s * o.x * o.x + a + 2.0 * m * v.x * o.x;
    (*e).yy += s * o.y * o.y + a + 2.0 * m * v.y * o.y;
    (*e).zz += s * o.z * o.z + a + 2.0 * m * v.z * o.z;
    (*e).xy += s * o.x * o.y + m * (v.x * o.y + v.y * o.x);
    (*e).xz += s * o.x * o.z + m * (v.x * o.z + v.z * o.x);
    (*e).yz += s * o.y * o.z + m * (v.y * o.z + v.z * o.y);
}

fn receiving_place(level: u32, node: u32, middle: vec3f) -> Place {
    if !BELOW { return together(middle); }
    return beyond(together(middle), -shapes[source_index(level, node)].normal, below(node << (2u * level)));
}

fn texel_place(texel: u32, position: vec3f) -> Place {
    if !BELOW { return together(position); }
    return beyond(together(position), -shapes[texel].normal, below(texel));
}

// Sources of light are where those of the surface are, but nothing where it is dark.
fn source_bounds(source: u32) -> vec4f {
    return bounds[select(0u, transport.light_bounds, LIGHT) + source];
}

fn source_charge(source: u32) -> Charge {
    return charges[select(transport.source_count, 0u, LIGHT) + source];
}

// From what a source sends to receivers, squared, mm²: of light that entered from where it may scatter first, in the nearest of the channels.
fn distance_square(source: u32, seen: vec4f, place: Place) -> f32 {
    let o = minus(place, together(seen.xyz));
    var r2 = square(o);
    if LIGHT && seen.w > 0.0 {
        let u = strata[source].direction;
        let along = (o.x * u.x + o.y * u.y + o.z * u.z) / max(dot(u, u), 1e-12);
        r2 = square(beyond(o, -u, clamp(along, vec4f(0.0), way_of(source, STRATA - 2u))));
    }
    return min(r2.x, min(r2.y, r2.z));
}

// G is singular: near is near.
fn smooth_square(texel: u32) -> f32 {
    return scatter.z_r_squared;
}

fn moved_to(e: Expansion, before: Place, place: Place) -> Expansion {
    return moved_apart(e, minus(place, before));
}

// What a source sends, one part after the other: light in its strata, or in one where they are hardly apart, and what the surface sends. A loop, for
// software adapters run through every branch.
struct Parts {
    charge: Charge,
    direction: vec3f,
    normal: vec3f,
    count: u32,
}

fn parts(source: u32, d: Places) -> Parts {
    var p: Parts;
    p.charge = source_charge(source);
    p.count = 1u;
    if LIGHT {
        p.direction = strata[source].direction;
        p.normal = shapes[source].normal;
        let r2 = square(d);
        let reach = strata[source].mean.w;
        p.count = select(STRATA, 1u, reach * reach < SHALLOW * SHALLOW * min(min(r2.x, r2.y), r2.z));
    }
    return p;
}

struct Part {
    offset: Places,
    line: Line,
    charge: Charge,
}

fn part(p: ptr<function, Parts>, source: u32, d: Places, k: u32) -> Part {
    let whole = (*p).charge;
    if !LIGHT { return Part(d, Line(vec3f(0.0), vec4f(0.0)), whole); }
    let u = (*p).direction;
    let up = (*p).normal;
    if (*p).count == 1u {
        let way = vec4f(strata[source].mean.rgb, 0.0);
        return Part(beyond(beyond(d, -u, way), -up, strata[source].rise), Line(u, strata[source].square), whole);
    }
    let share = SHARES[k];
    let charge = Charge(share * whole.power, share * whole.x, share * whole.y, share * whole.z);
    return Part(beyond(beyond(d, -u, way_of(source, k)), -up, vec4f(strata[source].rises[k].rgb, 0.0)), Line(u, vec4f(0.0)), charge);
}

// Adds what a source sends to a group of receivers of this size.
fn collect(e: ptr<function, Expansion>, source: u32, place: Place, size: f32) {
    let d = minus(place, together(bounds[source].xyz));
    var all = parts(source, d);
    for (var k = 0u; k < all.count; k++) {
        let own = part(&all, source, d, k);
        add(e, own.charge, own.offset, shapes[source], size, own.line);
    }
}

fn way_of(source: u32, k: u32) -> vec4f {
    return vec4f(strata[source].ways[k].rgb, 0.0);
}

fn count_evaluations(e: ptr<function, Expansion>, share: f32) {
}

// Depth of the receivers under a texel.
fn below(texel: u32) -> vec4f {
    if !BELOW { return vec4f(0.0); }
    return layer_depth(strata[texel].ways[1].w);
}

// What an expansion says of a texel.
fn settled(e: Expansion, texel: u32, place: Place) -> vec4f {
    let own = beyond(together(bounds[texel].xyz), -shapes[texel].normal, below(texel));
    return moved_to(e, place, own).value;
}

// What a source sends to a texel.
fn arriving(source: u32, texel: u32, receiver: vec3f) -> vec4f {
    let d = beyond(together(receiver - bounds[source].xyz), -shapes[texel].normal, below(texel));
    var sum = vec4f(0.0);
    var all = parts(source, d);
    for (var k = 0u; k < all.count; k++) {
        let own = part(&all, source, d, k);
        sum += sent(own.charge, own.offset, shapes[source], own.line);
    }
    return sum;
}

// Receivers on and under a source see it as a disc.
fn sent(c: Charge, o: Places, shape: Shape, line: Line) -> vec4f {
    let r2 = square(o);
    let a2 = 2.0 * shape.spread * shape.spread;
    let jet = potential_jet(max(r2, vec4f(LEAST_R2)));
    let t = c.x * o.x + c.y * o.y + c.z * o.z;
    let more = spread_out(jet, o, shape, line);
    let of_point = c.power * jet.value * more.power - 2.0 * t * more.moment * jet.first + turned(c, jet, o, shape);
    let near = r2 < vec4f(2.0 * a2);
    var sum = of_point;
    // A loop in place of a branch, as above.
    for (var k = select(1u, 0u, any(near)); k < 1u; k++) {
        sum = select(of_point, of_disc(c, o, r2, a2, safe_normalize(shape.normal, vec3f(0.0))), near);
    }
    return sum;
}

// A disc of radius √a2 about whose axis the receiver is: on it in closed form, beside it as from further up, which is within 2 % in its plane.
fn of_disc(c: Charge, o: Places, r2: vec4f, a2: f32, normal: vec3f) -> vec4f {
    let height = normal.x * o.x + normal.y * o.y + normal.z * o.z;
    let beside2 = max(r2 - height * height, vec4f(0.0));
    let up2 = height * height + 0.2025 / (a2 * a2) * beside2 * beside2 * beside2;
    let up = sqrt(up2);
    let edge = sqrt(up2 + a2);
    let way = a2 / (edge + up);
    let decayed = exp(-transport.decay * up);
    let at_edge = exp(-transport.decay * edge);
    let x = transport.decay * way;
    // ∫ e^−σR dR from up to edge.
    let held = select((decayed - at_edge) / max(transport.decay, vec4f(1e-20)), way * decayed, x < vec4f(1e-3));
    let scale = 2.0 / a2 * QUARTER_PI_INVERSE / transport.diffusion;
    let flux = c.x * normal.x + c.y * normal.y + c.z * normal.z;
    // Discs overlap where texels of different areas meet, and nobody is under a neighbour: beside the axis that is blunt.
    let blunt = BLUNT * a2 * beside2 / (beside2 + vec4f(BLUNT * BLUNT * a2));
    let steep = select(abs(height) / sqrt(max(up2 + blunt, vec4f(1e-30))) * decayed, vec4f(0.0), height == vec4f(0.0)) - abs(height) / edge * at_edge;
    return scale * (c.power * held + sign(height) * flux * steep);
}

fn finished(sum: vec4f, texel: u32) -> vec4f {
    return sum;
}
