// What a receiver sees: texels, or clusters of them. The module declares `kernel_table`.

// Whether light wanders differently far from source to source.
override SCALED: bool = false;

// own: whether the receiver is in the middle of the source
fn received(table: KernelTable, offset: vec3f, lamp: Lamp, own: bool) -> vec3f {
    let c2 = scale_square(lamp);
    var cell = table_cell(table, c2 * dot(offset, offset), c2 * lamp.spread * lamp.spread);
    if own {
        cell.column = 0;
        cell.share.x = 0.0;
    }
    return lamp.power * (c2 * profile_in_cell(table, kernel_table, cell, facing(offset, lamp)));
}

// With scattering c times as strong, R_d(r) becomes c²·R_d(c·r).
fn scale_square(lamp: Lamp) -> f32 {
    if !SCALED { return 1.0; }
    let scale = marked_scale(lamp.marks);
    return scale * scale;
}

// How much a source faces a receiver: 1 where it does not reach towards it, 0 as a disc that lies along the line, below where it reaches
// further than that. To second order in its size nothing else counts.
fn facing(offset: vec3f, lamp: Lamp) -> f32 {
    let m = unpacked_moments(lamp.moments);
    let r2 = dot(offset, offset);
    let along = dot(m.diagonal, offset * offset) + 2.0 * dot(m.mixed, offset.xxy * offset.yzz);
    return min(1.0 - 2.0 * select(0.5, along / r2, r2 > 0.0), 1.0);
}
