// Merge: what sites send, summed up their tree, four to one.

@group(0) @binding(0) var<uniform> level: Level;
@group(0) @binding(1) var<uniform> transport: Transport;
@group(0) @binding(2) var<storage, read_write> bounds: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> charges: array<Charge>;
@group(0) @binding(4) var<storage, read_write> strata: array<Strata>;

// Light that entered a site is where the site is, or nowhere.
@compute @workgroup_size(64)
fn light_of_sites(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let site = item_index(group, groups, local);
    if site >= transport.site_count { return; }
    charges[site].x = vec4f(0.0);
    charges[site].y = vec4f(0.0);
    charges[site].z = vec4f(0.0);
    place_light(site);
}

fn place_light(source: u32) {
    let place = bounds[source];
    bounds[transport.light_bounds + source] = vec4f(place.xyz, select(0.0, place.w, any(charges[source].power > vec4f(0.0))));
}

@compute @workgroup_size(64)
fn light(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let node = item_index(group, groups, local);
    if node >= level.node_count { return; }
    let own = level.source_offset + node;
    charges[own] = merged(node, 0u);
    place_light(own);
    var mean: Strata;
    var whole = 0.0;
    for (var k = 0u; k < 4u; k++) {
        if node * 4u + k >= level.child_count { break; }
        let child = level.child_sources + node * 4u + k;
        let weight = luminance(charges[child].power.rgb);
        whole += weight;
        mean.direction += weight * strata[child].direction;
        mean.cosine += weight * strata[child].cosine;
        for (var s = 0u; s < STRATA; s++) {
            mean.ways[s] += weight * strata[child].ways[s];
            mean.rises[s] += weight * strata[child].rises[s];
        }
    }
    let scale = select(0.0, 1.0 / whole, whole > 0.0);
    mean.direction *= scale;
    mean.cosine *= scale;
    for (var s = 0u; s < STRATA; s++) {
        mean.ways[s] *= scale;
        mean.rises[s] *= scale;
    }
    strata[own] = summed_up(mean);
}

// What the surface sends.
@compute @workgroup_size(64)
fn surface(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let node = item_index(group, groups, local);
    if node >= level.node_count { return; }
    charges[transport.source_count + level.source_offset + node] = merged(node, transport.source_count);
}

fn merged(node: u32, kind: u32) -> Charge {
    let centre = bounds[level.source_offset + node].xyz;
    var sum: Charge;
    for (var k = 0u; k < 4u; k++) {
        if node * 4u + k >= level.child_count { break; }
        let child = level.child_sources + node * 4u + k;
        let charge = charges[kind + child];
        let offset = bounds[child].xyz - centre;
        sum.power += charge.power;
        sum.x += charge.x + charge.power * offset.x;
        sum.y += charge.y + charge.power * offset.y;
        sum.z += charge.z + charge.power * offset.z;
    }
    return sum;
}
