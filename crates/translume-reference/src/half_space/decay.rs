//! How light dies away far from where it entered.

/// κ of e^(−κr) in mean free paths, for isotropic scattering: the root of α·artanh(κ) = κ, 0 without absorption and 1 without scattering.
/// The discrete eigenvalue of one-speed transport (Case, Zweifel 1967, "Linear Transport Theory", ch. 4), not the √(3(1 − α)) of diffusion,
/// which passes 1.
#[must_use]
pub fn decay_rate(albedo: f64) -> f64 {
    // With κ = tanh y: where α·y meets tanh y.
    let (mut below, mut above) = (0.0, 1.0 / albedo.max(1e-9));
    for _ in 0..100 {
        let y = 0.5 * (below + above);
        if albedo * y < f64::tanh(y) { below = y } else { above = y }
    }
    if albedo >= 1.0 { 0.0 } else { f64::tanh(below) }
}

#[cfg(test)]
mod tests {
    use super::decay_rate;

    #[test]
    fn it_solves_its_equation() {
        for albedo in [0.2_f64, 0.5, 0.9, 0.999] {
            let rate = decay_rate(albedo);
            let off = |rate: f64| (albedo * rate.atanh() / rate - 1.0).abs();
            // Rounding, most where κ is nearly 1.
            assert!(off(rate) < 1e-6 && off(0.99 * rate) > 1e-5, "{albedo}: {rate}");
        }
        assert_eq!((decay_rate(1.0), decay_rate(0.0)), (0.0, 1.0));
        let diffusion = (3.0 * 1e-4_f64).sqrt();
        assert!((decay_rate(1.0 - 1e-4) / diffusion - 1.0).abs() < 1e-4);
    }
}
