// Source: light that entered a site → the strata in which it scatters first, and their power.

@group(0) @binding(0) var<uniform> transport: Transport;
@group(0) @binding(1) var<uniform> lighting: Gather;
@group(0) @binding(2) var<storage, read> site_positions: array<vec4f>;
@group(0) @binding(3) var<storage, read> site_normals: array<vec4f>;
@group(0) @binding(4) var<storage, read> site_lights: array<SiteLight>;
@group(0) @binding(5) var<storage, read> nodes: array<Node>;
@group(0) @binding(6) var<storage, read_write> charges: array<Charge>;
@group(0) @binding(7) var<storage, read_write> strata: array<Strata>;
// Of each site irradiance that entered, W/m², and how much of the sky the body hides; then which share of the light of lamps gets there, and the mean
// curvature, 1/mm.
@group(0) @binding(8) var<storage, read_write> entered: array<vec4f>;
@group(0) @binding(9) var<storage, read> surroundings: array<Surroundings>;

// Share of a lamp's light from which on nothing is in its way.
const LIT: f32 = 0.98;
// Rays leave the surface beyond so many of a site's width.
const CLEAR: f32 = 1.0;

@compute @workgroup_size(64)
fn enter(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= transport.site_count { return; }
    let place = site_positions[index];
    let position = place.xyz;
    let normal = normalize(site_normals[index].xyz);
    let tint = site_lights[index].tint.rgb;
    let width = sqrt(place.w);
    let thickness = first_crossing(position, -normal, 0.1 * width, 1.0).t;
    var diffuse = site_lights[index].irradiance.rgb;
    var direct = vec3f(0.0);
    var through = vec3f(0.0);
    var scatters = vec3f(0.0);
    var unshadowed = vec3f(0.0);
    var direction = vec3f(0.0);
    var cosines = 0.0;
    let is_told_from_sky = has_sky();
    for (var k = 0u; k < beam_count(); k++) {
        let arriving = beam(k, position, width * width, normal);
        let outside = dot(normal, arriving.to_light);
        if outside <= 0.0 || all(arriving.strength <= vec3f(0.0)) { continue; }
        if any(position < arriving.low) || any(position > arriving.high) { continue; }
        let light = arriving.strength * outside * fresnel_transmittance(transport.eta, outside);
        let inside = refracted_cosine(transport.eta, outside);
        unshadowed += light;
        // Depth maps say who is lit, where there is no sky to be told from.
        var crossed = 0.0;
        if is_told_from_sky || any(diffuse < LIT * light) { crossed = way_inside(position, arriving.to_light, CLEAR * width, arriving.far); }
        // What the depth map lets through comes straight; the rest through what is in the way.
        var straight = vec3f(0.0);
        if crossed == 0.0 || !is_told_from_sky { straight = min(light, diffuse); }
        diffuse -= straight;
        var rest = vec3f(0.0);
        if crossed > 0.0 && transport.eta == 1.0 { rest = max(light * exp(-transport.extinction.rgb * crossed) - straight, vec3f(0.0)); }
        direct += straight;
        through += rest;
        scatters += balanced(inside) * (straight + rest);
        let weight = luminance(straight + rest);
        direction -= weight * bent(arriving.to_light, normal);
        cosines += weight * inside;
    }
    // An even sky, through a cone inside.
    let weight = luminance(diffuse);
    let cone = mean_sky_cosine();
    direction -= weight * cone * normal;
    cosines += weight * cone;
    let light = (scatters + diffuse) * tint;
    let whole = luminance(direct + through) + weight;
    if whole > 0.0 {
        direction /= whole;
        cosines /= whole;
    } else {
        direction = -normal;
        cosines = 1.0;
    }
    let steepness = length(direction);
    var chord = thickness;
    if dot(direction, normal) > -0.9999 * steepness { chord = first_crossing(position, direction / max(steepness, 1e-6), 0.1 * width, 1.0).t; }
    let spread_out = 0.9 * max(1.0 - steepness * steepness, 0.0);
    let bulge = curvature(index);
    let bend = 0.5 * bulge;
    let deep = max(-dot(normal, direction), 0.0);
    var own: Strata;
    own.direction = direction;
    own.cosine = cosines;
    let end = transport.extinction.rgb * chord;
    let share = 1.0 - exp(-min(end, vec3f(80.0)));
    for (var k = 0u; k < STRATA; k++) {
        let way = stratum(end, share, k).mean / transport.extinction.rgb;
        let depth = deep * way;
        // Under a curved surface light that went aside is less deep than under a plane; of its mean direction that is known of where it is.
        let lifted = clamp(bend * spread_out * way * way, vec3f(0.0), 0.5 * depth);
        let sideways = max(steepness * steepness - deep * deep, 0.0);
        let bent = clamp(bend * sideways * way * way, vec3f(0.0), depth - lifted);
        let optical = (depth - lifted - bent) * transport.extinction.rgb;
        own.ways[k] = vec4f(way, 0.0);
        own.rises[k] = vec4f(lifted + min(hopf_shift(optical), 0.9 * optical) / transport.extinction.rgb, 0.0);
    }
    own.ways[0].w = select(0.0, weight / whole, whole > 0.0);
    own.ways[1].w = thickness;
    strata[index] = summed_up(own);
    // Of an even sky, some crosses in a shorter way than the middle one.
    var kept = vec3f(1.0);
    for (var k = 0u; k < SKY_POINTS; k++) {
        let way = way_out(vec3f(thickness), thickness, bulge, sky_cosine(k));
        kept -= sky_cosine(k) * sky_weight(k) * exp(-min(transport.extinction.rgb * way, vec3f(80.0)));
    }
    let used = mix(share, kept, own.ways[0].w);
    let power = transport.albedo.rgb * light * used * place.w;
    charges[index].power = vec4f(power, 0.0);
    entered[index] = vec4f(light, hidden_sky(index, position, normal, width));
    let open = select(vec3f(0.0), (direct + through) / max(unshadowed, vec3f(1e-30)), unshadowed > vec3f(0.0));
    entered[transport.site_count + index] = vec4f(min(open, vec3f(1.0)), bulge);
}

// Mean curvature of the surface about a site, 1/mm, above 0 where it bulges: of the sites around it that face its way, Σ n·x over Σ x² about their middle,
// which is 1/R on a ball.
fn curvature(index: u32) -> f32 {
    let count = surroundings[index].count;
    var middle = vec3f(0.0);
    for (var k = 0u; k < count; k++) { middle += site_positions[surroundings[index].sites[k]].xyz; }
    middle /= f32(max(count, 1u));
    var turned = 0.0;
    var apart = 0.0;
    for (var k = 0u; k < count; k++) {
        let site = surroundings[index].sites[k];
        let offset = site_positions[site].xyz - middle;
        turned += dot(normalize(site_normals[site].xyz), offset);
        apart += dot(offset, offset);
    }
    return select(0.0, turned / apart, apart > 0.0);
}

// Share of an even sky that the body hides, from a few directions. Those of sites one after the other go on in one sequence that covers the square evenly, with
// the powers of the plastic number (Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018), in 32-bit fractions.
fn hidden_sky(index: u32, position: vec3f, normal: vec3f, width: f32) -> f32 {
    let tangent = any_perpendicular(normal);
    let bitangent = cross(normal, tangent);
    var fan: Fan;
    for (var k = 0u; k < RAYS; k++) {
        let n = index * RAYS + k;
        let u = f32(n * 3242174889u) / 4294967296.0;
        let angle = f32(n * 2447445414u) * (6.2831853 / 4294967296.0);
        point(&fan, k, sqrt(1.0 - u) * normal + sqrt(u) * (cos(angle) * tangent + sin(angle) * bitangent));
    }
    return share_that_enters(&fan, position, normal, CLEAR * width);
}
