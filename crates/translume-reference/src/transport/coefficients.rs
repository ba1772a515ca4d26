//! What diffusion makes of a medium.

use crate::fresnel::transmittance;
use crate::path::Volume;
use crate::quadrature::integrate_panels;

/// Surfaces that bend more, in mean free paths, count as those.
const MOST_BENT: f64 = 0.1;

/// What neither scatters nor absorbs is taken to absorb this much, 1/mm.
const CLEAR: f64 = 1e-12;

/// One channel of a medium.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coefficients {
    /// Extinction σ_t, reduced, 1/mm.
    pub extinction: f64,
    /// σ_s' / σ_t.
    pub albedo: f64,
    /// Grosjean's (2σ_a + σ_s') / 3σ_t², mm.
    pub diffusion: f64,
    /// √(σ_a / D), 1/mm.
    pub decay: f64,
    /// c_G: what leaves per fluence at the surface, by Robin's condition.
    pub robin: f64,
    /// Mean cosine of the phase function.
    pub g: f64,
    /// Of the surface; the same in all channels.
    pub boundary: Boundary,
}

impl Coefficients {
    pub fn of(volume: &Volume) -> [Self; 3] {
        let boundary = Boundary::of(volume.ior);
        let robin = 1.0 / (3.0 * boundary.end);
        std::array::from_fn(|k| {
            let scattering = volume.sigma_s[k] * (1.0 - volume.g);
            let absorption = volume.sigma_a[k].max(CLEAR - scattering);
            let extinction = scattering + absorption;
            let diffusion = (2.0 * absorption + scattering) / (3.0 * extinction * extinction);
            let decay = (absorption / diffusion).sqrt();
            Self {
                extinction,
                albedo: scattering / extinction,
                diffusion,
                decay,
                robin,
                g: volume.g,
                boundary,
            }
        })
    }

    /// c_G at a surface of this mean curvature, 1/mm. In a ball r φ is what φ is in a slab, so that its slope is steeper by φ / R than under a plane
    /// (Davison and Sykes 1957); around a cavity it is less steep, and around a small one about half. Balls of less than a mean free path and a half are no
    /// matter of diffusion.
    fn robin_at(&self, bulge: f64) -> f64 {
        self.robin + (self.boundary.bend * self.diffusion * bulge).clamp(-0.5 * self.robin, 0.5 * self.robin)
    }

    /// What crosses the surface outwards, less what comes in: c_G (φ − 4 η² Γ). Light that is the same everywhere is η² times as bright inside.
    pub fn net_flux(&self, bulge: f64, fluence: f64, returning: f64) -> f64 {
        self.robin_at(bulge) * (fluence - 4.0 * self.ior() * self.ior() * returning)
    }

    /// What crosses the surface outwards: that and what of Γ gets in.
    pub fn exitance(&self, bulge: f64, fluence: f64, returning: f64) -> f64 {
        self.net_flux(bulge, fluence, returning) + self.boundary.open * returning
    }

    /// What goes on from the surface: that and what of Γ the surface throws back.
    pub fn leaving(&self, bulge: f64, fluence: f64, returning: f64) -> f64 {
        self.net_flux(bulge, fluence, returning) + returning
    }

    /// By how many mean free paths the exact field at an optical depth is that of a shallower one.
    pub fn hopf_shift(&self, depth: f64) -> f64 {
        let [most, rate] = self.boundary.shift;
        most * (-rate * depth.max(0.0)).exp()
    }

    /// Index of refraction, inside over outside.
    pub fn ior(&self) -> f64 {
        self.boundary.ior
    }

    /// Cosine inside from which on light gets in and out.
    pub fn critical(&self) -> f64 {
        critical(self.ior())
    }

    /// Optical depth that is moved to the surface.
    pub fn hopf_surface(&self) -> f64 {
        let most = self.hopf_shift(0.0).max(0.0);
        (0..60).fold(0.0, |x: f64, _| 0.5 * (x + most * (-self.hopf_rate() * x).exp()))
    }

    /// How much more of what diffusion lacks there is along a ray at this cosine inside than of what scattered twice: what a surface throws back inside
    /// scatters again close to it.
    pub fn lean(&self, cosine: f64) -> f64 {
        cosine.powf(-self.boundary.lean)
    }

    /// And how much more where the surface bulges, by its mean curvature, 1/mm, and runs along with it.
    pub fn along(&self, bulge: f64) -> f64 {
        1.0 + self.boundary.along * (bulge / self.extinction).clamp(0.0, MOST_BENT)
    }

    /// How fast that falls off, per mean free path.
    pub fn hopf_rate(&self) -> f64 {
        self.boundary.shift[1]
    }

    /// Optical depth that a source is moved to by that; it stays inside.
    pub fn hopf_depth(&self, depth: f64) -> f64 {
        depth - self.hopf_shift(depth).min(0.9 * depth)
    }

    /// Fluence at a distance from a source of unit power: G, 1/mm².
    pub fn potential(&self, r: f64) -> f64 {
        (-self.decay * r).exp() / (4.0 * std::f64::consts::PI * self.diffusion * r)
    }

    /// Fluence at a depth under a plane from an even sheet of unit power at another, mm.
    pub fn half_space(&self, z: f64, sheet: f64) -> f64 {
        let (above, below) = (z.min(sheet), (z - sheet).abs());
        let decay = self.decay;
        // ∫ of what one side of the sheet holds back.
        let near =
            if decay * above < 1e-6 { above } else { -(-2.0 * decay * above).exp_m1() / (2.0 * decay) };
        (-decay * below).exp() * near / self.diffusion
            + (-decay * (z + sheet)).exp() / (self.diffusion * decay + self.robin)
    }
}

/// What Milne's problem (a half-space without absorption, lit from infinitely deep) says of a surface. Deep inside φ ∝ z + z_e, near the surface z + q(z),
/// in mean free paths. The constants are fits to its solution by discrete ordinates, with Fresnel's reflection inside (test
/// `the_boundary_is_that_of_milnes_problem`).
#[derive(Clone, Copy, Debug)]
pub(super) struct Boundary {
    /// z_e: .7104 without reflection.
    end: f64,
    /// z_e − q(z) = a e^(−bz): a and b. With η = 1 that has Hopf's end, 1/√3 at the surface, and the moments √(1/3)·H(μ) − μ of the exact solution within
    /// .002 for μ from .5 to 1.
    shift: [f64; 2],
    /// Around a ball, over D/R, how much more leaves per fluence, from walks in balls of 8 to 16 mean free paths with a lamp in the middle: light that is
    /// thrown back inside runs along the surface and knows less of the bend.
    bend: f64,
    /// And over mean free paths by R how much more diffusion lacks, so that white balls of 7 to 40 mean free paths under a white sky are.
    along: f64,
    /// What diffusion lacks, over what scattered twice, grows towards flat views by this power of the cosine inside: so that a half-space without absorption
    /// under an even sky is as bright in all directions, within .5 % of the mean.
    lean: f64,
    /// η.
    ior: f64,
    /// Of diffuse light outside, what gets in.
    open: f64,
}

/// Cosine inside from which on light gets out.
pub(super) fn critical(ior: f64) -> f64 {
    (1.0 - 1.0 / (ior * ior)).max(0.0).sqrt()
}

impl Boundary {
    pub fn of(ior: f64) -> Self {
        let beyond = (ior - 1.0).max(0.0);
        // (1 + R₂) / (1 − R₁): internal reflection of fluence and of flux (Haskell and others 1994). Diffusion has 2/3 of that.
        let reflected = |n: i32| {
            let part = |cosine: f64| (1.0 - transmittance(1.0 / ior, cosine)) * cosine.powi(n);
            f64::from(n + 1) * integrate_panels(part, &[0.0, critical(ior), 1.0], 1e-9)
        };
        let diffuse = if ior == 1.0 { 1.0 } else { (1.0 + reflected(2)) / (1.0 - reflected(1)) };
        Self {
            end: 2.0 / 3.0 * diffuse + 0.0438 - beyond / (1.22 + 3.62 * beyond),
            shift: [0.1331 - beyond / (0.32 + 1.64 * beyond), (1.2 + 0.2 / beyond.max(1e-9)).min(3.4)],
            bend: (1.26 / ior).powf(4.4).min(1.0),
            along: 11.0 * beyond * beyond / (0.088 + beyond * beyond),
            lean: 1.6 * -(-3.2 * beyond).exp_m1(),
            ior,
            open: crate::fresnel::hemispherical_transmittance(ior),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::nodes;

    /// Milne's problem by discrete ordinates: z_e, and z_e − q at some depths, in mean free paths.
    fn milne<const N: usize>(ior: f64, depths: [f64; N]) -> (f64, [f64; N]) {
        let critical = critical(ior);
        // Dense where light begins to get out.
        let out = nodes(0.0, 1.0)
            .map(|(t, weight)| (critical + (1.0 - critical) * t * t, (1.0 - critical) * 2.0 * t * weight));
        let mut ordinates: Vec<(f64, f64)> =
            out.chain(nodes(0.0, critical)).filter(|(_, w)| *w > 0.0).collect();
        ordinates.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Σ w ν²/(ν² − μ²) = 1: once between every two ordinates, and at infinity.
        let excess = |nu: f64| {
            ordinates.iter().map(|(mu, weight)| weight * nu * nu / (nu * nu - mu * mu)).sum::<f64>() - 1.0
        };
        let between = |pair: &[(f64, f64)]| {
            let (mut low, mut high) = (pair[0].0, pair[1].0);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if excess(middle) > 0.0 { low = middle } else { high = middle }
            }
            0.5 * (low + high)
        };
        let modes: Vec<f64> = ordinates.windows(2).map(between).collect();
        // ψ(0, μ) = F_r(μ) ψ(0, −μ), with ψ(z, μ) = (z − μ + z_e)/2 + Σ A e^(−z/ν) ν/2(ν − μ).
        let row = |(mu, _): &(f64, f64)| {
            let reflected = 1.0 - transmittance(1.0 / ior, *mu);
            let mode = |nu: &f64| nu / (nu - mu) - reflected * nu / (nu + mu);
            let mut row = vec![1.0 - reflected];
            row.extend(modes.iter().map(mode));
            row.push(mu + reflected * mu);
            row
        };
        let amplitudes = solved(ordinates.iter().map(row).collect());
        let shift =
            |z: f64| -amplitudes[1..].iter().zip(&modes).map(|(a, nu)| a * (-z / nu).exp()).sum::<f64>();
        (amplitudes[0], depths.map(shift))
    }

    /// By Gauss's elimination; the right side is the last column.
    fn solved(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
        let count = rows.len();
        for k in 0..count {
            let pivot = (k..count).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs())).unwrap();
            rows.swap(k, pivot);
            let own = rows[k].clone();
            for (at, row) in rows.iter_mut().enumerate().filter(|(at, _)| *at != k) {
                let factor = row[k] / own[k];
                assert!(factor.is_finite(), "{at}");
                row.iter_mut().zip(&own).for_each(|(entry, own)| *entry -= factor * own);
            }
        }
        (0..count).map(|k| rows[k][count] / rows[k][k]).collect()
    }

    #[test]
    fn the_boundary_is_that_of_milnes_problem() {
        let depths = [0.0, 0.3, 1.0];
        // Without reflection, Hopf's function: .710446 deep inside, 1/√3 at the surface.
        let (end, shift) = milne(1.0, depths);
        assert!(
            (end - 0.710446).abs() < 1e-4 && (end - shift[0] - 1.0 / f64::sqrt(3.0)).abs() < 1e-3,
            "{end} {shift:?}"
        );
        for ior in [1.0, 1.05, 1.1, 1.2, 1.3, 1.4, 1.5, 1.7, 2.0, 2.5] {
            let (end, shift) = milne(ior, depths);
            let Boundary { end: fit, shift: [most, rate], .. } = Boundary::of(ior);
            assert!((fit / end - 1.0).abs() < 2e-3, "{ior}: {fit} {end}");
            for (depth, exact) in depths.iter().zip(shift) {
                let found = most * (-rate * depth).exp();
                assert!((found - exact).abs() < 0.025, "{ior}, {depth}: {found} {exact}");
            }
            // Diffusion's end with the flux's reflection alone, which there was before.
            let flux = crate::fresnel::diffuse_reflectance_fit(ior);
            let plain = 0.7104 * (1.0 + flux) / (1.0 - flux);
            assert!(ior < 1.2 || plain / end > 1.1, "{ior}: {plain} {end}");
        }
    }
}
