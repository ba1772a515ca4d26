//! Fresnel reflection of a smooth dielectric, in double precision, for what is computed once per medium.

/// Unpolarised transmittance for light that arrives from outside.
/// `eta`: index inside over outside, > 0. `cosine`: to the normal outside, 0..1.
pub(crate) fn transmittance(eta: f64, cosine: f64) -> f64 {
    if eta == 1.0 {
        return 1.0;
    }
    let inside_squared = 1.0 - (1.0 - cosine * cosine) / (eta * eta);
    if inside_squared <= 0.0 {
        return 0.0;
    }
    let inside = inside_squared.sqrt();
    let s = (cosine - eta * inside) / (cosine + eta * inside);
    let p = (eta * cosine - inside) / (eta * cosine + inside);
    1.0 - 0.5 * (s * s + p * p)
}

/// Share of a uniform sky that enters: ∫ F_t cos dω / π = 1 − F_dr,ext.
pub(crate) fn hemispherical_transmittance(eta: f64) -> f64 {
    // The cosine substitution c = u² tames the square root at grazing angles; for eta < 1 the integral starts at the critical angle.
    const STEPS: usize = 2048;
    let critical = if eta < 1.0 { (1.0 - eta * eta).sqrt() } else { 0.0 };
    (0..STEPS)
        .map(|k| {
            let u = (k as f64 + 0.5) / STEPS as f64;
            let cosine = critical + (1.0 - critical) * u * u;
            transmittance(eta, cosine) * 2.0 * cosine * (1.0 - critical) * 2.0 * u / STEPS as f64
        })
        .sum()
}

/// Diffuse internal reflectance F_dr, the polynomial fits of Egan and Hilgeman 1973 that Jensen et al. 2001 use; exactly 0 at eta = 1.
pub(crate) fn diffuse_internal_reflectance(eta: f64) -> f64 {
    if eta == 1.0 {
        0.0
    } else if eta > 1.0 {
        -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta
    } else {
        -0.4399 + 0.7099 / eta - 0.3319 / (eta * eta) + 0.0636 / (eta * eta * eta)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence_matches_the_textbook() {
        for eta in [0.8_f64, 1.0, 1.3, 1.5, 2.4] {
            let reflected = ((eta - 1.0) / (eta + 1.0)).powi(2);
            assert!((transmittance(eta, 1.0) - (1.0 - reflected)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_uniform_sky_loses_what_the_reference_notes_say() {
        // 6.1 % at eta 1.3 and 9.2 % at eta 1.5, quoted to that precision.
        assert!((1.0 - hemispherical_transmittance(1.3) - 0.061).abs() < 5e-4);
        assert!((1.0 - hemispherical_transmittance(1.5) - 0.092).abs() < 5e-4);
        assert!((hemispherical_transmittance(1.0) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn reciprocity_of_the_hemispherical_integral() {
        // T(1/η) = T(η)·η² over the hemisphere (étendue); holds only if both branches are right.
        let (out, back) = (hemispherical_transmittance(1.4), hemispherical_transmittance(1.0 / 1.4));
        assert!((out / (1.4 * 1.4) - back).abs() < 1e-4, "{out} {back}");
    }
}
