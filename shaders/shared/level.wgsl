// A level of the tree above the texels, as whoever sums up four nodes to one is told of it.
struct Level {
    // Number of nodes below, and of nodes of this level.
    child_count: u32,
    node_count: u32,
    // Where the children and the nodes of this level begin among the nodes above the texels.
    child_offset: u32,
    node_offset: u32,
    // Where the sources of this level, and its receivers, begin in `bounds`.
    source_offset: u32,
    receiver_offset: u32,
    // Where the sources of the level below begin in `bounds`.
    child_sources: u32,
    padding: u32,
}
