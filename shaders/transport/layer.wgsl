// Layer: what is known of φ at the surface and under it → radiant exitance by the diffuse law, and φ as a parabola of the depth.

@group(0) @binding(0) var<uniform> transport: Transport;
@group(0) @binding(1) var<storage, read> strata: array<Strata>;
@group(0) @binding(2) var<storage, read> entered: array<vec4f>;
// φ of the solver's trial, then what was found at the surface, φ and Γ.
@group(0) @binding(3) var<storage, read> fluence: array<vec4f>;
// The equation's sums under the surface: of light, and of what the surface sends, with the closure there in w.
@group(0) @binding(4) var<storage, read> lit_below: array<vec4f>;
@group(0) @binding(5) var<storage, read> sent_below: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> parabolas: array<Parabola>;
@group(0) @binding(7) var<storage, read_write> site_exitance: array<vec4f>;

// ∫ 2 E₂(z') |z − z'| dz' under an even sky, less the mean distance from its sheets, at the depth of the value below the surface; mean free paths.
const SKY_SPREAD: f32 = 0.044;

fn robin_of(site: u32) -> vec3f {
    return robin(entered[transport.site_count + site].w);
}

// What leaves by the diffuse law, the same in all directions inside.
@compute @workgroup_size(64)
fn diffuse(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= transport.site_count { return; }
    let comes_in = fluence[2u * transport.site_count + index].rgb;
    let leaves = net_flux(robin_of(index), fluence[transport.site_count + index].rgb, comes_in) + transport.open * comes_in;
    site_exitance[index] = vec4f(max(leaves, vec3f(0.0)), 0.0);
}

@compute @workgroup_size(64)
fn parabola(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= transport.site_count { return; }
    let source = strata[index];
    let light = entered[index].rgb;
    let thickness = source.ways[1].w;
    let depth = layer_depth(thickness).rgb;
    var own: Parabola;
    own.thickness = thickness;
    own.cosine = source.cosine;
    own.around = source.ways[0].w;
    own.light = light;
    own.open = entered[transport.site_count + index].rgb;
    own.bulge = entered[transport.site_count + index].w;
    own.surface = fluence[transport.site_count + index].rgb + beam_at(own, deep_at(transport.hopf.z / transport.extinction.rgb));
    let comes_in = fluence[2u * transport.site_count + index].rgb;
    let flux = net_flux(robin_of(index), fluence[transport.site_count + index].rgb, comes_in);
    var under = (lit_below[index].rgb - sent_below[index].rgb) / clamp(sent_below[index].w, 0.2, 1.2);
    let slope = (flux - transport.albedo.rgb * light) / transport.diffusion.rgb;
    under -= spread_out(source, light, thickness, depth);
    let rise = under + beam_at(own, deep_at(depth + hopf_shift(depth * transport.extinction.rgb) / transport.extinction.rgb)) - own.surface;
    let thin = depth * transport.extinction.rgb <= vec3f(1e-3);
    own.slope = select(slope, vec3f(0.0), thin);
    own.curve = select((rise / max(depth, vec3f(1e-20)) - slope) / max(depth, vec3f(1e-20)), vec3f(0.0), thin);
    parabolas[index] = own;
}

// How much less than under the sheets that stand for them there is under strata of light, which are spread out: half of how much further they are on the
// mean, over D. Only those of the site itself are near enough to tell.
fn spread_out(source: Strata, light: vec3f, thickness: f32, depth: vec3f) -> vec3f {
    let extinction = transport.extinction.rgb;
    let deep = clamp(source.cosine, 0.05, 1.0);
    let end = extinction * thickness / deep;
    let share = 1.0 - exp(-min(end, vec3f(80.0)));
    let fold = deep / extinction;
    var sum = vec3f(0.0);
    for (var k = 0u; k < STRATA; k++) {
        let own = stratum(end, share, k);
        let sheet = max(deep * source.ways[k].rgb - source.rises[k].rgb, vec3f(0.0));
        let shift = fold * own.mean - sheet;
        let begin = fold * own.begin - shift;
        let to = fold * own.to - shift;
        let above = max(depth - begin, vec3f(0.0)) / fold;
        let away = 2.0 * fold * (above - (1.0 - exp(-above))) / max(1.0 - exp(-(own.to - own.begin)), vec3f(1e-6)) + sheet - depth;
        sum += SHARES[k] * select(vec3f(0.0), away - abs(depth - sheet), (depth > begin) & (depth < to));
    }
    let around = select(source.ways[0].w, 0.0, transport.eta > 1.0);
    let optical = depth * extinction / LAYER;
    let away = mix(sum, SKY_SPREAD * optical * optical / extinction, around);
    return transport.albedo.rgb * light * share * 0.5 * away / transport.diffusion.rgb;
}
