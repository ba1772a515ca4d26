// Lists of nodes of the tree, of any length, in one memory. A list is a chain of runs: the run written last comes first and may be short,
// all others have RUN entries. In front of a run stands where the next one begins.
struct Lists {
    // Words taken, or that would have been.
    taken: atomic<u32>,
    // Nodes that found no room for their list.
    overflows: atomic<u32>,
    padding0: u32,
    padding1: u32,
    words: array<u32>,
}

const RUN: u32 = 15u;

struct List {
    first_run: u32,
    length: u32,
}

// A node of the tree in one word.
fn packed(level: u32, node: u32) -> u32 {
    return level << 28u | node;
}

fn packed_level(entry: u32) -> u32 {
    return entry >> 28u;
}

fn packed_node(entry: u32) -> u32 {
    return entry & 0x0fffffffu;
}
