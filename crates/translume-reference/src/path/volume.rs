//! What fills the body.

use std::f64::consts::FRAC_1_PI;

use glam::{DVec2, DVec3};

use crate::Medium;
use crate::dice::Dice;
use crate::lights::strata::frame;

/// A homogeneous scattering medium behind a smooth boundary, without the reduction that diffusion makes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// Scattering coefficient σ_s, RGB, 1/mm. Finite, ≥ 0.
    pub sigma_s: [f64; 3],
    /// Absorption coefficient σ_a, RGB, 1/mm. Finite, ≥ 0.
    pub sigma_a: [f64; 3],
    /// Mean cosine of the scattering angle, −1 < g < 1; 0 scatters evenly.
    pub g: f64,
    /// Index of refraction η, inside over outside. Positive; 1 is an index-matched boundary.
    pub ior: f64,
}

impl Volume {
    /// The medium with σ_s = σ_s' / (1 − g).
    #[must_use]
    pub fn new(medium: &Medium, g: f64) -> Self {
        let sigma_s = medium.sigma_s_prime.map(|s| s / (1.0 - g));
        Self { sigma_s, sigma_a: medium.sigma_a, g, ior: medium.ior }
    }

    /// The channels that scatter, those of equal extinction together: they can share their paths.
    pub(super) fn groups(&self) -> Vec<Group> {
        let mut groups: Vec<Group> = Vec::new();
        for channel in (0..3).filter(|&k| self.sigma_s[k] > 0.0) {
            let sigma_t = self.sigma_s[channel] + self.sigma_a[channel];
            let albedo = self.sigma_s[channel] / sigma_t;
            match groups.iter_mut().find(|group| group.sigma_t == sigma_t) {
                Some(group) => group.albedo[channel] = albedo,
                None => {
                    let mut group = Group { sigma_t, albedo: [0.0; 3] };
                    group.albedo[channel] = albedo;
                    groups.push(group);
                }
            }
        }
        groups
    }

    /// Henyey and Greenstein 1941: density of a scattering angle, 1/sr.
    pub(super) fn phase(&self, cos: f64) -> f64 {
        let g = self.g;
        if g == 0.0 {
            return 0.25 * FRAC_1_PI;
        }
        let square = 1.0 + g * g - 2.0 * g * cos;
        0.25 * FRAC_1_PI * (1.0 - g * g) / (square * square.sqrt())
    }

    /// A direction with that density around the last one.
    pub(super) fn scatter(&self, direction: DVec3, dice: &mut Dice) -> DVec3 {
        // A point of the unit disc has a direction and, apart from it, an even square of its radius (Marsaglia 1972).
        let (side, u) = loop {
            let [x, y] = dice.pair().map(|x| 2.0 * x - 1.0);
            let square = x * x + y * y;
            if 0.0 < square && square <= 1.0 {
                break (DVec2::new(x, y) / square.sqrt(), square);
            }
        };
        let g = self.g;
        let cos = if g.abs() < 1e-4 {
            // To first order in g; the closed form cancels here.
            let even = 2.0 * u - 1.0;
            even + 1.5 * g * (1.0 - even * even)
        } else {
            let share = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
            (1.0 + g * g - share * share) / (2.0 * g)
        };
        let across = (1.0 - cos * cos).max(0.0).sqrt();
        let local = (side * across).extend(cos);
        if g == 0.0 { local } else { (frame(direction) * local).normalize() }
    }
}

/// Channels that share their paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Group {
    /// Extinction, 1/mm.
    pub sigma_t: f64,
    /// σ_s / σ_t; 0 in channels of other groups.
    pub albedo: [f64; 3],
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn volume(g: f64) -> Volume {
        Volume { sigma_s: [1.0; 3], sigma_a: [0.0; 3], g, ior: 1.0 }
    }

    /// Mean of a function of the angle's cosine over many scatterings.
    fn mean(g: f64, of: impl Fn(f64) -> f64) -> f64 {
        let (volume, axis) = (volume(g), DVec3::new(0.48, 0.6, -0.64));
        let mut dice = Dice::new([1, 2, 3, 4]);
        let count = 200_000;
        let each = (0..count).map(|_| volume.scatter(axis, &mut dice).dot(axis));
        each.map(of).sum::<f64>() / f64::from(count)
    }

    /// The moments of the phase function are powers of g.
    #[test]
    fn scattering_has_the_mean_cosine() {
        for g in [-0.7, -1e-5, 0.0, 1e-3, 0.3, 0.9] {
            let [first, second] = [mean(g, |cos| cos), mean(g, |cos| 1.5 * cos * cos - 0.5)];
            // The standard error of a mean of 200,000 numbers between −1 and 1 is below 0.0014.
            assert!((first - g).abs() < 0.005 && (second - g * g).abs() < 0.005, "{g}: {first} {second}");
            assert!((first - g - 0.01).abs() > 0.005, "a hundredth must be noticed");
        }
    }

    /// Directions are as frequent as the density says: the mean of 1/density is the whole sphere.
    #[test]
    fn density_is_that_of_the_directions() {
        for g in [-0.5, 0.0, 0.4] {
            let area = mean(g, |cos| 1.0 / volume(g).phase(cos)) / (2.0 * TAU);
            // 1/density varies by 27 between forwards and backwards at |g| = 0.5: standard error 0.3 %.
            assert!((area - 1.0).abs() < 0.015, "{g}: {area}");
            let other = mean(g, |cos| 1.0 / volume(g + 0.05).phase(cos)) / (2.0 * TAU);
            assert!((other - 1.0).abs() > 0.005 || g == 0.0, "{g}: {other}");
        }
    }

    #[test]
    fn channels_of_equal_extinction_share_paths() {
        let mixed = Volume { sigma_s: [1.0, 2.0, 0.5], sigma_a: [0.5, 0.0, 1.0], ..volume(0.0) };
        let groups = mixed.groups();
        assert_eq!(groups.len(), 2);
        assert_eq!(groups[0], Group { sigma_t: 1.5, albedo: [1.0 / 1.5, 0.0, 0.5 / 1.5] });
        assert_eq!(groups[1], Group { sigma_t: 2.0, albedo: [0.0, 1.0, 0.0] });
        assert!(Volume { sigma_s: [0.0; 3], ..mixed }.groups().is_empty());
    }
}
