// What a receiver sees: texels, or clusters of them. The module declares `kernel_table`.

// Whether light wanders differently far from source to source.
override SCALED: bool = false;

// own: whether the receiver is in the middle of the source
fn received(table: KernelTable, offset: vec3f, lamp: Lamp, own: bool) -> vec3f {
    let spread = lamp.spread * select(1.0, 1.0 / NEIGHBOUR_NARROWING, own);
    let c2 = scale_square(lamp);
    let profile = area_averaged_profile(table, kernel_table, c2 * dot(offset, offset), c2 * spread * spread, facing_square(offset, lamp.normal));
    return lamp.power * (c2 * profile);
}

// With scattering c times as strong, R_d(r) becomes c²·R_d(c·r).
fn scale_square(lamp: Lamp) -> f32 {
    if !SCALED { return 1.0; }
    let scale = marked_scale(lamp.marks);
    return scale * scale;
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
