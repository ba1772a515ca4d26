// What the groups of receivers left: their expansions, and the sources they kept open.
struct Lists {
    taken: u32,
    overflows: u32,
    padding0: u32,
    padding1: u32,
    words: array<u32>,
}

@group(1) @binding(0) var<uniform> scatter: Dual;
@group(1) @binding(1) var<storage, read> bounds: array<vec4f>;
@group(1) @binding(2) var<storage, read> lamps: array<Lamp>;
@group(1) @binding(3) var<storage, read> expansions: array<Expansion>;
@group(1) @binding(4) var<storage, read> heads: array<u32>;
@group(1) @binding(5) var<storage, read> lists: Lists;
// On which texel each vertex, or each pixel of the atlas, stands.
@group(1) @binding(6) var<storage, read> standing: array<u32>;
@group(1) @binding(7) var kernel_table: texture_2d<f32>;

// Of a pixel without one, and of a point that is not the middle of one.
const NO_TEXEL: u32 = 0xffffffffu;

// Radiant exitance at any point on a texel. In w the kernel evaluations it took.
fn exitance_at(receiver: vec3f, texel: u32) -> vec4f {
    var sum = vec4f(0.0);
    var head = ROOT_HEAD | UNDECIDED;
    let group = texel / 4u;
    let seen = bounds[scatter.first_receiver + group];
    // A group that nobody was expected to need left nothing.
    if scatter.start_level > 0u && seen.w != NOT_NEEDED {
        let e = moved(expansions[group], receiver - seen.xyz);
        sum = vec4f(leaving(e, lamps[texel].normal), e.evaluations);
        head = heads[group];
    }
    let undecided = (head & UNDECIDED) != 0u;
    head = packed_node(head);
    var w = walk(head);
    w.ended = head == 0u;
    while !w.ended {
        if undecided {
            if w.done { turn_over(&w); }
            if w.done { continue; }
            let at = source_index(w.level, w.node);
            let source = bounds[at];
            let offset = receiver - source.xyz;
            if w.level > 0u && too_large_for_a_texel(source.w, dot(offset, offset) + scatter.z_r_squared) {
                open(&w);
                continue;
            }
            if source.w > 0.0 { sum += sent(at, NO_TEXEL, receiver, lamps[texel].normal); }
            pass_by(&w);
            continue;
        }
        let word = lists.words[head];
        let link = packed_level(word) == LINK;
        head = select(head - 1u, packed_node(word), link);
        w.ended = head == 0u;
        if !link { sum += sent(word, NO_TEXEL, receiver, lamps[texel].normal); }
    }
    return max(sum, vec4f(0.0));
}
