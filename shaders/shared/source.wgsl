// What a receiver sees: texels, or clusters of them. The module declares `kernel_table`.

struct Source {
    place: vec3f,
    spread: f32,
    normal: vec3f,
    power: vec3f,
}

fn received(table: KernelTable, receiver: vec3f, source: Source) -> vec3f {
    let offset = receiver - source.place;
    let facing = facing_square(offset, source.normal);
    return source.power * area_averaged_profile(table, kernel_table, dot(offset, offset), source.spread * source.spread, facing);
}

// Squared cosine between a source's normal and the line to a receiver.
fn facing_square(offset: vec3f, normal: vec3f) -> f32 {
    let r2 = dot(offset, offset);
    let along = dot(offset, normal);
    return min(select(0.0, along * along / r2, r2 > 0.0), 1.0);
}

// Nodes of a level of the tree; level 0 is the texels.
fn level_count(texel_count: u32, level: u32) -> u32 {
    return ((texel_count - 1u) >> (2u * level)) + 1u;
}
