// Lists of nodes of the tree, of any length, in one memory. A list is read backwards from its head, the index of its last word, until a word
// that is no node: a link to the head of what was written before, or to 0, where the list ends. The empty list's head is 0.

// The list of the root alone.
const ROOT_HEAD: u32 = 2u;
const ROOT_WORDS: u32 = 3u;
// In place of a level.
const LINK: u32 = 15u;

// A node of the tree in one word.
fn packed(level: u32, node: u32) -> u32 {
    return (level << 28u) | node;
}

fn packed_level(entry: u32) -> u32 {
    return entry >> 28u;
}

fn packed_node(entry: u32) -> u32 {
    return entry & 0x0fffffffu;
}
