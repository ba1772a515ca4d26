//! Materials as glTF files state them, and the scattering media that follow.
//!
//! Sources: Khronos, glTF 2.0 specification, section 3.9; the extensions `KHR_materials_ior`, `KHR_materials_volume` and
//! `KHR_materials_diffuse_transmission`; the drafts `KHR_materials_volume_scatter` (glTF pull request 2453) and
//! `KHR_materials_scatter` (2579).

/// What a surface and the volume behind it are made of, as far as translucency is concerned.
///
/// Only factors are read: textures are not looked at.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name an artist gave it; may be empty.
    pub name: String,
    /// Colour of the surface and its opacity, linear RGBA, 0..1.
    pub base_color: [f32; 4],
    /// Index of refraction, 1.5 unless the file says otherwise. 0 stands for infinity: a surface that reflects everything.
    pub ior: f32,
    /// What fills the body.
    pub volume: Option<Volume>,
    /// How the volume scatters.
    pub scatter: Option<Scatter>,
    /// Light that leaves a thin surface on its other side.
    pub diffuse_transmission: Option<DiffuseTransmission>,
}

impl Default for Material {
    /// White, ior 1.5, opaque: glTF's own default.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [1.0; 4],
            ior: 1.5,
            volume: None,
            scatter: None,
            diffuse_transmission: None,
        }
    }
}

/// `KHR_materials_volume`: how a volume attenuates light, by absorption and scattering together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// A guess at the thickness for those who cannot trace rays, in units of the mesh; 0 for a thin wall.
    pub thickness: f32,
    /// Distance after which white light has turned into [`attenuation_color`](Self::attenuation_color), metres, above 0;
    /// infinite for a clear volume.
    pub attenuation_distance: f32,
    /// What is left of white light by then, linear RGB, 0..1.
    pub attenuation_color: [f32; 3],
}

/// `KHR_materials_volume_scatter` or `KHR_materials_scatter`: how much of the attenuation is scattering.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// The draft it is written in.
    pub draft: ScatterDraft,
    /// Colour of a deep volume after many scattering events, linear RGB, 0..1. A scatter strength is multiplied in.
    pub multiscatter_color: [f32; 3],
    /// Mean cosine g of the phase function, −1..1.
    pub anisotropy: f32,
}

/// Two drafts of one extension, which differ in what the colour means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ScatterDraft {
    /// `KHR_materials_volume_scatter`: the colour alone gives the single-scattering albedo.
    VolumeScatter,
    /// `KHR_materials_scatter`, which followed: the colour gives the albedo that an isotropic medium would need, and the
    /// anisotropy is reckoned with. Without a thickness it describes a surface.
    Scatter,
}

/// `KHR_materials_diffuse_transmission`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTransmission {
    /// Share of the light that enters the surface and leaves it on the other side, 0..1.
    pub factor: f32,
    /// What of it is left, linear RGB, 0..1.
    pub color: [f32; 3],
}

/// The coefficients of a homogeneous scattering medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattering {
    /// Reduced scattering coefficient σ_s' = σ_s (1 − g), RGB, 1/mm.
    pub sigma_s_prime: [f32; 3],
    /// Absorption coefficient σ_a, RGB, 1/mm.
    pub sigma_a: [f32; 3],
    /// Index of refraction.
    pub ior: f32,
    /// Mean cosine g of the phase function, −1..1.
    pub g: f32,
}

impl Material {
    /// The medium that the material describes, where it describes one that scatters.
    ///
    /// | coefficient | from |
    /// | --- | --- |
    /// | extinction σ_t | −ln(attenuation colour) / attenuation distance; glTF's metres are 1000 mm |
    /// | albedo α' of the multiple-scattering colour c | c = (1 − s)(1 − 0.139 s) / (1 + 1.17 s), s = √(1 − α') |
    /// | single-scattering albedo ρ | α' (`KHR_materials_volume_scatter`), α' / (1 − g (1 − α')) (`KHR_materials_scatter`) |
    /// | σ_s', σ_a | ρ σ_t (1 − g), (1 − ρ) σ_t |
    ///
    /// With the second draft's ρ the reduced albedo σ_s' / (σ_s' + σ_a) is α' whatever g is (similarity relation).
    ///
    /// A white channel of the attenuation colour, or an infinite distance, gives exactly 0 for both coefficients; a black
    /// channel is read as `f32::MIN_POSITIVE`, e⁻⁸⁷, so that its extinction is finite. White and black multiple-scattering
    /// colours give exactly σ_a = 0 and σ_s' = 0. Numbers in their ranges never give NaN, and infinity only for distances
    /// below 1e-38 m.
    ///
    /// `None` where no channel scatters, without a volume or a scattering extension, in a thin wall
    /// (`KHR_materials_scatter` with thickness 0; examples in the older draft leave the thickness out), and for an ior of
    /// 0, which lets no light in. Diffuse transmission gives no medium by itself: it says nothing of how far light travels between
    /// scattering events, and by its specification the volume beneath only absorbs. How much light the surface lets in
    /// (transmission factors, base colour) is no part of a medium and changes nothing here.
    ///
    /// Source: van de Hulst 1980, "Multiple Light Scattering", for c; its inversion in Kulla and Conty 2017, "Revisiting
    /// Physically Based Shading at Imageworks", is the formula in both drafts, with six digits for each constant.
    #[must_use]
    pub fn scattering(&self) -> Option<Scattering> {
        let (volume, scatter) = (self.volume?, self.scatter?);
        let thin = scatter.draft == ScatterDraft::Scatter && volume.thickness <= 0.0;
        if thin || self.ior <= 0.0 {
            return None;
        }
        let mut scattering =
            Scattering { sigma_s_prime: [0.0; 3], sigma_a: [0.0; 3], ior: self.ior, g: scatter.anisotropy };
        for channel in 0..3 {
            let extinction = volume.extinction(channel) / MM_PER_METRE;
            let (scattered, absorbed) = scatter.shares(channel);
            let g = f64::from(scatter.anisotropy);
            scattering.sigma_s_prime[channel] = (extinction * scattered * (1.0 - g)) as f32;
            scattering.sigma_a[channel] = (extinction * absorbed) as f32;
        }
        scattering.sigma_s_prime.iter().any(|&sigma| sigma > 0.0).then_some(scattering)
    }
}

const MM_PER_METRE: f64 = 1000.0;

impl Volume {
    /// σ_t of one channel, 1/m.
    fn extinction(&self, channel: usize) -> f64 {
        let color = f64::from(self.attenuation_color[channel].max(f32::MIN_POSITIVE));
        // abs: the logarithm of white is −0 here.
        (-color.ln() / f64::from(self.attenuation_distance)).abs()
    }
}

impl Scatter {
    /// ρ and 1 − ρ of one channel, each to full precision.
    fn shares(&self, channel: usize) -> (f64, f64) {
        let c = f64::from(self.multiscatter_color[channel]);
        let s = van_de_hulst(c);
        // α' = (1 − s)(1 + s), with c / … for the first factor, which is exact where c vanishes.
        let albedo = (1.0 + s) * c * (1.0 + 1.17 * s) / (1.0 - 0.139 * s);
        let g = match self.draft {
            ScatterDraft::VolumeScatter => 0.0,
            ScatterDraft::Scatter => f64::from(self.anisotropy),
        };
        let scale = 1.0 - g + g * albedo;
        // Black leaves nothing to divide where g is 1.
        if c <= 0.0 { (0.0, 1.0) } else { (albedo / scale, s * s * (1.0 - g) / scale) }
    }
}

/// The s in 0..1 of c = (1 − s)(1 − 0.139 s) / (1 + 1.17 s): the smaller root of 0.139 s² − (1.139 + 1.17 c) s + 1 − c,
/// in the form that does not cancel.
fn van_de_hulst(c: f64) -> f64 {
    let b = 1.139 + 1.17 * c;
    2.0 * (1.0 - c) / (b + (b * b - 4.0 * 0.139 * (1.0 - c)).sqrt())
}
