// Dual: irradiance → radiant exitance with groups of texels at both ends. Level by level, every receiver takes over the sources its
// parent left open. A source that is small seen from the receiver, and the receiver from it, is added to the receiver's expansion;
// otherwise the larger of the two is opened, the source at once, the receiver by leaving the source to its children.

struct Dual {
    table: KernelTable,
    texel_count: u32,
    // Level of the receivers of this dispatch.
    level: u32,
    // Level of the first receivers, which take over the root.
    start_level: u32,
    top_level: u32,
    // Opening angle: accepted when source size + 1.5·receiver size < theta·√(distance² + z_r²).
    theta_squared: f32,
    // The same for single texels, which have no size.
    leaf_theta_squared: f32,
    // Square of the shortest mean free path of the three channels, mm².
    z_r_squared: f32,
    // Words there are in `lists`.
    capacity: u32,
    // Where receivers begin in `bounds`.
    first_receiver: u32,
    padding0: u32,
    padding1: u32,
    padding2: u32,
    // Where each level above the texels begins in `clusters`, in `expansions`, and among the receivers.
    offsets: array<vec4u, 4>,
    // Where each level begins among the sources in `bounds`.
    sources: array<vec4u, 4>,
}

@group(0) @binding(0) var<uniform> dual: Dual;
@group(0) @binding(1) var<storage, read> texel_positions: array<vec4f>;
@group(0) @binding(2) var<storage, read> texel_normals: array<vec4f>;
@group(0) @binding(3) var<storage, read> texel_irradiance: array<vec4f>;
@group(0) @binding(4) var<storage, read> clusters: array<Cluster>;
@group(0) @binding(5) var<storage, read_write> exitance: array<vec4f>;
@group(0) @binding(6) var kernel_table: texture_2d<f32>;
@group(0) @binding(7) var<storage, read> bounds: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> expansions: array<Expansion>;
@group(0) @binding(9) var<storage, read_write> lists: Lists;

// Sources an invocation accepts before it evaluates the kernel for all of them: a wave whose invocations walk differently far still
// evaluates together.
const BATCH: u32 = 16u;
var<workgroup> accepted: array<u32, 1024>;
// Sources it leaves to its children, until they make a run.
var<workgroup> left: array<u32, 960>;

fn source(entry: u32, receiver: u32) -> Source {
    let level = packed_level(entry);
    let node = packed_node(entry);
    if level == 0u { return texel_source(node, receiver); }
    let at = dual.offsets[level / 4u][level % 4u] + node;
    return Source(clusters[at].centroid, clusters[at].spread, clusters[at].normal, clusters[at].power);
}

// A walk through the subtrees of a list's entries.
struct Walk {
    // Where the run begins that is read, and what is left of it.
    run: u32,
    unread: u32,
    runs: u32,
    // Level of the entry whose subtree is walked, and where in it the walk is.
    top: u32,
    level: u32,
    node: u32,
    // Whether the subtree is done.
    done: bool,
}

fn walk(list: List) -> Walk {
    let runs = (list.length + RUN - 1u) / RUN;
    return Walk(list.first_run, list.length - RUN * (max(runs, 1u) - 1u), runs, 0u, 0u, 0u, true);
}

// Goes to the next entry if the last one is done; says whether there was any.
fn arrive(w: ptr<function, Walk>) -> bool {
    if !(*w).done { return true; }
    if (*w).unread == 0u {
        if (*w).runs <= 1u { return false; }
        (*w).run = lists.words[(*w).run];
        (*w).runs -= 1u;
        (*w).unread = RUN;
    }
    let entry = lists.words[(*w).run + (*w).unread];
    (*w).unread -= 1u;
    (*w).top = packed_level(entry);
    (*w).level = (*w).top;
    (*w).node = packed_node(entry);
    (*w).done = false;
    return true;
}

fn open(w: ptr<function, Walk>) {
    (*w).level -= 1u;
    (*w).node *= 4u;
}

// To the next sibling, or where there is none to that of the nearest ancestor who has one. Levels are padded to four children.
fn pass_by(w: ptr<function, Walk>) {
    (*w).node += 1u;
    let up = min(countTrailingZeros((*w).node) / 2u, (*w).top - (*w).level);
    (*w).node >>= 2u * up;
    (*w).level += up;
    (*w).done = (*w).level == (*w).top;
}

fn bound(level: u32, node: u32) -> vec4f {
    return bounds[dual.sources[level / 4u][level % 4u] + node];
}

// Behind a word for the link, the list of the root alone.
@compute @workgroup_size(1)
fn start() {
    atomicStore(&lists.taken, 2u);
    atomicStore(&lists.overflows, 0u);
    lists.words[1] = packed(dual.top_level, 0u);
}

// What the parent left: its expansion about `place`, and its open sources.
fn inherited(node: u32, level: u32, place: vec3f) -> Expansion {
    var e: Expansion;
    e.list_length = 1u;
    if level < dual.start_level {
        let parent = dual.offsets[(level + 1u) / 4u][(level + 1u) % 4u] + node / 4u;
        e = moved(expansions[parent], place - bounds[dual.first_receiver + parent].xyz);
    }
    return e;
}

// Writes a run from the invocation's `left`; false where there is no room.
fn write_run(list: ptr<function, List>, count: u32, local: u32) -> bool {
    let run = atomicAdd(&lists.taken, count + 1u);
    if run + count >= dual.capacity { return false; }
    lists.words[run] = (*list).first_run;
    for (var k = 0u; k < count; k++) { lists.words[run + 1u + k] = left[k * 64u + local]; }
    (*list).first_run = run;
    (*list).length += count;
    return true;
}

// Receivers that are groups of texels.
@compute @workgroup_size(64)
fn inner(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let node = item_index(group, groups, local);
    if node >= level_count(dual.texel_count, dual.level) { return; }
    let own = dual.offsets[dual.level / 4u][dual.level % 4u] + node;
    let receiver = bounds[dual.first_receiver + own].xyz;
    let size = bounds[dual.first_receiver + own].w;
    let before = inherited(node, dual.level, receiver);
    var e = before;
    var w = walk(List(e.first_run, e.list_length));
    var list = List(0u, 0u);
    var left_count = 0u;
    var room = true;
    var arrived = true;
    var evaluated = 0u;
    while arrived && room {
        var count = 0u;
        while count < BATCH && left_count < RUN {
            arrived = arrive(&w);
            if !arrived { break; }
            let seen = bound(w.level, w.node);
            let offset = receiver - seen.xyz;
            let needed = seen.w + 1.5 * size;
            let small = needed * needed < dual.theta_squared * (dot(offset, offset) + dual.z_r_squared);
            if seen.w > size && !small {
                open(&w);
                continue;
            }
            if seen.w > 0.0 {
                if small {
                    accepted[count * 64u + local] = packed(w.level, w.node);
                    count += 1u;
                } else {
                    left[left_count * 64u + local] = packed(w.level, w.node);
                    left_count += 1u;
                }
            }
            pass_by(&w);
        }
        if left_count == RUN || !arrived && left_count > 0u {
            room = write_run(&list, left_count, local);
            left_count = 0u;
        }
        for (var k = 0u; k < count; k++) {
            let s = source(accepted[k * 64u + local], 0xffffffffu);
            let d = receiver - s.place;
            let distance_squared = dot(d, d);
            let along = dot(d, s.normal);
            let facing = select(0.0, along * along / distance_squared, distance_squared > 0.0);
            // Derivatives by r² lose their digits where r hardly counts.
            let r2 = max(distance_squared, max(0.01 * size * size, dual.table.least_r2));
            let s2 = s.spread * s.spread;
            add(&e, s.power, profile_jet(dual.table, kernel_table, r2, s2, min(facing, 1.0)), d);
        }
        evaluated += count;
    }
    let texels = min(1u << (2u * dual.level), dual.texel_count - (node << (2u * dual.level)));
    e.evaluations += f32(evaluated) / f32(texels);
    e.first_run = list.first_run;
    e.list_length = list.length;
    // Without room for a list nothing is resolved here: the children take over what the parent left.
    if !room {
        atomicAdd(&lists.overflows, 1u);
        e = before;
    }
    expansions[own] = e;
}

// Receivers that are single texels.
@compute @workgroup_size(64)
fn leaf(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= dual.texel_count { return; }
    let receiver = texel_positions[index].xyz;
    let e = inherited(index, 0u, receiver);
    var sum = vec3f(0.0);
    var w = walk(List(e.first_run, e.list_length));
    var arrived = true;
    var evaluated = 0u;
    while arrived {
        var count = 0u;
        while count < BATCH {
            arrived = arrive(&w);
            if !arrived { break; }
            let seen = bound(w.level, w.node);
            let offset = receiver - seen.xyz;
            if w.level > 0u && seen.w * seen.w > dual.leaf_theta_squared * (dot(offset, offset) + dual.z_r_squared) {
                open(&w);
                continue;
            }
            if seen.w > 0.0 {
                accepted[count * 64u + local] = packed(w.level, w.node);
                count += 1u;
            }
            pass_by(&w);
        }
        for (var k = 0u; k < count; k++) {
            sum += received(dual.table, receiver, source(accepted[k * 64u + local], index));
        }
        evaluated += count;
    }
    exitance[index] = vec4f(e.value + sum, e.evaluations + f32(evaluated));
}
