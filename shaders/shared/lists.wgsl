// Lists of nodes of the tree in one memory: chains of chunks, whose last word is the index of the next chunk.
struct Lists {
    next_chunk: atomic<u32>,
    // Nodes that found no memory for their list.
    overflows: atomic<u32>,
    padding0: u32,
    padding1: u32,
    words: array<u32>,
}

const CHUNK_WORDS: u32 = 8u;
const CHUNK_ENTRIES: u32 = 7u;

struct List {
    first_chunk: u32,
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
