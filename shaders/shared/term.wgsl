// A source off the surface.
struct Term {
    // How far below the surface, along its own normal, a source lies, RGB, mm.
    depth: vec3f,
    padding0: u32,
    // What it counts, RGB.
    weight: vec3f,
    padding1: u32,
}
