// What a receiver sees: texels, or clusters of them. The module declares `texel_positions`, `texel_normals`, `texel_irradiance`,
// `kernel_table`.

struct Source {
    place: vec3f,
    spread: f32,
    normal: vec3f,
    power: vec3f,
}

// Texels are squares and tile the surface; discs of their areas overlap along the axes and leave gaps at the corners. Seen from the
// middle of a texel, its neighbours' discs reach too far in. Narrower by this factor, the sum over an evenly lit plane closes within
// 0.5 % instead of 1.9 % at any mean free path.
const NEIGHBOUR_NARROWING: f32 = 0.945;

// The texel as the receiver of the same index (its own disc) or any other sees it.
fn texel_source(index: u32, receiver: u32) -> Source {
    let place = texel_positions[index];
    let spread = disc_spread(place.w) * select(NEIGHBOUR_NARROWING, 1.0, index == receiver);
    return Source(place.xyz, spread, texel_normals[index].xyz, texel_irradiance[index].rgb * place.w);
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
