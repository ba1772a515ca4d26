// Twice: light that scattered once, straight to where a ray of view passes. A ray is three strata, and so is the light of each site: discs of its area.

// Nothing comes from further, mean free paths.
const FURTHEST: f32 = 5.0;
// Opening angle, squared, of groups of sites.
const TWICE_THETA_SQUARED: f32 = 0.25;

// From so many mean free paths on the strata of a site are one.
const ONE: f32 = 2.0;

// A stratum of a site's light.
struct Layer {
    way: vec3f,
    // Of its depth, mm².
    variance: vec3f,
    share: f32,
}

fn square_of(x: vec3f) -> vec3f {
    return x * x;
}

// φ of light that scattered once, mean over a ray of view that ends at an optical depth.
fn once_scattered(origin: vec3f, direction: vec3f, cosine: f32, chord: f32) -> vec3f {
    let extinction = transport.extinction.rgb;
    let end = extinction * chord;
    let share = 1.0 - exp(-min(end, vec3f(80.0)));
    var ways: array<vec3f, STRATA>;
    var widths: array<vec3f, STRATA>;
    for (var k = 0u; k < STRATA; k++) {
        let part = stratum(end, share, k);
        ways[k] = part.mean / extinction;
        let width = cosine * deviation(part.to - part.begin) / extinction;
        widths[k] = width * width;
    }
    let last = ways[STRATA - 1u];
    let longest = max(last.x, max(last.y, last.z));
    let longest_free = 1.0 / min(extinction.x, min(extinction.y, extinction.z));
    let furthest = FURTHEST * longest_free;
    var sum = vec3f(0.0);
    var level = transport.top_level;
    var node = 0u;
    loop {
        let source = transport.sources[level / 4u][level % 4u] + node;
        var centre: vec3f;
        var reach = 0.0;
        if level > 0u {
            let own = nodes[node_index(level, node)];
            centre = own.centre;
            reach = own.radius;
        } else {
            centre = site_positions[node].xyz;
        }
        let light = strata[source];
        let charge = charges[source];
        let whole = luminance(charge.power.rgb);
        let offset = centre - origin;
        let nearest = offset - direction * clamp(dot(offset, direction), 0.0, longest);
        let u = light.direction;
        let deep = light.ways[STRATA - 1u];
        let deepest = max(deep.x, max(deep.y, deep.z));
        let apart = nearest + u * clamp(-dot(nearest, u) / max(dot(u, u), 1e-12), 0.0, deepest);
        let square = dot(apart, apart);
        let shape = shapes[source];
        let is_far = max(sqrt(square) - reach, 0.0) > furthest || whole <= 0.0;
        if level > 0u && !is_far && reach * reach > TWICE_THETA_SQUARED * square {
            level -= 1u;
            node *= 4u;
            continue;
        }
        if !is_far {
            let moved = vec3f(luminance(charge.x.rgb), luminance(charge.y.rgb), luminance(charge.z.rgb)) / whole;
            let start = origin - centre - moved;
            let normal = safe_normalize(shape.normal, vec3f(0.0));
            let a2 = 2.0 * shape.spread * shape.spread;
            // Far away all strata are one.
            var mean = vec3f(0.0);
            var mean_square = vec3f(0.0);
            var before = vec3f(0.0);
            var sources: array<Layer, STRATA>;
            for (var k = 0u; k < STRATA; k++) {
                let way = light.ways[k].rgb;
                let width = light.cosine * stratum_deviation(k, (way - before) * extinction) / extinction;
                before = way;
                sources[k] = Layer(way, width * width, SHARES[k]);
                mean += SHARES[k] * way;
                mean_square += SHARES[k] * (light.cosine * light.cosine * way * way + width * width);
            }
            var count = STRATA;
            if square > ONE * ONE * longest_free * longest_free {
                count = 1u;
                sources[0] = Layer(mean, mean_square - light.cosine * light.cosine * mean * mean, 1.0);
            }
            var of_source = vec3f(0.0);
            for (var k = 0u; k < count; k++) {
                let own = sources[k];
                for (var m = 0u; m < STRATA; m++) {
                    let along = ways[m];
                    let x = start.x + direction.x * along - u.x * own.way;
                    let y = start.y + direction.y * along - u.y * own.way;
                    let z = start.z + direction.z * along - u.z * own.way;
                    let height = normal.x * x + normal.y * y + normal.z * z;
                    let beside2 = max(x * x + y * y + z * z - height * height, vec3f(0.0));
                    let h2 = effective(square_of(extinction) * height * height, square_of(extinction) * (own.variance + widths[m]));
                    of_source += own.share * SHARES[m] * disc(square_of(extinction) * beside2, h2, square_of(extinction) * a2);
                }
            }
            sum += charge.power.rgb * of_source * square_of(extinction);
        }
        let next = passed(transport.site_count, transport.top_level, Step(level, node));
        level = next.level;
        node = next.node;
        if level == transport.top_level { break; }
    }
    return sum;
}

fn effective(h2: vec3f, v: vec3f) -> vec3f {
    return h2 * h2 / (h2 + 4.38 * v + 1e-12) + 0.265 * v + 1e-6;
}

fn disc(beside2: vec3f, h2: vec3f, a2: vec3f) -> vec3f {
    let x = a2 + h2 - beside2;
    let root = sqrt(x * x + 4.0 * h2 * beside2);
    let ratio = select(2.0 * beside2 / max(root - x, vec3f(1e-20)), (x + root) / (2.0 * h2), x > vec3f(0.0));
    let logarithm = log(max(ratio, vec3f(1.0)));
    let nearest = sqrt(h2 + max(beside2 - a2, vec3f(0.0)));
    let step = exp(0.25 * logarithm);
    let decayed = (exp(-nearest) + 4.0 * exp(-nearest * step) + exp(-nearest * step * step)) / 6.0;
    return 0.07957747 * logarithm / a2 * decayed;
}

// rms distance from the mean of what is used up exponentially over an optical depth.
fn deviation(t: vec3f) -> vec3f {
    let x = min(t, vec3f(60.0));
    let e = 1.0 - exp(-x);
    return sqrt(select(1.0 - x * x * (1.0 - e) / max(e * e, vec3f(1e-12)), x * x / 12.0, x < vec3f(0.3)));
}

const OF_SHORT: array<f32, STRATA> = array<f32, STRATA>(0.577, 0.247, 0.231, 0.19);
const OF_LONG: array<f32, STRATA> = array<f32, STRATA>(0.214, 0.157, 0.164, 0.253);

// The same of a stratum of which the way from the last one is known.
fn stratum_deviation(k: u32, x: vec3f) -> vec3f {
    return x * (OF_SHORT[k] + OF_LONG[k] * x);
}
