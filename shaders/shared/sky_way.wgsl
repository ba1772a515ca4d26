// An even sky inside a body of which the mean curvature of the surface and the way straight through are known: exact in a ball and in a slab.

// Cosines and weights of ∫ f(μ) dμ from 0 to 1: Gauss's three points of √μ, within 2 % for e^−x/μ, 4 % two mean free paths deep.
const SKY_POINTS: u32 = 3u;
const SKY_COSINES: array<f32, 3> = array<f32, 3>(0.012702, 0.25, 0.787298);
const SKY_WEIGHTS: array<f32, 3> = array<f32, 3>(0.062612, 0.444444, 0.492943);

// Cosines inside of an even sky, and of ∫ f(μ) dμ over them weights for light that brings in one unit of irradiance.
fn sky_cosine(point: u32) -> f32 {
    return mix(critical_cosine(), 1.0, SKY_COSINES[point]);
}

fn sky_weight(point: u32) -> f32 {
    let eta = max(transport.eta, 1.0);
    return 2.0 * eta * eta * (1.0 - critical_cosine()) * SKY_WEIGHTS[point];
}

// From a depth to the surface, in a direction at this cosine to the normal, mm. Behind the middle of its ball a body that is thicker goes straight on.
fn way_out(depth: vec3f, thickness: f32, bulge: f32, cosine: f32) -> vec3f {
    let curved = max(bulge, 0.0);
    let round = clamp(2.0 - 0.5 * curved * thickness, 0.0, 1.0);
    let z = clamp(depth, vec3f(0.0), vec3f((1.0 + round) / max(curved, 1e-20)));
    let height = z * max(2.0 - curved * z, vec3f(0.0));
    let along = (1.0 - curved * z) * cosine;
    let root = sqrt(along * along + curved * height);
    return max(depth - z, vec3f(0.0)) + select(height / max(along + root, vec3f(1e-12)), (root - along) / max(curved, 1e-20), along < vec3f(0.0));
}
