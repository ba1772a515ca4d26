// Twice: light that scattered once, straight to where a ray of view passes and scatters it again. The ray is strata, and so is the light of each site: discs
// of its area.

// Nothing comes from further, mean free paths of the channel that sees furthest.
const FURTHEST: f32 = 4.0;
// From so many on the strata of a site are one.
const ONE: f32 = 1.5;
// Opening angle, squared, of groups of sites, and how much further away they may be taken to be, mean free paths of the channel where they are shortest:
// strata are that wide.
const OPENING_SQUARED: f32 = 0.36;
const WIDE: f32 = 0.5;

// A stratum of a site's light.
struct Sheet {
    // Along its direction, mm.
    way: vec3f,
    // Of its depth, mm².
    variance: vec3f,
    // Of the power.
    share: f32,
}

struct Sheets {
    sheets: array<Sheet, STRATA>,
    count: u32,
}

// φ of light that scattered once, mean over where a ray of view scatters light.
fn once_scattered(origin: vec3f, direction: vec3f, cosine: f32, chord: f32) -> vec3f {
    let extinction = transport.extinction.rgb;
    let end = extinction * chord;
    let share = 1.0 - exp(-min(end, vec3f(80.0)));
    var ways: array<vec3f, STRATA>;
    var variances: array<vec3f, STRATA>;
    for (var k = 0u; k < STRATA; k++) {
        let part = stratum(end, share, k);
        ways[k] = part.mean / extinction;
        let width = cosine * deviation(part.to - part.begin) / extinction;
        variances[k] = width * width;
    }
    let last = ways[STRATA - 1u];
    let longest = max(last.x, max(last.y, last.z));
    let free_path = 1.0 / min(extinction.x, min(extinction.y, extinction.z));
    let wide = WIDE / max(extinction.x, max(extinction.y, extinction.z));
    let square_of_extinction = extinction * extinction;
    var sum = vec3f(0.0);
    var level = transport.top_level;
    var node = 0u;
    loop {
        let source = transport.sources[level / 4u][level % 4u] + node;
        var centre = site_positions[select(node, 0u, level > 0u)].xyz;
        var reach = 0.0;
        if level > 0u {
            centre = nodes[node_index(level, node)].centre;
            reach = nodes[node_index(level, node)].radius;
        }
        let light = strata[source];
        let charge = charges[source];
        let power = luminance(charge.power.rgb);
        // From the nearest place of the ray to the nearest of where light scatters.
        let offset = centre - origin;
        let beside = offset - direction * clamp(dot(offset, direction), 0.0, longest);
        let u = light.direction;
        let apart = beside + u * clamp(-dot(beside, u) / max(dot(u, u), 1e-12), 0.0, light.mean.w);
        let square = dot(apart, apart);
        let is_out_of_sight = sqrt(square) - reach > FURTHEST * free_path || power <= 0.0;
        if level > 0u && !is_out_of_sight && reach * reach > OPENING_SQUARED * (square + wide * wide) {
            level -= 1u;
            node *= 4u;
            continue;
        }
        if !is_out_of_sight {
            let shape = shapes[source];
            let middle = vec3f(luminance(charge.x.rgb), luminance(charge.y.rgb), luminance(charge.z.rgb)) / power;
            let start = origin - centre - middle;
            let normal = safe_normalize(shape.normal, vec3f(0.0));
            let radius2 = square_of_extinction * 2.0 * shape.spread * shape.spread;
            let lit = sheets(light, square > ONE * ONE * free_path * free_path);
            var received = vec3f(0.0);
            for (var k = 0u; k < lit.count; k++) {
                let own = lit.sheets[k];
                // Not a loop: software adapters end all of a shader's at 65,535 turns together.
                var pair = SHARES[0] * between(start, direction, ways[0], variances[0], u, own, normal, radius2);
                pair += SHARES[1] * between(start, direction, ways[1], variances[1], u, own, normal, radius2);
                pair += SHARES[2] * between(start, direction, ways[2], variances[2], u, own, normal, radius2);
                pair += SHARES[3] * between(start, direction, ways[3], variances[3], u, own, normal, radius2);
                received += own.share * pair;
            }
            sum += charge.power.rgb * received * square_of_extinction;
        }
        let next = passed(transport.site_count, transport.top_level, Step(level, node));
        level = next.level;
        node = next.node;
        if level == transport.top_level { break; }
    }
    return sum;
}

// Mean of e^−r / 4πr² between a stratum of the ray and one of a site's light, mean free paths.
fn between(start: vec3f, direction: vec3f, way: vec3f, variance: vec3f, u: vec3f, own: Sheet, normal: vec3f, radius2: vec3f) -> vec3f {
    let square = transport.extinction.rgb * transport.extinction.rgb;
    let x = start.x + direction.x * way - u.x * own.way;
    let y = start.y + direction.y * way - u.y * own.way;
    let z = start.z + direction.z * way - u.z * own.way;
    let height = normal.x * x + normal.y * y + normal.z * z;
    let beside2 = square * max(x * x + y * y + z * z - height * height, vec3f(0.0));
    return from_disc(beside2, across(square * height * height, square * (own.variance + variance)), radius2);
}

// Radiance of light that scattered twice.
fn twice(origin: vec3f, direction: vec3f, cosine: f32, chord: f32) -> vec3f {
    let share = 1.0 - exp(-min(transport.extinction.rgb * chord, vec3f(80.0)));
    return transport.albedo.rgb / (4.0 * PI) * share * once_scattered(origin, direction, cosine, chord);
}

// A site's light, as one sheet or as all of its strata.
fn sheets(light: Strata, is_one: bool) -> Sheets {
    var all: Sheets;
    var mean = vec3f(0.0);
    var square = vec3f(0.0);
    var before = vec3f(0.0);
    for (var k = 0u; k < STRATA; k++) {
        let way = light.ways[k].rgb;
        // From how far apart the strata are.
        let x = transport.extinction.rgb * (way - before);
        let width = light.cosine * (way - before) * (SHORT[k] + LONG[k] * x);
        before = way;
        all.sheets[k] = Sheet(way, width * width, SHARES[k]);
        mean += SHARES[k] * way;
        square += SHARES[k] * (light.cosine * light.cosine * way * way + width * width);
    }
    all.count = STRATA;
    if is_one {
        all.count = 1u;
        all.sheets[0] = Sheet(mean, max(square - light.cosine * light.cosine * mean * mean, vec3f(0.0)), 1.0);
    }
    return all;
}

// Rms distance within a stratum from its mean, over how far that is from the last one's: of a short way, of which strata are even, and how that grows to where
// the way does not end.
const SHORT: array<f32, STRATA> = array<f32, STRATA>(0.577, 0.247, 0.231, 0.19);
const LONG: array<f32, STRATA> = array<f32, STRATA>(0.214, 0.157, 0.164, 0.253);

// Rms distance of what scatters over an optical depth from its mean, mean free paths.
fn deviation(depth: vec3f) -> vec3f {
    let x = min(depth, vec3f(60.0));
    let used_up = 1.0 - exp(-x);
    return sqrt(select(1.0 - x * x * (1.0 - used_up) / max(used_up * used_up, vec3f(1e-12)), x * x / 12.0, x < vec3f(0.3)));
}

// Square of the distance of two sheets at which e^−r / 4πr² is its mean over two strata whose middles are so far apart, with this variance of both depths
// together; mean free paths. The two constants make light that a half-space scatters twice right within 3 % in all directions.
fn across(height2: vec3f, variance: vec3f) -> vec3f {
    return height2 * height2 / (height2 + 4.38 * variance + 1e-12) + 0.265 * variance + 1e-6;
}

// Mean of e^−r / 4πr² over a disc of this radius², beside its axis and above it by these squares: that of 1/r² in closed form, and e^−r from the nearest
// distance on evenly in ln r, by Simpson's rule; mean free paths.
fn from_disc(beside2: vec3f, height2: vec3f, radius2: vec3f) -> vec3f {
    let x = radius2 + height2 - beside2;
    let root = sqrt(x * x + 4.0 * height2 * beside2);
    let ratio = select(2.0 * beside2 / max(root - x, vec3f(1e-20)), (x + root) / (2.0 * height2), x > vec3f(0.0));
    let logarithm = log(max(ratio, vec3f(1.0)));
    let nearest = sqrt(height2 + max(beside2 - radius2, vec3f(0.0)));
    let step = exp(0.25 * logarithm);
    let decayed = (exp(-nearest) + 4.0 * exp(-nearest * step) + exp(-nearest * step * step)) / 6.0;
    return logarithm / (4.0 * PI * max(radius2, vec3f(1e-12))) * decayed;
}
