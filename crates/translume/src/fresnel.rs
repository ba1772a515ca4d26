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
    transmitted_moment(eta, 1)
}

/// (n + 1)·∫₀¹ F_t(eta, c)·cⁿ dc, 0..=1: with n = 1 and 2 and the inverse index, 1 − 2C₁ and 1 − 3C₂ of d'Eon, Irving 2011.
pub(crate) fn transmitted_moment(eta: f64, n: i32) -> f64 {
    // The cosine substitution c = u² tames the square root at grazing angles; for eta < 1 the integral starts at the critical angle.
    const STEPS: usize = 2048;
    if eta == 1.0 {
        return 1.0;
    }
    let critical = if eta < 1.0 { (1.0 - eta * eta).sqrt() } else { 0.0 };
    (0..STEPS)
        .map(|k| {
            let u = (k as f64 + 0.5) / STEPS as f64;
            let cosine = critical + (1.0 - critical) * u * u;
            let weight = f64::from(n + 1) * cosine.powi(n);
            transmittance(eta, cosine) * weight * (1.0 - critical) * 2.0 * u / STEPS as f64
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

    /// C₁ and C₂ at η = 1.3 from the integrals' definition, ∫ F_r cosⁿ sin dθ, by a dense sum over the angle.
    #[test]
    fn moments_follow_their_definition() {
        const STEPS: u32 = 100_000;
        for n in [1, 2] {
            let inside = |k: u32| {
                let angle = std::f64::consts::FRAC_PI_2 * (f64::from(k) + 0.5) / f64::from(STEPS);
                (1.0 - transmittance(1.0 / 1.3, angle.cos())) * angle.cos().powi(n) * angle.sin()
            };
            let moment = (0..STEPS).map(inside).sum::<f64>() * std::f64::consts::FRAC_PI_2 / f64::from(STEPS);
            let reflected = f64::from(n + 1) * moment;
            // 1e-6: the midpoint rule at the critical angle.
            assert!((1.0 - transmitted_moment(1.0 / 1.3, n) - reflected).abs() < 1e-6, "{n}: {reflected}");
            assert!((1.0 - transmitted_moment(1.0 / 1.31, n) - reflected).abs() > 1e-4, "another index");
        }
    }

    #[test]
    fn reciprocity_of_the_hemispherical_integral() {
        // T(1/η) = T(η)·η² over the hemisphere (étendue); holds only if both branches are right.
        let (out, back) = (hemispherical_transmittance(1.4), hemispherical_transmittance(1.0 / 1.4));
        assert!((out / (1.4 * 1.4) - back).abs() < 1e-4, "{out} {back}");
    }
}
