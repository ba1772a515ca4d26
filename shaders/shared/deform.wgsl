struct Deform {
    // Model space to millimetres.
    model: mat4x4f,
    // Inverse transpose of the model matrix.
    normal: mat4x4f,
    warp: Warp,
    vertex_count: u32,
    target_count: u32,
    influences_per_vertex: u32,
    // −1 where the model matrix mirrors, else 1.
    winding: f32,
}
