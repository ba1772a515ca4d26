// A source's extent.
struct Shape {
    // Mean normal by area; shorter where normals differ.
    normal: vec3f,
    // Rms radius about the middle, mm.
    spread: f32,
    // Second moments over their trace, spread².
    moments: vec3u,
    // mm².
    area: f32,
    // Σ A n (x − middle), its symmetric part, over area and spread: how the surface turns.
    turns: vec3u,
    // As a source, mm; sums that know moments take its bounds'.
    size: f32,
}
