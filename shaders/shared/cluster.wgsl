// A group of texels seen as one source. Lengths in mm.
struct Cluster {
    // Power-weighted centroid.
    centroid: vec3f,
    // Power-weighted rms radius, the members' own discs included.
    spread: f32,
    // Sum of E·A, RGB.
    power: vec3f,
    // No member's centre is further from the centroid.
    radius: f32,
    // Power-weighted mean normal, unit length, or zero where it cancels.
    normal: vec3f,
    // Sum of live areas, mm².
    area: f32,
}

// Rms radius of a disc of this area.
fn disc_spread(area: f32) -> f32 {
    return sqrt(area * 0.15915494);
}
