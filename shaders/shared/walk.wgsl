// What both the stage and whoever takes over its lists know of a body. The module declares `scatter`, `bounds`, `lamps`, `expansions`, `heads`,
// `lists` and `kernel_table`.

struct Dual {
    table: KernelTable,
    texel_count: u32,
    // Level of the receivers of this dispatch.
    level: u32,
    // Level of the first receivers, which take over the root.
    start_level: u32,
    top_level: u32,
    // Opening angle: accepted when source size² + (RECEIVER_WEIGHT·receiver size)² < theta²·(distance² + z_r²).
    theta_squared: f32,
    // The same for single texels, which have no size.
    leaf_theta_squared: f32,
    // Square of the length below which all three channels are smooth, mm².
    z_r_squared: f32,
    // Words there are in `lists`.
    capacity: u32,
    // Where receivers begin in `bounds`.
    first_receiver: u32,
    // The first receiver whose expansion is kept.
    first_expansion: u32,
    padding0: u32,
    padding1: u32,
    // Of kernels whose sources lie off the surface.
    terms: array<Term, 2>,
    // Where each level above the texels begins among the receivers.
    offsets: array<vec4u, 4>,
    // Where each level begins among the sources in `bounds`.
    sources: array<vec4u, 4>,
}

// Beside the head of a list of a node of the first level: the list is an ancestor's.
const UNDECIDED: u32 = 0x80000000u;

// A walk through the subtrees of a list's nodes.
struct Walk {
    // The next word of the list.
    cursor: u32,
    // Level of the listed node whose subtree is walked, and where in it the walk is.
    top: u32,
    level: u32,
    node: u32,
    // Whether the subtree is done, and whether the list is.
    done: bool,
    ended: bool,
}

fn walk(head: u32) -> Walk {
    return Walk(head, 0u, 0u, 0u, true, false);
}

// To the next word of the list.
fn turn_over(w: ptr<function, Walk>) {
    let word = lists.words[(*w).cursor];
    (*w).top = packed_level(word);
    (*w).level = (*w).top;
    (*w).node = packed_node(word);
    (*w).done = (*w).top == LINK;
    (*w).cursor = select((*w).cursor - 1u, (*w).node, (*w).done);
    (*w).ended = (*w).cursor == 0u && (*w).done;
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

fn source_index(level: u32, node: u32) -> u32 {
    return scatter.sources[level / 4u][level % 4u] + node;
}

fn receiver_index(level: u32, node: u32) -> u32 {
    return scatter.offsets[level / 4u][level % 4u] + node;
}

// Whether a single texel has to open a source of this size whose distance, squared, with that below which sums are smooth, is `sight`.
fn too_large_for_a_texel(size: f32, sight: f32) -> bool {
    return size * size > scatter.leaf_theta_squared * sight;
}
