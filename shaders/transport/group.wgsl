// Group: texels → sites, which the boundary solver knows alone: 4^l texels each, so that its work follows how far light wanders, not the texture.

@group(0) @binding(0) var<uniform> transport: Transport;
@group(0) @binding(1) var<storage, read> texel_positions: array<vec4f>;
@group(0) @binding(2) var<storage, read> texel_normals: array<vec4f>;
@group(0) @binding(3) var<storage, read> texel_irradiance: array<vec4f>;
// Marks of texels, then their places in the order of sites, then that order.
@group(0) @binding(4) var<storage, read> marks: array<u32>;
// Middle, mm, and area, mm².
@group(0) @binding(5) var<storage, read_write> site_positions: array<vec4f>;
// Mean normal, shorter where normals differ.
@group(0) @binding(6) var<storage, read_write> site_normals: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> site_lights: array<SiteLight>;

@compute @workgroup_size(64)
fn group(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let site = item_index(group, groups, local);
    if site >= transport.site_count { return; }
    let first = site * transport.texels_per_site;
    let last = min(first + transport.texels_per_site, transport.texel_count);
    var area = 0.0;
    for (var place = first; place < last; place++) { area += texel_positions[texel_at(place)].w; }
    var middle = vec3f(0.0);
    var normal = vec3f(0.0);
    var light = vec3f(0.0);
    var tinted = vec3f(0.0);
    for (var place = first; place < last; place++) {
        let k = texel_at(place);
        var weight = 1.0 / f32(last - first);
        if area > 0.0 { weight = texel_positions[k].w / area; }
        middle += weight * texel_positions[k].xyz;
        normal += weight * texel_normals[k].xyz;
        let irradiance = weight * texel_irradiance[k].rgb;
        light += irradiance;
        tinted += irradiance * marked_tint(marks[k]);
    }
    // Where normals cancel, any will do.
    if dot(normal, normal) < 1e-6 { normal = texel_normals[texel_at(first)].xyz; }
    if dot(normal, normal) < 1e-6 { normal = vec3f(0.0, 1.0, 0.0); }
    site_positions[site] = vec4f(middle, area);
    site_normals[site] = vec4f(normal, 0.0);
    site_lights[site] = SiteLight(vec4f(light, 0.0), vec4f(select(vec3f(1.0), tinted / light, light > vec3f(0.0)), 0.0));
}

fn texel_at(place: u32) -> u32 {
    return marks[2u * transport.texel_count + place];
}
