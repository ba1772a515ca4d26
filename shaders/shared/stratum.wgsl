// A stratum of a ray that ends at an optical depth and leaves this share behind; optical depths.
struct Stratum {
    begin: vec3f,
    to: vec3f,
    mean: vec3f,
}

const BEFORE: array<f32, STRATA> = array<f32, STRATA>(0.0, 0.4, 0.7, 0.9);

fn stratum(end: vec3f, share: vec3f, k: u32) -> Stratum {
    let thin = end < vec3f(0.02);
    let last = min(end, vec3f(80.0));
    let before = BEFORE[k];
    let up_to = before + SHARES[k];
    let begin = select(-log(1.0 - before * share), before * end, thin);
    let to = select(select(-log(1.0 - up_to * share), last, k + 1u == STRATA), up_to * end, thin);
    let mean = ((1.0 + begin) * exp(-begin) - (1.0 + to) * exp(-to)) / max(SHARES[k] * share, vec3f(1e-20));
    return Stratum(begin, to, select(mean, 0.5 * (begin + to), thin));
}
