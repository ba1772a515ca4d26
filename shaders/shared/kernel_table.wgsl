// The area-averaged profile: ln of the mean of R_d over a flat disc of rms radius s at distance r, RGB, ln(1/mm²).
// Behind a first column of what texels send to themselves, columns follow log2 r², rows log2 s², so that power laws are straight lines; the lower half of the texture holds the disc lying
// along r, the upper half the disc facing r.
struct KernelTable {
    // Smallest r² and s², mm².
    least_r2: f32,
    least_s2: f32,
    columns: u32,
    rows: u32,
}

// Whether the three channels are alike, so that one has to be evaluated.
override MONOCHROME: bool = false;

const R2_CELLS_PER_OCTAVE: f32 = 8.0;
const S2_CELLS_PER_OCTAVE: f32 = 4.0;

fn table_coordinate(value: f32, least: f32, cells_per_octave: f32, cells: u32) -> f32 {
    return min(log2(max(value / least, 1.0)) * cells_per_octave, f32(cells - 1u) - 0.001);
}

// A cell of the table, and where in it a place lies, 0..1.
struct TableCell {
    column: i32,
    row: i32,
    share: vec2f,
}

fn table_cell(table: KernelTable, r2: f32, s2: f32) -> TableCell {
    let x = table_coordinate(r2, table.least_r2, R2_CELLS_PER_OCTAVE, table.columns);
    let y = table_coordinate(s2, table.least_s2, S2_CELLS_PER_OCTAVE, table.rows);
    return TableCell(i32(x) + 1, i32(y), vec2f(x - floor(x), y - floor(y)));
}

// r2: squared distance, mm²     s2: squared rms radius of the source, mm²
// facing: as in `shared/source.wgsl`, −1 to 1       returns 1/mm²
fn area_averaged_profile(table: KernelTable, texels: texture_2d<f32>, r2: f32, s2: f32, facing: f32) -> vec3f {
    return profile_in_cell(table, texels, table_cell(table, r2, s2), facing);
}

fn profile_in_cell(table: KernelTable, texels: texture_2d<f32>, cell: TableCell, facing: f32) -> vec3f {
    let column = cell.column;
    let row = cell.row;
    let fx = cell.share.x;
    let fy = cell.share.y;
    let facing_row = row + i32(table.rows);
    let lying = mix(
        mix(textureLoad(texels, vec2i(column, row), 0).rgb, textureLoad(texels, vec2i(column + 1, row), 0).rgb, fx),
        mix(textureLoad(texels, vec2i(column, row + 1), 0).rgb, textureLoad(texels, vec2i(column + 1, row + 1), 0).rgb, fx),
        fy);
    let upright = mix(
        mix(textureLoad(texels, vec2i(column, facing_row), 0).rgb, textureLoad(texels, vec2i(column + 1, facing_row), 0).rgb, fx),
        mix(textureLoad(texels, vec2i(column, facing_row + 1), 0).rgb, textureLoad(texels, vec2i(column + 1, facing_row + 1), 0).rgb, fx),
        fy);
    if MONOCHROME { return vec3f(mix(exp(lying.r), exp(upright.r), facing)); }
    return mix(exp(lying), exp(upright), facing);
}
