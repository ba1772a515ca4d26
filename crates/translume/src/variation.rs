//! A medium that differs from place to place.

use crate::Error;

/// As in `shared/cluster.wgsl`: whether a vertex stands on the texel.
pub(crate) const VERTEX_MARK: u32 = 1 << 31;

/// How the medium under one texel differs from that of the body. An approximation: light that crosses several media is treated as if it had
/// stayed in the one where it entered.
///
/// ```no_run
/// # fn example(device: &translume::wgpu::Device, queue: &translume::wgpu::Queue, body: &mut translume::Body) -> Result<(), translume::Error> {
/// use translume::Variation;
///
/// // A freckle every hundred texels.
/// let freckle = Variation { albedo: [0.6, 0.4, 0.3], ..Default::default() };
/// let texels: Vec<_> =
///     (0..body.texels()).map(|k| if k % 100 == 0 { freckle } else { Variation::default() }).collect();
/// body.set_variation(queue, Some(&texels))?;
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variation {
    /// Linear RGB, 0..=1, kept in 255 steps of its square root. Half of it, its square root, multiplies the light that enters and half what
    /// leaves, so that an evenly lit surface is multiplied by the whole.
    pub albedo: [f32; 3],
    /// Factor on both coefficients of the medium for light that enters here, 0.25..=4, kept in thirtieths of an octave: 2 halves the distances it wanders. The
    /// light that comes back is as much as before.
    pub scale: f32,
}

impl Default for Variation {
    /// None.
    fn default() -> Self {
        Self { albedo: [1.0; 3], scale: 1.0 }
    }
}

impl Variation {
    /// Checks both ranges.
    pub(crate) fn validate(&self, texel: usize) -> Result<(), Error> {
        let fail = |problem, remedy| Err(Error::Frame { problem, remedy });
        if !self.albedo.iter().all(|x| (0.0..=1.0).contains(x)) {
            return fail(format!("texel {texel} has albedo {:?}", self.albedo), "give each channel 0 to 1");
        }
        if !(0.25..=4.0).contains(&self.scale) {
            return fail(
                format!("texel {texel} scatters {} times as much", self.scale),
                "give a factor of 0.25 to 4",
            );
        }
        Ok(())
    }

    /// In one word, as in `shared/cluster.wgsl`.
    pub(crate) fn mark(&self) -> u32 {
        let [red, green, blue] = self.albedo.map(|albedo| (255.0 * albedo.sqrt()).round() as u32);
        let scale = (30.0 * self.scale.log2() + 64.0).round().clamp(0.0, 127.0) as u32;
        scale << 24 | blue << 16 | green << 8 | red
    }
}
