// Returning: light that leaves a concave body and enters it again, Γ, and what the surface then sends.

@group(0) @binding(0) var<uniform> level: Level;
@group(0) @binding(1) var<uniform> transport: Transport;
@group(0) @binding(2) var<storage, read> bounds: array<vec4f>;
@group(0) @binding(3) var<storage, read> shapes: array<Shape>;
// φ of the solver's trial, then what was found.
@group(0) @binding(4) var<storage, read> fluence: array<vec4f>;
// Irradiance that entered, and how much of the sky the body hides.
@group(0) @binding(5) var<storage, read> entered: array<vec4f>;
// B A of each source, then Γ of each texel.
@group(0) @binding(6) var<storage, read_write> leaving: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> charges: array<Charge>;

// Texels whose rays are taken together.
const GROUP: u32 = 16u;
// Opening angle, squared, and that of groups that do not face one way, which is those whose mean normal, squared, is shorter.
const THETA_SQUARED: f32 = 0.25;
const THETA_SQUARED_MIXED: f32 = 0.04;
const ONE_WAY: f32 = 0.8;
fn returning_place(texel: u32) -> u32 {
    return transport.source_count + texel;
}

// Γ follows from what leaves, and that from Γ: from none, a few times over, so that what the equation makes of a trial is linear in it.
@compute @workgroup_size(64)
fn forget(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index < transport.texel_count { leaving[returning_place(index)] = vec4f(0.0); }
}

// Of the trial, and of what was found.
@compute @workgroup_size(64)
fn leave(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index < transport.texel_count { leave_texel(index, fluence[index].rgb); }
}

@compute @workgroup_size(64)
fn leave_found(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index < transport.texel_count { leave_texel(index, fluence[transport.texel_count + index].rgb); }
}

fn leave_texel(index: u32, fluence: vec3f) {
    let robin = transport.robin.rgb;
    let exitance = robin * fluence - (4.0 * robin - 1.0) * leaving[returning_place(index)].rgb;
    leaving[index] = vec4f(shapes[index].area * exitance, 0.0);
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

@compute @workgroup_size(64)
fn charge(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index < transport.texel_count { charge_texel(index, fluence[index].rgb); }
}

@compute @workgroup_size(64)
fn charge_found(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index < transport.texel_count { charge_texel(index, fluence[transport.texel_count + index].rgb); }
}

fn charge_texel(index: u32, fluence: vec3f) {
    let shape = shapes[index];
    let comes_in = returning(index, shape.normal);
    leaving[returning_place(index)] = vec4f(comes_in, 0.0);
    let power = shape.area * transport.robin.rgb * (fluence - 4.0 * comes_in);
    let moment = shape.area * transport.diffusion.rgb * fluence;
    charges[transport.source_count + index] = Charge(
        vec4f(power, 0.0),
        vec4f(moment * shape.normal.x, 0.0),
        vec4f(moment * shape.normal.y, 0.0),
        vec4f(moment * shape.normal.z, 0.0));
}

// Of what leaves elsewhere, what falls on a texel, W/m². Form factors know no obstacles; they are scaled down to what the texel really sees of the body.
fn returning(index: u32, normal: vec3f) -> vec3f {
    // Few rays tell: those of a group of texels.
    let first = index / GROUP * GROUP;
    let last = min(first + GROUP, transport.texel_count);
    var hidden = 0.0;
    for (var k = first; k < last; k++) { hidden += entered[k].w; }
    hidden /= f32(last - first);
    if hidden == 0.0 { return vec3f(0.0); }
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
        // Nothing of it is above the horizon.
        let below = dot(offset, normal) < -place.w;
        let facing = shapes[source].normal;
        let theta = select(THETA_SQUARED, THETA_SQUARED_MIXED, dot(facing, facing) < ONE_WAY);
        if at_level > 0u && place.w * place.w > theta * square && !below {
            at_level -= 1u;
            node *= 4u;
            continue;
        }
        let receives = dot(normal, offset);
        let gives = -dot(facing, offset);
        if receives > 0.0 && gives > 0.0 && !below {
            let area = shapes[source].area;
            let form = 0.31830988 * receives * gives / (square * max(square, 0.25 * area));
            seen += form * area;
            sum += form * leaving[source].rgb;
        }
        let next = passed(transport.texel_count, transport.top_level, Step(at_level, node));
        at_level = next.level;
        node = next.node;
        if at_level == transport.top_level { break; }
    }
    return sum * select(0.0, min(hidden / seen, 1.0), seen > 0.0);
}
