// One of three strata of equal power of a ray that ends at an optical depth and leaves this share behind; optical depths.
struct Stratum {
    begin: vec3f,
    to: vec3f,
    mean: vec3f,
}

fn stratum(end: vec3f, share: vec3f, k: u32) -> Stratum {
    let thin = end < vec3f(0.02);
    let last = min(end, vec3f(80.0));
    let begin = select(-log(1.0 - f32(k) / 3.0 * share), f32(k) / 3.0 * end, thin);
    let to = select(select(-log(1.0 - f32(k + 1u) / 3.0 * share), last, k == 2u), f32(k + 1u) / 3.0 * end, thin);
    let mean = ((1.0 + begin) * exp(-begin) - (1.0 + to) * exp(-to)) * 3.0 / max(share, vec3f(1e-20));
    return Stratum(begin, to, select(mean, 0.5 * (begin + to), thin));
}
