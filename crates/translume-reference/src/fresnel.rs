//! Exact Fresnel terms of a smooth dielectric boundary, unpolarised light.

use crate::quadrature::integrate;

/// Share of light that crosses the boundary from outside. `eta` is inside over outside index, > 0; `cos` the cosine
/// between the normal and the direction towards the light. 0..=1; exactly 1 for `eta` = 1; otherwise 0 for `cos` ≤ 0
/// and beyond the critical angle when `eta` < 1.
///
/// Source: Fresnel's equations, e.g. Born and Wolf, "Principles of Optics", §1.5.2.
#[must_use]
pub fn transmittance(eta: f64, cos: f64) -> f64 {
    if eta == 1.0 {
        return 1.0;
    }
    let refracted = refracted_cos(eta, cos);
    if cos <= 0.0 || refracted <= 0.0 {
        return 0.0;
    }
    // 1 − r² in this form does not cancel at grazing incidence.
    let product = 4.0 * eta * cos * refracted;
    let perpendicular = product / (cos + eta * refracted).powi(2);
    let parallel = product / (eta * cos + refracted).powi(2);
    0.5 * (perpendicular + parallel)
}

/// Cosine of the refracted direction by Snell's law, 0 under total internal reflection.
pub(crate) fn refracted_cos(eta: f64, cos: f64) -> f64 {
    // eta² − 1 + cos² as a product keeps its digits for eta close to 1.
    (((eta - 1.0) * (eta + 1.0) + cos * cos).max(0.0)).sqrt() / eta
}

/// Share of uniform diffuse light from outside that crosses the boundary: ∫ F_t cos dω / π over the hemisphere, 0..=1.
/// Accurate to 1e-9.
#[must_use]
pub fn hemispherical_transmittance(eta: f64) -> f64 {
    if eta == 1.0 {
        return 1.0;
    }
    if eta > 1.0 {
        return integrate(|cos| 2.0 * transmittance(eta, cos) * cos, 0.0, 1.0, 1e-11);
    }
    // Beyond the critical angle nothing enters; u = eta·cos_t removes the root there, cos d cos = u du.
    let critical = (1.0 - eta) * (1.0 + eta);
    integrate(|u| 2.0 * transmittance(eta, (critical + u * u).sqrt()) * u, 0.0, eta, 1e-11)
}

/// Diffuse Fresnel reflectance seen from inside, by the polynomial fit that the dipole is defined with. 0..=0.99;
/// exactly 0 for `eta` = 1, where the fit itself gives 0.0016.
///
/// The fit passes 1 near `eta` = 3.9 and `eta` = 0.26; it is cut at 0.99 there so that A stays finite.
///
/// Source: Egan and Hilgeman 1979; Jensen et al. 2001 for `eta` ≥ 1.
#[must_use]
pub fn diffuse_reflectance_fit(eta: f64) -> f64 {
    if eta == 1.0 {
        return 0.0;
    }
    let i = 1.0 / eta;
    let fit = if eta > 1.0 {
        -1.440 * i * i + 0.710 * i + 0.668 + 0.0636 * eta
    } else {
        -0.4399 + 0.7099 * i - 0.3319 * i * i + 0.0636 * i * i * i
    };
    fit.clamp(0.0, 0.99)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence() {
        for eta in [0.5, 0.8, 1.000_001, 1.3, 1.5, 2.5] {
            let exact = 4.0 * eta / ((eta + 1.0) * (eta + 1.0));
            // Rounding only.
            assert!((transmittance(eta, 1.0) - exact).abs() < 1e-14, "{eta}");
            assert!((transmittance(eta * 1.01, 1.0) - exact).abs() > 1e-9, "{eta}: 1 % more must be noticed");
        }
    }

    #[test]
    fn brewster_angle_passes_all_parallel_light() {
        // There r_p = 0 and r_s = (1 − eta²)/(1 + eta²).
        let eta: f64 = 1.5;
        let cos = 1.0 / (1.0 + eta * eta).sqrt();
        let r_s = (1.0 - eta * eta) / (1.0 + eta * eta);
        assert!((transmittance(eta, cos) - (1.0 - 0.5 * r_s * r_s)).abs() < 1e-14);
        assert!((transmittance(eta, cos + 0.01) - (1.0 - 0.5 * r_s * r_s)).abs() > 1e-4);
    }

    #[test]
    fn limits() {
        assert_eq!([-1.0, 0.0, 1e-9, 1.0].map(|cos| transmittance(1.0, cos)), [1.0; 4]);
        assert_eq!(transmittance(1.3, 0.0), 0.0);
        assert_eq!(transmittance(1.3, -0.5), 0.0);
        let critical = (1.0f64 - 0.8 * 0.8).sqrt();
        assert_eq!(transmittance(0.8, critical - 1e-9), 0.0);
        assert!(transmittance(0.8, critical + 1e-6) > 0.0);
        assert_eq!(hemispherical_transmittance(1.0), 1.0);
        assert_eq!(diffuse_reflectance_fit(1.0), 0.0);
    }

    /// Diffuse external reflectance in closed form (Walsh 1926, as given by Duntley 1942), for n > 1.
    fn walsh(n: f64) -> f64 {
        let (n2, n4) = (n * n, n.powi(4));
        0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
            + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
            - 2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
            + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln()
    }

    #[test]
    fn diffuse_light_matches_closed_form_and_reciprocity() {
        for eta in [1.1, 1.3, 1.5, 2.0, 4.0] {
            let exact = 1.0 - walsh(eta);
            // The promised 1e-9.
            assert!((hemispherical_transmittance(eta) - exact).abs() < 1e-9, "{eta}");
            // Equal radiance on both sides stays in balance: T(1/eta) = T(eta)/eta².
            assert!((hemispherical_transmittance(1.0 / eta) - exact / (eta * eta)).abs() < 1e-9, "1/{eta}");
            assert!(
                (hemispherical_transmittance(eta + 1e-4) - exact).abs() > 1e-7,
                "{eta}: must notice 1e-4"
            );
        }
        // The figures every table prints.
        assert!((1.0 - hemispherical_transmittance(1.3) - 0.061).abs() < 5e-4);
        assert!((1.0 - hemispherical_transmittance(1.5) - 0.092).abs() < 5e-4);
    }

    #[test]
    fn fit_stays_below_one() {
        for step in 1..100 {
            let fit = diffuse_reflectance_fit(f64::from(step) * 0.1);
            assert!((0.0..=0.99).contains(&fit));
        }
        // Internal reflectance of 1.5 is 0.596; the fit is known to be good to about 1 %.
        assert!((diffuse_reflectance_fit(1.5) - 0.596).abs() < 6e-3);
    }
}
