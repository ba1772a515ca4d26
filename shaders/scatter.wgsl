// Scatter: irradiance → radiant exitance, B_i = Σ_j E_j·A_j·K̄(|p_i − p_j|, s_j), per texel.

struct Scatter {
    table: KernelTable,
    texel_count: u32,
    // Sources of one dispatch of `all_pairs`.
    first_source: u32,
    source_count: u32,
    // Level at which the descent of `tree` starts: a single node.
    top_level: u32,
    // Opening angle: a cluster is accepted when radius < theta·√(distance² + z_r²).
    theta_squared: f32,
    // Square of the length below which all three channels are smooth, mm².
    z_r_squared: f32,
    padding0: u32,
    padding1: u32,
    // Where each level begins in `bounds`; level 0 is the texels.
    sources: array<vec4u, 4>,
    // Of kernels whose sources lie off the surface.
    terms: array<Term, 2>,
}

@group(0) @binding(0) var<uniform> scatter: Scatter;
// Centres and sizes of all sources, dark ones with size 0, and what they send.
@group(0) @binding(1) var<storage, read> bounds: array<vec4f>;
@group(0) @binding(2) var<storage, read> lamps: array<Lamp>;
@group(0) @binding(3) var<storage, read_write> exitance: array<vec4f>;
@group(0) @binding(4) var kernel_table: texture_2d<f32>;

// Every receiver collects from a range of sources: the exact sum that everything faster is compared with.
@compute @workgroup_size(64)
fn all_pairs(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= scatter.texel_count { return; }
    let receiver = bounds[index].xyz;
    let normal = lamps[index].normal;
    var sum = vec3f(0.0);
    for (var k = 0u; k < scatter.source_count; k++) { sum += sent(scatter.first_source + k, index, receiver, normal).rgb; }
    sum *= marked_tint(lamps[index].marks);
    if scatter.first_source > 0u { sum += exitance[index].rgb; }
    // Flux may go in.
    if scatter.first_source + scatter.source_count == scatter.texel_count { sum = max(sum, vec3f(0.0)); }
    exitance[index] = vec4f(sum, 0.0);
}

// Every receiver walks the tree of sources on its own and takes a cluster as soon as it looks small.
@compute @workgroup_size(64)
fn tree(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= scatter.texel_count { return; }
    let receiver = bounds[index].xyz;
    let normal = lamps[index].normal;
    var sum = vec3f(0.0);
    var level = scatter.top_level;
    var node = 0u;
    // The inner loop walks to the next node that is accepted, a cluster or, at level 0, a texel; the kernel is then evaluated
    // outside of it, where all invocations of a wave meet again.
    loop {
        var source = 0u;
        var found = false;
        while !found && node < level_count(scatter.texel_count, level) {
            source = scatter.sources[level / 4u][level % 4u] + node;
            let seen = bounds[source];
            let offset = receiver - seen.xyz;
            // A dark source needs no opening.
            let small = seen.w * seen.w < scatter.theta_squared * (dot(offset, offset) + scatter.z_r_squared);
            if level > 0u && !small && seen.w > 0.0 {
                level -= 1u;
                node *= 4u;
                continue;
            }
            found = seen.w > 0.0;
            let next = passed(scatter.texel_count, scatter.top_level, Step(level, node));
            level = next.level;
            node = next.node;
        }
        if !found { break; }
        sum += sent(source, index, receiver, normal).rgb;
    }
    exitance[index] = vec4f(max(sum, vec3f(0.0)) * marked_tint(lamps[index].marks), 0.0);
}
