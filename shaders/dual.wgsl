// Dual: what sources send, summed up with groups of texels at both ends. Level by level, every receiver takes over the sources its
// parent left open. A source that is small seen from the receiver, and the receiver from it, is added to the receiver's expansion;
// otherwise the larger of the two is opened, the source at once, the receiver by leaving the source to its children.

struct Lists {
    // Words taken, or that would have been.
    taken: atomic<u32>,
    // Nodes that found no room for their list.
    overflows: atomic<u32>,
    padding0: u32,
    padding1: u32,
    words: array<u32>,
}

@group(0) @binding(0) var<uniform> scatter: Dual;
@group(0) @binding(1) var<storage, read> bounds: array<vec4f>;
// What is summed up, per texel.
@group(0) @binding(3) var<storage, read_write> sums: array<vec4f>;
// Of receivers from the second level on, those of the first going straight to `sums`; of all where vertices or fragments follow.
@group(0) @binding(4) var<storage, read_write> expansions: array<Expansion>;
// Where each receiver's open sources are in `lists`.
@group(0) @binding(5) var<storage, read_write> heads: array<u32>;
@group(0) @binding(6) var<storage, read_write> lists: Lists;

// A second-order expansion errs more across a receiver than the averaged profile does across a source of the same size. At the same cost
// a weight of 1.5 errs a sixth more, 2.2 as much; the sum of both sizes in place of that of their squares a tenth more.
const RECEIVER_WEIGHT: f32 = 1.9;
// A source that is larger than the receiver by this factor is opened first.
const SOURCE_EXCESS: f32 = 1.4;

// Sources an invocation accepts before it evaluates the kernel for all of them: a wave whose invocations walk differently far still
// evaluates together.
const BATCH: u32 = 16u;
// Sources it leaves to its children before it writes them down.
const RUN: u32 = 15u;
const NOTED: u32 = 32u;
// Both kinds, from either end.
var<workgroup> notes: array<u32, 2048>;

fn note(place: u32, local: u32) -> u32 {
    return place * 64u + local;
}

@compute @workgroup_size(1)
fn start() {
    atomicStore(&lists.taken, ROOT_WORDS);
    atomicStore(&lists.overflows, 0u);
    lists.words[0] = packed(LINK, 0u);
    lists.words[1] = packed(LINK, 0u);
    lists.words[ROOT_HEAD] = packed(scatter.top_level, 0u);
}

// Writes down the sources left to the children; false where there is no room.
fn write_run(head: ptr<function, u32>, count: u32, local: u32) -> bool {
    let run = atomicAdd(&lists.taken, count + 1u);
    if run + count >= scatter.capacity { return false; }
    lists.words[run] = packed(LINK, *head);
    for (var k = 0u; k < count; k++) { lists.words[run + 1u + k] = notes[note(NOTED - 1u - k, local)]; }
    *head = run + count;
    return true;
}

// Receivers that are groups of texels.
@compute @workgroup_size(64)
fn inner(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let node = item_index(group, groups, local);
    if node >= level_count(scatter.texel_count, scatter.level) { return; }
    let own = receiver_index(scatter.level, node);
    let receiver = bounds[scatter.first_receiver + own].xyz;
    let place = receiving_place(scatter.level, node, receiver);
    let near = smooth_square(node << (2u * scatter.level));
    let size = bounds[scatter.first_receiver + own].w;
    if size == NOT_NEEDED { return; }
    var before: Expansion;
    var head = ROOT_HEAD;
    if scatter.level < scatter.start_level {
        let parent = receiver_index(scatter.level + 1u, node / 4u);
        let above = receiving_place(scatter.level + 1u, node / 4u, bounds[scatter.first_receiver + parent].xyz);
        before = moved_to(expansions[parent - scatter.first_expansion], above, place);
        head = heads[parent];
    }
    var e = before;
    var w = walk(head);
    // The first level knows what its texels will want, who are too close together to differ.
    let decides = scatter.level == 1u;
    var own_head = 0u;
    var left = 0u;
    var room = true;
    var evaluated = 0u;
    while !w.ended && room {
        var count = 0u;
        while count < BATCH && left < RUN && !w.ended {
            if w.done { turn_over(&w); }
            if w.done { continue; }
            let index = source_index(w.level, w.node);
            let seen = source_bounds(index);
            let extent = seen.w * seen.w + RECEIVER_WEIGHT * RECEIVER_WEIGHT * size * size;
            let sight = distance_square(index, seen, place) + near;
            let small = extent < scatter.theta_squared * sight;
            let limit = select(SOURCE_EXCESS * SOURCE_EXCESS * size * size, scatter.leaf_theta_squared * sight, decides);
            if seen.w * seen.w > limit && w.level > 0u && !small {
                open(&w);
                continue;
            }
            if seen.w > 0.0 {
                notes[note(select(NOTED - 1u - left, count, small), local)] = select(packed(w.level, w.node), index, small || decides);
                count += select(0u, 1u, small);
                left += select(1u, 0u, small);
            }
            pass_by(&w);
        }
        if left == RUN || (w.ended && left > 0u) {
            room = write_run(&own_head, left, local);
            left = 0u;
        }
        for (var k = 0u; k < count; k++) {
            let index = notes[note(k, local)];
            collect(&e, index, place, size);
        }
        evaluated += count;
    }
    let texels = min(1u << (2u * scatter.level), scatter.texel_count - (node << (2u * scatter.level)));
    count_evaluations(&e, f32(evaluated) / f32(texels));
    // Without room for a list nothing is resolved here: the children take over what the parent left.
    if !room {
        atomicAdd(&lists.overflows, 1u);
        e = before;
        own_head = head | select(0u, UNDECIDED, decides);
    }
    heads[own] = own_head;
    if own >= scatter.first_expansion {
        expansions[own - scatter.first_expansion] = e;
        return;
    }
    for (var k = 0u; k < texels; k++) {
        sums[node * 4u + k] = settled(e, node * 4u + k, place);
    }
}

// Receivers that are single texels.
@compute @workgroup_size(64)
fn leaf(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= scatter.texel_count { return; }
    let receiver = bounds[index].xyz;
    let near = smooth_square(index);
    let place = texel_place(index, receiver);
    var sum = vec4f(0.0);
    var head = ROOT_HEAD | UNDECIDED;
    if scatter.start_level > 0u {
        if bounds[scatter.first_receiver + receiver_index(1u, index / 4u)].w == NOT_NEEDED {
            sums[index] = vec4f(0.0);
            return;
        }
        sum = sums[index];
        head = heads[index / 4u];
    }
    if (head & UNDECIDED) == 0u {
        while head != 0u {
            let word = lists.words[head];
            head -= 1u;
            if packed_level(word) == LINK {
                head = packed_node(word);
                continue;
            }
            sum += arriving(word, index, receiver);
        }
    }
    var w = walk(packed_node(head));
    w.ended = head == 0u;
    while !w.ended {
        var count = 0u;
        while count < BATCH && !w.ended {
            if w.done { turn_over(&w); }
            if w.done { continue; }
            let at = source_index(w.level, w.node);
            let seen = source_bounds(at);
            if w.level > 0u && too_large_for_a_texel(seen.w, distance_square(at, seen, place) + near) {
                open(&w);
                continue;
            }
            if seen.w > 0.0 {
                notes[note(count, local)] = at;
                count += 1u;
            }
            pass_by(&w);
        }
        for (var k = 0u; k < count; k++) { sum += arriving(notes[note(k, local)], index, receiver); }
    }
    sums[index] = finished(sum, index);
}
