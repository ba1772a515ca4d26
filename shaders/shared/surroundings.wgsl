const MOST_NEAR: u32 = 30u;

// The sites around one, itself included.
struct Surroundings {
    count: u32,
    // How far from a texel they count, mm.
    reach: f32,
    sites: array<u32, MOST_NEAR>,
}
