// Returning: light that leaves a concave body and enters it again, Γ, and what the surface then sends.

@group(0) @binding(0) var<uniform> level: Level;
@group(0) @binding(1) var<uniform> transport: Transport;
@group(0) @binding(2) var<storage, read> bounds: array<vec4f>;
@group(0) @binding(3) var<storage, read> shapes: array<Shape>;
// φ of the solver's trial, then what was found, φ and Γ.
@group(0) @binding(4) var<storage, read> fluence: array<vec4f>;
// Irradiance that entered, and how much of the sky the body hides; then, in w, the mean curvature.
@group(0) @binding(5) var<storage, read> entered: array<vec4f>;
// B A of each source, then Γ of each site.
@group(0) @binding(6) var<storage, read_write> leaving: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> charges: array<Charge>;
@group(0) @binding(8) var<storage, read> nodes: array<Node>;
@group(0) @binding(9) var<storage, read> surroundings: array<Surroundings>;

// Few rays tell how much is hidden: that may be too much at one site and too little at the next, but no more than so many times what is.
const MOST_SCALE: f32 = 4.0;
// Opening angle, squared, and that of groups that do not face one way, which is those whose mean normal, squared, is shorter.
const THETA_SQUARED: f32 = 0.12;
const THETA_SQUARED_MIXED: f32 = 0.04;
const ONE_WAY: f32 = 0.8;

fn returning_place(site: u32) -> u32 {
    return transport.source_count + site;
}

fn robin_of(site: u32) -> vec3f {
    return robin(entered[transport.site_count + site].w);
}

// Γ follows from what leaves, and that from Γ: here from what it is for the solution so far.
@compute @workgroup_size(64)
fn leave(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= transport.site_count { return; }
    // What of Γ does not get in goes on.
    let comes_in = leaving[returning_place(index)].rgb;
    let goes_on = net_flux(robin_of(index), fluence[index].rgb, comes_in) + comes_in;
    leaving[index] = vec4f(shapes[index].area * goes_on, 0.0);
}

@compute @workgroup_size(64)
fn merge(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let node = item_index(group, groups, local);
    if node >= level.node_count { return; }
    var sum = vec4f(0.0);
    for (var k = 0u; k < 4u; k++) {
        if node * 4u + k < level.child_count { sum += leaving[level.child_sources + node * 4u + k]; }
    }
    leaving[level.source_offset + node] = sum;
}

// Were Γ everywhere what it is here, this would be Γ at once, so few walks do.
@compute @workgroup_size(64)
fn come_in(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= transport.site_count { return; }
    let arrives = returning(index, normalize(shapes[index].normal));
    let own = (4.0 * transport.eta * transport.eta * robin_of(index) - 1.0) * arrives.w;
    leaving[returning_place(index)] = vec4f((arrives.rgb + own * leaving[returning_place(index)].rgb) / (1.0 + own), 0.0);
}

// What the trial sends.
@compute @workgroup_size(64)
fn charge(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index < transport.site_count { send(index, fluence[index].rgb, leaving[returning_place(index)].rgb); }
}

// And what was found.
@compute @workgroup_size(64)
fn charge_found(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= transport.site_count { return; }
    send(index, fluence[transport.site_count + index].rgb, fluence[2u * transport.site_count + index].rgb);
}

fn send(index: u32, fluence: vec3f, comes_in: vec3f) {
    let shape = shapes[index];
    let power = shape.area * net_flux(robin_of(index), fluence, comes_in);
    // Without absorption φ is the same everywhere: what is in w then tells how much of all directions is body.
    let moment = shape.area * vec4f(transport.diffusion.rgb * fluence, -1.0);
    charges[transport.source_count + index] =
        Charge(vec4f(power, 0.0), moment * shape.normal.x, moment * shape.normal.y, moment * shape.normal.z);
}

// Few rays tell: those of the sites around that face the same way, too.
fn hidden_around(index: u32) -> f32 {
    var sum = 0.0;
    var weights = 0.0;
    for (var k = 0u; k < surroundings[index].count; k++) {
        let site = surroundings[index].sites[k];
        let facing = max(dot(shapes[site].normal, shapes[index].normal), 0.0);
        let weight = facing * facing;
        sum += weight * entered[site].w;
        weights += weight;
    }
    return select(entered[index].w, sum / weights, weights > 0.0);
}

// Of what leaves elsewhere, what falls on a site, W/m², and in w the share of its sky from which that comes. Form factors know no obstacles; they are
// scaled down to what the site really sees of the body.
fn returning(index: u32, normal: vec3f) -> vec4f {
    let hidden = hidden_around(index);
    if hidden == 0.0 { return vec4f(0.0); }
    let receiver = bounds[index].xyz;
    var sum = vec3f(0.0);
    var seen = 0.0;
    var at_level = transport.top_level;
    var node = 0u;
    loop {
        let source = transport.sources[at_level / 4u][at_level % 4u] + node;
        let place = bounds[source];
        let offset = place.xyz - receiver;
        let square = dot(offset, offset);
        let receives = dot(normal, offset);
        var above = receives;
        if at_level > 0u { above += extent_along(nodes[node_index(at_level, node)], normal); }
        let facing = shapes[source].normal;
        let size = shapes[source].size;
        let theta = select(THETA_SQUARED, THETA_SQUARED_MIXED, dot(facing, facing) < ONE_WAY);
        if at_level > 0u && size * size > theta * square && above > 0.0 {
            at_level -= 1u;
            node *= 4u;
            continue;
        }
        let gives = -dot(facing, offset);
        if receives > 0.0 && gives > 0.0 {
            let area = shapes[source].area;
            let form = 0.31830988 * receives * gives / (square * max(square, 0.25 * area));
            seen += form * area;
            sum += form * leaving[source].rgb;
        }
        let next = passed(transport.site_count, transport.top_level, Step(at_level, node));
        at_level = next.level;
        node = next.node;
        if at_level == transport.top_level { break; }
    }
    return vec4f(sum, seen) * select(0.0, min(hidden / seen, MOST_SCALE), seen > 0.0);
}
