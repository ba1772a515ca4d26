// What a receiver sees: texels, or clusters of them. The module declares `kernel_table`.

struct Source {
    place: vec3f,
    spread: f32,
    normal: vec3f,
    power: vec3f,
}

fn received(table: KernelTable, receiver: vec3f, source: Source) -> vec3f {
    let offset = receiver - source.place;
    let r2 = dot(offset, offset);
    let along = dot(offset, source.normal);
    let facing = select(0.0, along * along / r2, r2 > 0.0);
    return source.power * area_averaged_profile(table, kernel_table, r2, source.spread * source.spread, min(facing, 1.0));
}

// Nodes of a level of the tree; level 0 is the texels.
fn level_count(texel_count: u32, level: u32) -> u32 {
    return ((texel_count - 1u) >> (2u * level)) + 1u;
}
