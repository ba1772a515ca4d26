// A group of sites as it bounds rays, and as it receives. Lengths in mm.
struct Node {
    // Middle by area, and no disc of a member reaches further from it.
    centre: vec3f,
    radius: f32,
    // Which way it faces, unit length, and no disc reaches further from the centre along that.
    axis: vec3f,
    thickness: f32,
    // Mean of the sites' places, and none is further from it.
    middle: vec3f,
    reach: f32,
    // Rms distance of the sites from it, and how many there are.
    scatter: f32,
    sites: f32,
    padding0: f32,
    padding1: f32,
}

// How far a node reaches along a direction, from its centre.
fn extent_along(node: Node, direction: vec3f) -> f32 {
    let cosine = min(abs(dot(node.axis, direction)), 1.0);
    return node.thickness * cosine + node.radius * sqrt(1.0 - cosine * cosine);
}

// Where the surface is stretched sites are wider, and those at a rim hold less than what lies around theirs.
fn site_width(area: f32) -> f32 {
    return sqrt(max(area, 2.0 * transport.reach_squared));
}

// Square of how far from its middle a site is met: a square of unknown turn, where the circle around it leaves no gaps; of several texels, which are also
// in a row, twice that.
fn disc_reach_squared(area: f32) -> f32 {
    return select(1.0, 2.0, transport.texels_per_site > 1u) * max(0.5 * area, transport.reach_squared);
}
