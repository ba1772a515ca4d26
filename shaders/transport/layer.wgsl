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

// What leaves by the diffuse law, the same in all directions inside.
@compute @workgroup_size(64)
fn diffuse(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= transport.site_count { return; }
    let robin = transport.robin.rgb;
    let comes_in = fluence[2u * transport.site_count + index].rgb;
    let leaves = robin * fluence[transport.site_count + index].rgb - mirrored() * comes_in;
    site_exitance[index] = vec4f(max(leaves, vec3f(0.0)), 0.0);
}

@compute @workgroup_size(64)
fn parabola(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= transport.site_count { return; }
    let source = strata[index];
    let light = entered[index].rgb;
    let thickness = source.ways[2].w;
    let depth = layer_depth(thickness).rgb;
    let rate = transport.extinction.rgb / max(source.cosine, 0.05);
    var own: Parabola;
    own.thickness = thickness;
    own.cosine = source.cosine;
    own.around = source.ways[0].w;
    own.light = light;
    own.open = entered[transport.site_count + index].rgb;
    let beam = transport.albedo.rgb * light / (transport.diffusion.rgb * rate);
    own.surface = fluence[transport.site_count + index].rgb + beam;
    let comes_in = fluence[2u * transport.site_count + index].rgb;
    let flux = transport.robin.rgb * (fluence[transport.site_count + index].rgb - 4.0 * comes_in);
    let under = (lit_below[index].rgb - sent_below[index].rgb) / clamp(sent_below[index].w, 0.2, 1.2);
    let slope = flux / transport.diffusion.rgb - beam * rate;
    let rise = under + beam * exp(-rate * depth) - own.surface;
    let thin = depth * transport.extinction.rgb <= vec3f(1e-3);
    own.slope = select(slope, vec3f(0.0), thin);
    own.curve = select((rise / max(depth, vec3f(1e-20)) - slope) / max(depth, vec3f(1e-20)), vec3f(0.0), thin);
    parabolas[index] = own;
}
