//! Levels of detail: the same mesh with atlases of several sizes.

use crate::{Body, View};

/// Bodies of one thing, of which the size in the picture picks one: the finer the atlas, the dearer the light.
///
/// Only the body that was picked is prepared and encoded. Each keeps its own memory, and each has a texture of its own: bind that of the
/// body that is drawn.
///
/// ```no_run
/// # fn example(fine: translume::Body, coarse: translume::Body, view: &translume::View, device: &translume::wgpu::Device,
/// #     queue: &translume::wgpu::Queue, frame: &translume::Frame<'_>) -> Result<(), translume::Error> {
/// let mut levels = translume::Levels::new(vec![fine, coarse]);
/// if let Some(body) = levels.pick(view) {
///     body.prepare(device, queue, frame)?;
/// }
/// # Ok(()) }
/// ```
pub struct Levels {
    /// By falling number of texels.
    bodies: Vec<Body>,
    picked: usize,
}

/// A coarser body is picked only where its texels outnumber the pixels by this: what is at the limit does not flicker.
const MARGIN: f32 = 1.5;

impl Levels {
    /// In any order.
    #[must_use]
    pub fn new(mut bodies: Vec<Body>) -> Self {
        bodies.sort_by_key(|body| std::cmp::Reverse(body.texels()));
        Self { bodies, picked: 0 }
    }

    /// The coarsest body with at least as many texels as the thing covers pixels, or else the finest; `None` where it is out of the
    /// picture, or there are no bodies. Goes by the pose that the last picked body was prepared with.
    pub fn pick(&mut self, view: &View) -> Option<&mut Body> {
        let pixels = self.bodies.get(self.picked)?.covered(view);
        if pixels <= 0.0 {
            return None;
        }
        self.picked = pick(self.bodies.iter().map(Body::texels), self.picked, pixels);
        self.bodies.get_mut(self.picked)
    }

    /// The number of the body that was picked last, among those of [`bodies`](Self::bodies).
    #[must_use]
    pub fn picked(&self) -> usize {
        self.picked
    }

    /// All of them, from the finest to the coarsest.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// All of them, from the finest to the coarsest, to set their media or to trim those that are not picked.
    pub fn bodies_mut(&mut self) -> &mut [Body] {
        &mut self.bodies
    }
}

/// `texels` fall.
fn pick(texels: impl Iterator<Item = u32>, last: usize, pixels: f32) -> usize {
    let suffices = |(k, texels): &(usize, u32)| {
        let margin = if *k > last { MARGIN } else { 1.0 };
        *texels as f32 >= margin * pixels
    };
    texels.enumerate().filter(suffices).last().map_or(0, |(k, _)| k)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coarsest_that_suffices_is_picked_and_kept() {
        let pick = |last, pixels| pick([10_000, 2_500, 600].into_iter(), last, pixels);
        assert_eq!(pick(0, 9_000.0), 0);
        assert_eq!(pick(0, 50_000.0), 0, "nothing finer");
        assert_eq!(pick(0, 1.0), 2);
        // At the limit each stays what it was.
        assert_eq!([pick(0, 2_000.0), pick(1, 2_000.0)], [0, 1]);
        assert_eq!([pick(0, 1_600.0), pick(1, 2_600.0)], [1, 0]);
    }
}
