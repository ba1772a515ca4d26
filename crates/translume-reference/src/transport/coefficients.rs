//! What diffusion makes of a medium.

use crate::fresnel::diffuse_reflectance_fit;
use crate::path::Volume;

/// Optical depth between Milne's extrapolated end point, .7104, and that of the diffusion condition, 2/3.
const MILNE: f64 = 1.065;

/// What neither scatters nor absorbs is taken to absorb this much, 1/mm.
const CLEAR: f64 = 1e-12;

/// One channel of a medium.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coefficients {
    /// Extinction σ_t, 1/mm.
    pub extinction: f64,
    /// σ_s / σ_t.
    pub albedo: f64,
    /// Grosjean's (2σ_a + σ_s) / 3σ_t², mm.
    pub diffusion: f64,
    /// √(σ_a / D), 1/mm.
    pub decay: f64,
    /// c_G = 1 / 2A·1.065: what leaves per fluence at the surface, by Robin's condition.
    pub robin: f64,
}

impl Coefficients {
    pub fn of(volume: &Volume) -> [Self; 3] {
        let reflected = diffuse_reflectance_fit(volume.ior);
        let robin = (1.0 - reflected) / (2.0 * (1.0 + reflected) * MILNE);
        std::array::from_fn(|k| {
            let absorption = volume.sigma_a[k].max(CLEAR - volume.sigma_s[k]);
            let extinction = volume.sigma_s[k] + absorption;
            let diffusion = (2.0 * absorption + volume.sigma_s[k]) / (3.0 * extinction * extinction);
            let decay = (absorption / diffusion).sqrt();
            Self { extinction, albedo: volume.sigma_s[k] / extinction, diffusion, decay, robin }
        })
    }

    /// c_G at a surface of this mean curvature, 1/mm. In a ball r φ is what φ is in a slab, so that its slope is steeper by φ / R than under a plane
    /// (Davison and Sykes 1957); around a cavity it is less steep, and around a small one about half. Balls of less than a mean free path and a half are no
    /// matter of diffusion.
    fn robin_at(&self, bulge: f64) -> f64 {
        self.robin + (self.diffusion * bulge).clamp(-0.5 * self.robin, 0.5 * self.robin)
    }

    /// What crosses the surface outwards, less what comes in: c_G φ − 4 c_G Γ.
    pub fn net_flux(&self, bulge: f64, fluence: f64, returning: f64) -> f64 {
        self.robin_at(bulge) * (fluence - 4.0 * returning)
    }

    /// What crosses the surface outwards: c_G φ − (4 c_G − 1) Γ.
    pub fn exitance(&self, bulge: f64, fluence: f64, returning: f64) -> f64 {
        let robin = self.robin_at(bulge);
        robin * fluence - (4.0 * robin - 1.0) * returning
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

/// By how many mean free paths the exact field at an optical depth is that of a shallower one: .7104 − q, with Hopf's function q by an
/// exponential that has its end, 1/√3 at the surface, and the moments √(1/3)·H(μ) − μ of the exact solution within .002 for μ from .5 to 1.
pub(super) fn hopf_shift(depth: f64) -> f64 {
    0.1331 * (-3.4 * depth.max(0.0)).exp()
}

/// Optical depth that a source is moved to by that; it stays inside.
pub(super) fn hopf_depth(depth: f64) -> f64 {
    depth - hopf_shift(depth).min(0.9 * depth)
}
