//! A half-space against Chandrasekhar.

use super::*;

/// Chandrasekhar's H for isotropic scattering, by iteration of his equation in the form that converges.
///
/// Source: Chandrasekhar 1950, "Radiative Transfer", §§ 37–38: 1/H(μ) = √(1 − α) + α/2 ∫ μ' H(μ') / (μ + μ') dμ'.
struct ChandrasekharH {
    albedo: f64,
    values: Vec<f64>,
}

impl ChandrasekharH {
    const NODES: usize = 400;

    fn new(albedo: f64) -> Self {
        let mut h = Self { albedo, values: vec![1.0; Self::NODES] };
        for _ in 0..200 {
            h.values = (0..Self::NODES).map(|k| h.at(Self::node(k))).collect();
        }
        h
    }

    fn node(k: usize) -> f64 {
        (k as f64 + 0.5) / Self::NODES as f64
    }

    fn at(&self, mu: f64) -> f64 {
        let each = self.values.iter().enumerate().map(|(k, h)| Self::node(k) * h / (mu + Self::node(k)));
        let integral = each.sum::<f64>() / Self::NODES as f64;
        1.0 / ((1.0 - self.albedo).sqrt() + 0.5 * self.albedo * integral)
    }

    /// Radiance towards `mu` under irradiance π on a plane that faces light from `mu_0`.
    fn radiance(&self, mu_0: f64, mu: f64) -> f64 {
        0.25 * self.albedo * mu_0 / (mu_0 + mu) * self.at(mu_0) * self.at(mu)
    }
}

/// A half-space in parallel light, for several albedos at once and several angles: α/4 · μ₀/(μ₀ + μ) · H(μ₀) H(μ) · E/π.
#[test]
fn half_space_shines_as_chandrasekhar_says() {
    let albedos = [0.5, 0.9, 0.99];
    let forms = albedos.map(ChandrasekharH::new);
    let medium = volume(albedos.map(|a| 2.0 * a), albedos.map(|a| 2.0 * (1.0 - a)));
    for (mu_0, mu) in [(1.0, 1.0), (0.4, 0.8), (0.8, 0.3)] {
        let across = |mu: f64| (1.0 - mu * mu).sqrt();
        let eye = [0.0, 100.0 * mu, 100.0 * across(mu)];
        let light = sun([across(mu_0), mu_0, 0.0]);
        // So narrow that mu is the same for all pixels.
        let estimate = picture(&half_space(), medium, &[light], camera(eye, 1e-3, 16), 64);
        for k in 0..3 {
            let exact = forms[k].radiance(mu_0, mu);
            let found = mean(&estimate, k);
            // 16,384 paths: measured 0.4 to 0.7 %; four standard errors leave one chance in ten thousand.
            assert!(found[1] < 0.01 * exact, "{found:?}");
            assert!(agree(found, exact, 4.0), "{mu_0} {mu} {}: {found:?} {exact}", albedos[k]);
            assert!(!agree(found, ChandrasekharH::new(0.93 * albedos[k]).radiance(mu_0, mu), 4.0));
        }
    }
}

/// What leaves a half-space in all: R(μ₀) = 1 − H(μ₀) √(1 − α), from radiances over the hemisphere.
#[test]
fn half_space_returns_its_albedo() {
    for albedo in [0.6, 0.95] {
        let form = ChandrasekharH::new(albedo);
        for mu_0 in [1.0, 0.5] {
            let light = sun([(1.0f64 - mu_0 * mu_0).sqrt(), mu_0, 0.0]);
            let medium = volume([albedo; 3], [1.0 - albedo; 3]);
            // By reciprocity light from all around seen along mu_0 is what light from mu_0 gives in all directions.
            let eye = [100.0 * (1.0f64 - mu_0 * mu_0).sqrt(), 100.0 * mu_0, 0.0];
            let estimate = picture(&half_space(), medium, &[sky()], camera(eye, 1e-3, 16), 256);
            let exact = 1.0 - form.at(mu_0) * (1.0 - albedo).sqrt();
            let found = mean(&estimate, 0);
            // 65,536 paths, most of which bring all or nothing: measured 0.3 to 0.6 %.
            assert!(found[1] < 0.008 * exact, "{found:?}");
            assert!(agree(found, exact, 4.0), "{albedo} {mu_0}: {found:?} {exact}");
            assert!(!agree(found, 1.06 * exact, 4.0), "6 % must be noticed");
            // The same by looking from many sides: ∫ L 2μ dμ / E with the midpoints of rings.
            let side = |k: u32| {
                let mu = (f64::from(k) + 0.5) / 4.0;
                let eye = [0.0, 100.0 * mu, 100.0 * (1.0 - mu * mu).sqrt()];
                let ring =
                    picture(&half_space(), medium, std::slice::from_ref(&light), camera(eye, 1e-3, 8), 32);
                mean(&ring, 0)[0] / form.radiance(mu_0, mu)
            };
            let ratio = (0..4).map(side).sum::<f64>() / 4.0;
            // 2,048 paths for each of four directions: standard error 0.9 %.
            assert!((ratio - 1.0).abs() < 0.035, "{ratio}");
        }
    }
}
