//! A slab, and media over each other: multipoles, added up in spatial frequencies. Donner, Jensen 2005, "Light Diffusion in
//! Multi-Layered Translucent Materials".

use super::channel::{Channel, classical_boundary};
use super::hankel;
use super::sampled::{Sampled, Shape};
use crate::{Error, Medium};
use std::f64::consts::TAU;
use std::sync::Arc;

/// What lies under the surface: the body's own medium on top, and other media below.
///
/// The layers are flat and go on sideways without end: right where they are thin against the radii of curvature. Index of
/// refraction may change from layer to layer.
///
/// ```
/// use translume::{Layer, Layers, Medium, Profile};
///
/// // 1.5 mm of skin over fat without end.
/// let fat = Layer { medium: Medium { sigma_s_prime: [1.2, 1.1, 1.0], sigma_a: [0.01, 0.02, 0.04], ior: 1.3, g: 0.0 }, thickness_mm: f32::INFINITY };
/// let profile = Profile::Multipole(Layers { thickness_mm: 1.5, below: [fat].into() });
/// profile.validate()?;
/// # Ok::<(), translume::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// Thickness of the body's own medium, mm: > 0, infinite for a half-space.
    pub thickness_mm: f32,
    /// What lies below, from top to bottom. Air below the last, unless that is infinite; none leaves a bare slab.
    pub below: Arc<[Layer]>,
}

impl Default for Layers {
    /// A half-space of the body's own medium.
    fn default() -> Self {
        Self { thickness_mm: f32::INFINITY, below: Arc::new([]) }
    }
}

/// A flat sheet of a medium.
///
/// ```
/// use translume::{Layer, Medium};
///
/// let layer = Layer { medium: Medium::SKIN2, thickness_mm: 2.0 };
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// The medium.
    pub medium: Medium,
    /// Thickness, mm: > 0; infinite for the last one alone.
    pub thickness_mm: f32,
}

impl Layers {
    /// Diffuse transmittance T_d(r), RGB, 1/mm²: what leaves at the far side of the lowest layer, a distance `r` ≥ 0 mm sideways from
    /// where light entered at the top. Light that was never scattered, e^(−Σ σ_t' thickness), is not in it. A texel only collects
    /// what leaves on the side it entered, so this is for a host's own use, such as leaves and paper.
    ///
    /// # Errors
    /// [`Error::Profile`] or [`Error::Medium`] where a layer cannot be.
    pub fn transmittance(&self, top: &Medium, r: f32) -> Result<[f32; 3], Error> {
        top.validate()?;
        self.validate()?;
        Ok([0, 1, 2].map(|channel| {
            let stack = Stack::new(self, top, channel);
            // Below this nothing changes any more.
            let r = f64::from(r).max(1e-3 * stack.shortest);
            let through = |k: f64| stack.at(k)[1] - stack.unscattered();
            hankel::inverse(through, stack.band(), r).max(0.0) as f32
        }))
    }

    /// # Errors
    /// [`Error::Profile`] names the layer, [`Error::Medium`] the coefficient that cannot be.
    pub(crate) fn validate(&self) -> Result<(), Error> {
        let thicknesses = std::iter::once(self.thickness_mm).chain(self.below.iter().map(|l| l.thickness_mm));
        for (k, thickness) in thicknesses.enumerate() {
            let last = k == self.below.len();
            if !(thickness > 0.0 && (last || thickness.is_finite())) {
                return Err(Error::Profile {
                    problem: format!("layer {k} from the top is {thickness} mm thick"),
                    remedy: "give a thickness above 0, infinite for the lowest layer alone",
                });
            }
        }
        self.below.iter().try_for_each(|layer| layer.medium.validate())
    }
}

/// R_d of the stack, seen from above.
pub(crate) fn reflectance(layers: &Layers, top: &Medium, channel: usize) -> Sampled {
    let stack = Stack::new(layers, top, channel);
    let band = stack.band();
    let at = |r: f64| hankel::inverse(|k| stack.at(k)[0], band, r);
    let total = stack.at(0.0)[0];
    // Where little light is left, rounding takes over; where R_d falls exponentially by then, it goes on so.
    let visible = |r: f64| TAU * r * r * at(r) > 1e-7 * total;
    let (near, limit) = (3e-3 * stack.shortest, 1e4 * stack.longest);
    let mut far = stack.shortest;
    while far < limit && visible(1.2 * far) {
        far *= 1.2;
    }
    let rate = (at(far / 1.1) / at(far)).ln() / (far - far / 1.1);
    let decay = if rate * far > 6.0 { rate } else { 0.0 };
    let shape = Shape { decay, smooth_length: stack.shortest, range: [near, far / 1.1] };
    Sampled::new(&shape, |r| at(r).max(0.0) * (decay * r).exp())
}

/// One channel of all layers.
struct Stack {
    sheets: Vec<Sheet>,
    /// Least depth of a source, and the longest length of all, mm.
    shortest: f64,
    longest: f64,
}

impl Stack {
    fn new(layers: &Layers, top: &Medium, channel: usize) -> Self {
        let top = Layer { medium: *top, thickness_mm: layers.thickness_mm };
        let all: Vec<Layer> = std::iter::once(top).chain(layers.below.iter().copied()).collect();
        let ior = |k: usize| all.get(k).map_or(1.0, |layer| f64::from(layer.medium.ior));
        let sheets: Vec<Sheet> = (0..all.len())
            .map(|k| {
                let above = if k == 0 { 1.0 } else { ior(k - 1) };
                let ratios = [ior(k) / above, ior(k) / ior(k + 1)];
                Sheet::new(&Channel::of(&all[k].medium)[channel], all[k].thickness_mm.into(), ratios)
            })
            .collect();
        let scattering = || sheets.iter().filter(|sheet| sheet.power > 0.0);
        let shortest = scattering().map(|sheet| sheet.depth).fold(f64::INFINITY, f64::min);
        let longest = scattering().map(Sheet::longest).fold(0.0, f64::max);
        Self { sheets, shortest, longest }
    }

    fn band(&self) -> [f64; 2] {
        [0.01 / self.longest, 40.0 / self.shortest]
    }

    fn unscattered(&self) -> f64 {
        self.sheets.iter().map(|sheet| sheet.unscattered).product()
    }

    /// Reflectance and transmittance at frequency k, 1/mm, from above.
    fn at(&self, k: f64) -> [f64; 2] {
        // Nothing below the last sheet comes back, all goes on.
        self.sheets.iter().rev().fold([0.0, 1.0], |[below, on], sheet| {
            let [down, up] = sheet.at(k);
            let bounces = 1.0 / (1.0 - up.reflected * below);
            [down.reflected + down.through * below * up.through * bounces, down.through * on * bounces]
        })
    }
}

/// A layer between two planes where fluence vanishes.
struct Sheet {
    /// What the source carries of the light that enters, α'(1 − e^(−σ_t' thickness)).
    power: f64,
    /// What goes through without meeting anything.
    unscattered: f64,
    sigma_tr: f64,
    thickness: f64,
    /// Depth of the source: the mean of where light is scattered first. One mean free path where the layer is thick.
    depth: f64,
    /// 2AD at top and bottom.
    z_b: [f64; 2],
}

/// What becomes of light that enters on one side.
struct Response {
    reflected: f64,
    through: f64,
}

impl Sheet {
    /// `ratios`: index inside over that above, and below.
    fn new(channel: &Channel, thickness: f64, ratios: [f64; 2]) -> Self {
        let extinction = channel.extinction();
        let optical = extinction * thickness;
        let unscattered = (-optical).exp();
        let share = match optical {
            x if x < 1e-3 => 0.5 * x - x * x / 12.0,
            x if x > 600.0 => 1.0,
            x => 1.0 - x / x.exp_m1(),
        };
        Self {
            power: channel.albedo() * -(-optical).exp_m1(),
            unscattered,
            sigma_tr: (3.0 * channel.absorption * extinction).sqrt(),
            thickness,
            depth: share / extinction,
            z_b: ratios.map(|eta| 2.0 / 3.0 * classical_boundary(eta) / extinction),
        }
    }

    /// The lesser of thickness and decay, and the mean free path, mm.
    fn longest(&self) -> f64 {
        let extent = self.thickness.min(1.0 / self.sigma_tr);
        if extent.is_finite() { extent.max(self.z_b[0]) } else { self.z_b[0] }
    }

    /// From above, and from below.
    fn at(&self, k: f64) -> [Response; 2] {
        // Far below any length; keeps 0 · ∞ away.
        let s = k.hypot(self.sigma_tr).max(1e-150);
        [self.response(s, self.z_b), self.response(s, [self.z_b[1], self.z_b[0]])]
    }

    /// All mirrored sources at once: the field of a point between two planes of no fluence is one of sinh, and the flux through the
    /// surfaces its slope. Written with falling exponentials alone.
    fn response(&self, s: f64, [near, far]: [f64; 2]) -> Response {
        let height = self.thickness + near + far;
        let whole = (-2.0 * s * height).exp_m1();
        let above = (-2.0 * s * (self.depth + near)).exp_m1() / whole;
        let under = (-2.0 * s * (self.thickness + far - self.depth)).exp_m1() / whole;
        let half = 0.5 * self.power;
        let through =
            half * (1.0 + (-2.0 * s * far).exp()) * (-s * (self.thickness - self.depth)).exp() * above;
        Response {
            reflected: half * (1.0 + (-2.0 * s * near).exp()) * (-s * self.depth).exp() * under,
            through: through + self.unscattered,
        }
    }
}
