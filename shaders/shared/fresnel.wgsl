// Unpolarised transmittance of a smooth dielectric for light that arrives from outside.
// eta: index inside over index outside, > 0        cosine: angle to the normal outside, 0..1
// For eta < 1 everything beyond the critical angle is reflected. Exactly 1 at eta = 1.
fn fresnel_transmittance(eta: f32, cosine: f32) -> f32 {
    if eta == 1.0 { return 1.0; }
    let outside = clamp(cosine, 0.0, 1.0);
    let inside = refracted_cosine(eta, outside);
    if inside <= 0.0 { return 0.0; }
    let s = (outside - eta * inside) / (outside + eta * inside);
    let p = (eta * outside - inside) / (eta * outside + inside);
    return 1.0 - 0.5 * (s * s + p * p);
}

// Cosine inside by Snell's law; 0 beyond the critical angle.
fn refracted_cosine(eta: f32, outside: f32) -> f32 {
    return sqrt(max(1.0 - (1.0 - outside * outside) / (eta * eta), 0.0));
}
