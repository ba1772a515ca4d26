// A group of texels as it bounds rays, and as it receives. Lengths in mm.
struct Node {
    // Middle by area, and no disc of a member reaches further from it.
    centre: vec3f,
    radius: f32,
    // Mean of the texels' places, and none is further from it.
    middle: vec3f,
    reach: f32,
    // Rms distance of the texels from it.
    scatter: f32,
    texels: f32,
    // Rms distance of the area from the centre.
    spread: f32,
    padding: f32,
}

// A texel is a square of unknown turn; the circle around it leaves no gaps.
fn disc_reach(area: f32) -> f32 {
    return sqrt(0.5 * area);
}
