// Picture: φ under the surface → radiance towards the eye, at every site, and light that scattered once or twice.

@group(0) @binding(0) var<uniform> transport: Transport;
@group(0) @binding(1) var<uniform> lighting: Gather;
@group(0) @binding(2) var<storage, read> nodes: array<Node>;
@group(0) @binding(3) var<storage, read> site_positions: array<vec4f>;
@group(0) @binding(4) var<storage, read> site_normals: array<vec4f>;
@group(0) @binding(5) var<storage, read> parabolas: array<Parabola>;
@group(0) @binding(6) var<storage, read_write> site_exitance: array<vec4f>;
@group(0) @binding(7) var<storage, read> charges: array<Charge>;
@group(0) @binding(8) var<storage, read> strata: array<Strata>;
@group(0) @binding(9) var<storage, read> shapes: array<Shape>;

const PI: f32 = 3.14159265;
// Parabolas end at this many depths of the value below the surface, and no further than this share of a ray.
const REACH: f32 = 1.6;
const MOST_OF_RAY: f32 = 0.35;
// Where along a ray of view other sites than the one that is seen tell how light is there, mean free paths.
const ALONG: vec2f = vec2f(0.6, 1.6);
// No further than this share of it.
const MOST_ALONG: f32 = 0.5;
// How much more light there may be a mean free path further in: a ray that looks through a gap at a lit site is no speck of light. Under a plane that is lit
// from afar it is .7 of what there is at one.
const MOST_GROWTH: f32 = 2.5;
// Steps along a ray of view.
const STEPS: u32 = 10u;
// Surfaces that bend more, in mean free paths, count as those.
const MOST_BENT: f32 = 0.1;
// A ray that grazes the surface by less runs along it.
const GRAZING: f32 = 0.02;

// Depth of a ray that leaves at this cosine, so far from where it does, mm.
fn depth_along(thickness: f32, cosine: f32, s: vec3f, chord: f32) -> vec3f {
    let short = clamp(1.0 - chord * cosine / max(thickness, 1e-12), 0.0, 1.0);
    return cosine * s * (1.0 - short * s / chord);
}

// φ at a depth, less the particular solution of light that enters there.
fn fluence_at(p: Parabola, at: Deep) -> vec3f {
    let shifted = (at.optical - at.shift) / transport.extinction.rgb;
    return p.surface + shifted * (p.slope + shifted * p.curve);
}

// As seen from the eye: what leaves if all that leaves were as bright as what goes there.
@compute @workgroup_size(64)
fn gathered(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= transport.site_count { return; }
    let place = site_positions[index];
    let normal = normalize(site_normals[index].xyz);
    let outside = normalize(place.xyz - transport.eye);
    let facing = -dot(outside, normal);
    // Beyond the rim a site may be seen that is turned away itself.
    if facing < -0.2 { return; }
    let cosine = max(refracted_cosine(transport.eta, max(facing, 0.0)), GRAZING);
    let direction = select((outside + facing * normal) / transport.eta - cosine * normal, outside, transport.eta == 1.0);
    let width = sqrt(place.w);
    let far = first_crossing(place.xyz, direction, 0.1 * width, 1.0);
    let chord = max(far.t, 1e-6);
    var sight: Sight;
    sight.own = parabolas[index];
    sight.other = sight.own;
    sight.places = ALONG * 3.0 / (transport.extinction.x + transport.extinction.y + transport.extinction.z);
    let first = site_above(index, place.xyz + direction * sight.places.x, normal, sight.places.x < MOST_ALONG * chord);
    let second = site_above(first, place.xyz + direction * sight.places.y, normal, sight.places.y < MOST_ALONG * chord);
    sight.first = parabolas[first];
    sight.second = parabolas[second];
    sight.cosine = cosine;
    sight.there = cosine;
    sight.chord = chord;
    sight.ends = far.site != NO_SITE;
    if sight.ends {
        sight.other = parabolas[far.site];
        sight.there = max(dot(normalize(site_normals[far.site].xyz), direction), GRAZING);
    }
    // What diffusion lacks of light that scattered again comes last.
    let again = many(sight);
    let most = thrown_back(sight) + once(sight, place.xyz, direction, normal, width);
    let bend = clamp(sight.own.bulge / transport.extinction.rgb, vec3f(0.0), vec3f(MOST_BENT));
    let lacking = transport.shortfall.rgb * pow(cosine, -transport.lean) * (1.0 + transport.along * bend);
    // Light of lamps that entered close by; what comes from afar leaves as it does where all scatters evenly.
    let close = clamp(sight.own.light * (1.0 - sight.own.around) / max(PI * again, vec3f(1e-30)), vec3f(0.0), vec3f(1.0));
    let radiance = most + mix(vec3f(1.0), vec3f(balanced(cosine)), close) * (again + lacking * twice(place.xyz, direction, cosine, chord));
    // Outside light is η² times less bright; what leaves under other angles is a matter of the material.
    let leaves = PI * transport.open / (transport.eta * transport.eta);
    site_exitance[index] = vec4f(max(leaves * radiance, vec3f(0.0)), 0.0);
}

// A ray of view inside: from the site that is seen to the one at its other end, with the cosines there.
struct Sight {
    own: Parabola,
    other: Parabola,
    // Those that it passes under so far along it, mm.
    first: Parabola,
    second: Parabola,
    places: vec2f,
    cosine: f32,
    there: f32,
    // mm.
    chord: f32,
    // Whether the other end is known.
    ends: bool,
}

// Which site is above a place inside; if that is not to be asked, or there is none, the last one.
fn site_above(last: u32, place: vec3f, normal: vec3f, is_asked: bool) -> u32 {
    if !is_asked { return last; }
    let above = first_crossing(place, normal, 0.0, 1.0).site;
    return select(above, last, above == NO_SITE);
}

// Scattered more than once, as diffusion has it.
fn many(sight: Sight) -> vec3f {
    let extinction = transport.extinction.rgb;
    let chord = sight.chord;
    let own = sight.own;
    let other = sight.other;
    let share = 1.0 - exp(-min(extinction * chord, vec3f(80.0)));
    let most = vec3f(MOST_OF_RAY * chord);
    let begin = min(REACH * layer_depth(own.thickness).rgb / sight.cosine, most);
    let end = chord - min(REACH * layer_depth(other.thickness).rgb / sight.there, most);
    let near_begin = depth_along(own.thickness, sight.cosine, begin, chord);
    let near_end = depth_along(own.thickness, sight.cosine, end, chord);
    let far_begin = depth_along(other.thickness, sight.there, chord - begin, chord);
    let far_end = depth_along(other.thickness, sight.there, chord - end, chord);
    var before = max(fluence_along(sight, weights(sight, begin), deep_at(near_begin)), vec3f(0.0));
    let behind = max(fluence_at(other, deep_at(far_end)), vec3f(0.0)) + beam_along(sight, weights(sight, end), deep_at(near_end));
    var decay = transport.decay.rgb * sight.cosine;
    if sight.ends {
        before += beam_at(other, deep_at(far_begin));
        decay = 0.5 * transport.decay.rgb * (sight.cosine + sight.there);
    }
    let length = decay * (end - begin);
    var sum = vec3f(0.0);
    for (var k = 0u; k < STEPS; k++) {
        let part = (f32(k) + 0.5) / f32(STEPS);
        let s = min(-log(1.0 - part * share) / extinction, vec3f(chord));
        let near = deep_at(depth_along(own.thickness, sight.cosine, s, chord));
        let w = weights(sight, s);
        let from_own = beam_along(sight, w, near);
        let whole = fluence_along(sight, w, near);
        var value = whole - from_own;
        if sight.ends {
            let far = deep_at(depth_along(other.thickness, sight.there, chord - s, chord));
            let from_other = beam_at(other, far);
            let way = (s - begin) / (end - begin);
            let risen = before * rising(1.0 - way, length) + behind * rising(way, length);
            let inside = min(risen, before * (1.0 + MOST_GROWTH * extinction * (s - begin))) - from_own - from_other;
            let back = fluence_at(other, far) - from_other;
            value = select(select(inside, back, s >= end), value, s <= begin);
        } else {
            value = select(before * exp(-decay * (s - begin)) - from_own, value, s <= begin);
        }
        sum += max(value, vec3f(0.0));
    }
    return transport.albedo.rgb / (4.0 * PI) * share * sum / f32(STEPS);
}

// By the surface at the other end, of light that is there as bright in all directions.
fn thrown_back(sight: Sight) -> vec3f {
    if transport.eta == 1.0 || !sight.ends { return vec3f(0.0); }
    let surface = deep_at(vec3f(0.0));
    let fluence = max(fluence_at(sight.other, surface) - beam_at(sight.other, surface), vec3f(0.0));
    let reflected = 1.0 - fresnel_transmittance(1.0 / transport.eta, sight.there);
    return reflected * fluence / (4.0 * PI) * exp(-min(transport.extinction.rgb * sight.chord, vec3f(80.0)));
}

struct Weights {
    own: vec3f,
    first: vec3f,
    second: vec3f,
}

// How much the sites along a ray of view count so far along it: in between it is linear.
fn weights(sight: Sight, s: vec3f) -> Weights {
    let a = clamp(s / sight.places.x, vec3f(0.0), vec3f(1.0));
    let b = clamp((s - sight.places.x) / (sight.places.y - sight.places.x), vec3f(0.0), vec3f(1.0));
    return Weights(1.0 - a, a - b, b);
}

fn fluence_along(sight: Sight, w: Weights, at: Deep) -> vec3f {
    return w.own * fluence_at(sight.own, at) + w.first * fluence_at(sight.first, at) + w.second * fluence_at(sight.second, at);
}

fn beam_along(sight: Sight, w: Weights, at: Deep) -> vec3f {
    return w.own * beam_at(sight.own, at) + w.first * beam_at(sight.first, at) + w.second * beam_at(sight.second, at);
}

// sinh(y·length) / sinh(length): where there are no sources φ between two places is that of the way from either.
fn rising(y: vec3f, length: vec3f) -> vec3f {
    let x = max(length, vec3f(1e-3));
    return exp(-x * (1.0 - y)) * (1.0 - exp(-2.0 * x * y)) / (1.0 - exp(-2.0 * x));
}

// Where along a ray of view the way to the light is measured, in mean free paths of the channel that sees furthest. In between it is linear.
const PLACES: u32 = 7u;
const SPACING: array<f32, PLACES> = array<f32, PLACES>(0.0, 0.02, 0.08, 0.25, 0.8, 2.0, 5.0);

// Scattered once.
fn once(sight: Sight, position: vec3f, direction: vec3f, normal: vec3f, width: f32) -> vec3f {
    let extinction = transport.extinction.rgb;
    let chord = sight.chord;
    let longest = 1.0 / min(extinction.x, min(extinction.y, extinction.z));
    var sum = vec3f(0.0);
    for (var k = 0u; k < beam_count(); k++) {
        var before = vec3f(0.0);
        // Of the surface by which light enters, as far as that is known.
        var facet = normal;
        var way = 0.0;
        var optical = 0.0;
        for (var place = 0u; place < PLACES; place++) {
            let s = min(SPACING[place] * longest, chord);
            let at = min(max(s, 0.05 * width), 0.5 * (s + chord));
            if place == 0u && transport.eta != 1.0 { facet = arriving_at(k, position + direction * at, facet, width).facet; }
            var found = arriving_at(k, position + direction * at, facet, width);
            facet = found.facet;
            if place == 0u && found.is_here { found.way = 0.0; }
            found.light *= brighter(extinction * (s + found.way) + found.before, dot(found.to_light, direction), vec2f(max(dot(found.to_light, facet), GRAZING), sight.cosine));
            if place > 0u {
                let begins = extinction * optical;
                let passes = extinction * (s + found.way - optical);
                sum += 0.5 * (before + found.light) * extinction * (s - way) * transmitted(begins, passes);
            }
            before = found.light;
            way = s;
            optical = s + found.way;
        }
        // What is left goes on as it was.
        if way < chord { sum += 0.5 * before * exp(-min(extinction * optical, vec3f(80.0))); }
    }
    return transport.albedo.rgb / (4.0 * PI) * (sum + around(sight));
}

// Mean of what is left over a way that begins and passes through so much.
fn transmitted(begins: vec3f, passes: vec3f) -> vec3f {
    let x = clamp(passes, vec3f(-60.0), vec3f(80.0));
    return exp(-min(begins, vec3f(80.0))) * select((1.0 - exp(-x)) / x, vec3f(1.0), abs(x) < vec3f(1e-3));
}

struct Arriving {
    // W/m².
    light: vec3f,
    // How much of the way from the light is inside, mm.
    way: f32,
    // Whether light enters by the surface that is seen.
    is_here: bool,
    // Normal where it enters.
    facet: vec3f,
    // Inside.
    to_light: vec3f,
    // Mean free paths through what of the body is in its way.
    before: vec3f,
}

fn nothing_arriving(way: f32, facet: vec3f, to_light: vec3f) -> Arriving {
    return Arriving(vec3f(0.0), way, false, facet, to_light, vec3f(0.0));
}

// Of a light at a place inside, as if nothing were used up on the way.
fn arriving_at(index: u32, position: vec3f, facet: vec3f, width: f32) -> Arriving {
    let comes = beam(index, position, width * width, vec3f(0.0, 1.0, 0.0));
    if all(comes.strength <= vec3f(0.0)) { return nothing_arriving(0.0, facet, facet); }
    let is_straight = transport.eta == 1.0 || dot(facet, comes.to_light) <= 0.0;
    let to_surface = select(bent(comes.to_light, facet), comes.to_light, is_straight);
    let entry = crossing(position, to_surface, 0.0, comes.far, 1.0);
    if entry.site == NO_SITE { return nothing_arriving(0.0, facet, to_surface); }
    let normal = normalize(site_normals[entry.site].xyz);
    let outside = dot(normal, comes.to_light);
    var enters = 1.0;
    if transport.eta != 1.0 {
        if outside <= 0.0 { return nothing_arriving(entry.t, facet, to_surface); }
        enters = outside * fresnel_transmittance(transport.eta, outside) / max(refracted_cosine(transport.eta, outside), GRAZING);
    }
    let at = site_positions[entry.site].xyz;
    let is_dark = any(at < comes.low) || any(at > comes.high);
    let open = parabolas[entry.site].open;
    let before = -log(max(open, vec3f(1e-8)));
    return Arriving(select(enters * comes.strength * open, vec3f(0.0), is_dark), entry.t, entry.t < width, normal, to_surface, before);
}

// What light that turns once is over what it were if it scattered evenly: after so many mean free paths, by an angle of this cosine. Where it runs along the
// surface, coming in and going out at such cosines, some of it spreads out of the body.
fn brighter(optical: vec3f, cosine: f32, cosines: vec2f) -> vec3f {
    if transport.anisotropy == 0.0 { return vec3f(1.0); }
    let across = spread_step(0.5 - 0.5 * cosine);
    let depths = transport.albedo.rgb * optical / SPREAD_DEEPEST;
    var more: vec3f;
    for (var channel = 0u; channel < 3u; channel++) {
        let down = spread_step(depths[channel]);
        let row = u32(down);
        more[channel] = mix(spread_between(row, across), spread_between(row + 1u, across), down - f32(row));
    }
    let width = max(SPREAD_WIDTH * transport.albedo.rgb * optical, vec3f(1e-4));
    let stays = (1.0 - exp(-cosines.x / width)) * (1.0 - exp(-cosines.y / width));
    return 1.0 + select(more, more * stays, more > vec3f(0.0));
}

// The table of what spreads: its steps, and the depth of the last row in scattering lengths.
const SPREAD_STEPS: u32 = 16u;
const SPREAD_DEEPEST: f32 = 6.0;
// A beam is as wide as this share of its way, seen from where it runs along the surface.
const SPREAD_WIDTH: f32 = 0.15;

// Where a share of its range is in steps; there is one beyond.
fn spread_step(share: f32) -> f32 {
    return min(pow(clamp(share, 0.0, 1.0), 1.0 / 3.0), 0.99999) * f32(SPREAD_STEPS - 1u);
}

fn spread_between(row: u32, across: f32) -> f32 {
    let column = u32(across);
    return mix(spread_at(row, column), spread_at(row, column + 1u), across - f32(column));
}

fn spread_at(row: u32, column: u32) -> f32 {
    return transport.spread[row * SPREAD_STEPS / 4u + column / 4u][column % 4u];
}

// Of an even sky, used up along a ray of view: what comes in by this side and by the other.
fn around(sight: Sight) -> vec3f {
    let own = sight.own;
    let light = own.around * own.light;
    let light_there = select(vec3f(0.0), sight.other.around * sight.other.light, sight.ends);
    if all(light + light_there <= vec3f(0.0)) { return vec3f(0.0); }
    let extinction = transport.extinction.rgb;
    let share = 1.0 - exp(-min(extinction * sight.chord, vec3f(80.0)));
    var sum = vec3f(0.0);
    for (var k = 0u; k < STEPS; k++) {
        let part = (f32(k) + 0.5) / f32(STEPS);
        let s = min(-log(1.0 - part * share) / extinction, vec3f(sight.chord));
        let depth = depth_along(own.thickness, sight.cosine, s, sight.chord);
        var here = vec3f(0.0);
        var there = vec3f(0.0);
        for (var point = 0u; point < SKY_POINTS; point++) {
            let near = way_out(depth, own.thickness, own.bulge, sky_cosine(point));
            let far = way_out(own.thickness - depth, own.thickness, own.bulge, sky_cosine(point));
            here += sky_weight(point) * exp(-min(extinction * near, vec3f(80.0)));
            there += sky_weight(point) * exp(-min(extinction * far, vec3f(80.0)));
        }
        sum += light * here + light_there * there;
    }
    return share * sum / f32(STEPS);
}
