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
    // Chunks there are in `lists`.
    chunk_count: u32,
    // Where each level begins in `clusters`, `receivers` and `expansions`; level 0 is the texels.
    offsets: array<vec4u, 4>,
}

@group(0) @binding(0) var<uniform> dual: Dual;
@group(0) @binding(1) var<storage, read> texel_positions: array<vec4f>;
@group(0) @binding(2) var<storage, read> texel_normals: array<vec4f>;
@group(0) @binding(3) var<storage, read> texel_irradiance: array<vec4f>;
@group(0) @binding(4) var<storage, read> clusters: array<Cluster>;
@group(0) @binding(5) var<storage, read_write> exitance: array<vec4f>;
@group(0) @binding(6) var kernel_table: texture_2d<f32>;
@group(0) @binding(7) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(8) var<storage, read_write> expansions: array<Expansion>;
@group(0) @binding(9) var<storage, read_write> lists: Lists;

// Sources an invocation accepts before it evaluates the kernel for all of them: a wave whose invocations walk differently far still
// evaluates together.
const BATCH: u32 = 16u;
var<workgroup> accepted: array<u32, 1024>;

// What a receiver sees of a source: how large it is, and how far.
struct Sight {
    size: f32,
    distance_squared: f32,
    dark: bool,
}

fn sight(level: u32, node: u32, receiver: vec3f) -> Sight {
    if level == 0u {
        let offset = receiver - texel_positions[node].xyz;
        return Sight(0.0, dot(offset, offset), false);
    }
    let at = dual.offsets[level / 4u][level % 4u] + node;
    let offset = receiver - clusters[at].centroid;
    let size = max(1.6 * clusters[at].spread, 0.9 * clusters[at].radius);
    return Sight(size, dot(offset, offset), all(clusters[at].power == vec3f(0.0)));
}

fn source(entry: u32, receiver: u32) -> Source {
    let level = packed_level(entry);
    let node = packed_node(entry);
    if level == 0u { return texel_source(node, receiver); }
    let at = dual.offsets[level / 4u][level % 4u] + node;
    return Source(clusters[at].centroid, clusters[at].spread, clusters[at].normal, clusters[at].power);
}

// A walk through the subtrees of a list's entries.
struct Walk {
    chunk: u32,
    read: u32,
    length: u32,
    // Level of the entry whose subtree is walked, and where in it the walk is.
    top: u32,
    level: u32,
    node: u32,
    // Whether the subtree is done.
    done: bool,
}

fn walk(list: List) -> Walk {
    return Walk(list.first_chunk, 0u, list.length, 0u, 0u, 0u, true);
}

// Goes to the next entry if the last one is done; says whether there was any.
fn arrive(w: ptr<function, Walk>) -> bool {
    if !(*w).done { return true; }
    if (*w).read == (*w).length { return false; }
    let place = (*w).read % CHUNK_ENTRIES;
    if place == 0u && (*w).read > 0u { (*w).chunk = lists.words[(*w).chunk * CHUNK_WORDS + CHUNK_ENTRIES]; }
    let entry = lists.words[(*w).chunk * CHUNK_WORDS + place];
    (*w).read += 1u;
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

fn pass_by(w: ptr<function, Walk>) {
    (*w).node += 1u;
    while (*w).level < (*w).top && ((*w).node % 4u == 0u || (*w).node >= level_count(dual.texel_count, (*w).level)) {
        (*w).node = ((*w).node + 3u) / 4u;
        (*w).level += 1u;
    }
    (*w).done = (*w).level == (*w).top;
}

// Chunk 0 is the list of the root alone.
@compute @workgroup_size(1)
fn start() {
    atomicStore(&lists.next_chunk, 1u);
    atomicStore(&lists.overflows, 0u);
    lists.words[0] = packed(dual.top_level, 0u);
}

// What the parent left: its expansion about `place`, and its open sources.
fn inherited(node: u32, level: u32, place: vec3f) -> Expansion {
    var e: Expansion;
    e.list_length = 1u;
    if level < dual.start_level {
        let parent = dual.offsets[(level + 1u) / 4u][(level + 1u) % 4u] + node / 4u;
        e = moved(expansions[parent], place - receivers[parent].centre);
    }
    return e;
}

// A list while it is written.
struct Pen {
    list: List,
    chunk: u32,
    full: bool,
}

fn append(pen: ptr<function, Pen>, entry: u32) {
    let place = (*pen).list.length % CHUNK_ENTRIES;
    if place == 0u && !(*pen).full {
        let fresh = atomicAdd(&lists.next_chunk, 1u);
        (*pen).full = fresh >= dual.chunk_count;
        if !(*pen).full {
            if (*pen).list.length == 0u { (*pen).list.first_chunk = fresh; }
            else { lists.words[(*pen).chunk * CHUNK_WORDS + CHUNK_ENTRIES] = fresh; }
            (*pen).chunk = fresh;
        }
    }
    if (*pen).full { return; }
    lists.words[(*pen).chunk * CHUNK_WORDS + place] = entry;
    (*pen).list.length += 1u;
}

// Receivers that are groups of texels.
@compute @workgroup_size(64)
fn inner(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let node = item_index(group, groups, local);
    if node >= level_count(dual.texel_count, dual.level) { return; }
    let own = dual.offsets[dual.level / 4u][dual.level % 4u] + node;
    let receiver = receivers[own];
    let size = max(1.6 * receiver.spread, 0.9 * receiver.radius);
    let before = inherited(node, dual.level, receiver.centre);
    var e = before;
    var w = walk(List(e.first_chunk, e.list_length));
    var pen = Pen(List(0u, 0u), 0u, false);
    var arrived = true;
    var evaluated = 0u;
    while arrived && !pen.full {
        var count = 0u;
        while count < BATCH && !pen.full {
            arrived = arrive(&w);
            if !arrived { break; }
            let seen = sight(w.level, w.node, receiver.centre);
            let needed = seen.size + 1.5 * size;
            let small = needed * needed < dual.theta_squared * (seen.distance_squared + dual.z_r_squared);
            if !seen.dark {
                if small {
                    accepted[count * 64u + local] = packed(w.level, w.node);
                    count += 1u;
                } else if w.level > 0u && seen.size > size {
                    open(&w);
                    continue;
                } else {
                    append(&pen, packed(w.level, w.node));
                }
            }
            pass_by(&w);
        }
        for (var k = 0u; k < count; k++) {
            let s = source(accepted[k * 64u + local], 0xffffffffu);
            let d = receiver.centre - s.place;
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
    e.evaluations += f32(evaluated) / f32(receiver.texels);
    e.first_chunk = pen.list.first_chunk;
    e.list_length = pen.list.length;
    // Without room for a list nothing is resolved here: the children take over what the parent left.
    if pen.full {
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
    var w = walk(List(e.first_chunk, e.list_length));
    var arrived = true;
    var evaluated = 0u;
    while arrived {
        var count = 0u;
        while count < BATCH {
            arrived = arrive(&w);
            if !arrived { break; }
            let seen = sight(w.level, w.node, receiver);
            let small = seen.size * seen.size < dual.leaf_theta_squared * (seen.distance_squared + dual.z_r_squared);
            if !seen.dark {
                if w.level > 0u && !small {
                    open(&w);
                    continue;
                }
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
