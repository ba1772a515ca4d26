//! What a body takes of the device's memory, for itself or in turns with others.

use super::Body;
use crate::evaluate::Evaluate;
use crate::memory::MemoryUse;
use crate::stages::scatter::dual::{Demand, DualMemory, ListSizes};
use crate::stages::scatter::pattern::PatternMemory;
use crate::stages::shadow::{DepthLayers, depth_bytes};
use crate::stages::visibility::SkyMemory;
use crate::stages::{Stage, StageSet};
use crate::{Error, wgpu};
use std::sync::Arc;

impl Body {
    /// Bytes of GPU memory that are this body's own. What it shares with others counts for
    /// [`Translume::memory`](crate::Translume::memory) alone; a [`CompositeView`](crate::CompositeView) adds some hundred.
    #[must_use]
    pub fn memory(&self) -> MemoryUse {
        let [mesh, atlas] = self.buffers.bytes();
        let pixels = u64::from(self.extent.atlas_size).pow(2);
        let dual = self.dual.as_ref().map_or(0, DualMemory::bytes) + self.own_lists();
        let pattern = self.pattern.as_ref().map_or(0, PatternMemory::bytes);
        let own = |layers: &Arc<DepthLayers>| if self.shares_scratch { 0 } else { layers.bytes() };
        let depth = own(&self.depth_maps.layers) + self.sky.depth().map_or(0, own);
        MemoryUse {
            mesh: mesh + self.host.bytes(),
            atlas: atlas + 16 * pixels,
            scatter: self.kernel.bytes() + dual + pattern + self.solver.bytes(),
            shadows: depth + self.depth_maps.bytes() + self.sky.bytes(),
        }
    }

    /// Gives back what only computing takes, for a body that will stand still or out of sight for long. It can still be drawn, but highlights
    /// lose their shadows; the next [`prepare`](Self::prepare) allocates and computes everything anew.
    pub fn trim(&mut self, device: &wgpu::Device) {
        self.sky = SkyMemory::new(&self.shadows);
        self.depth_maps.layers = Arc::clone(&self.stages.scratch.blank);
        if self.points().is_none() {
            self.dual = None;
        }
        self.solver.forget();
        self.bind_gather(device);
        self.pending = StageSet::default();
        (self.never_prepared, self.method_stale) = (true, true);
        self.note_memory();
    }

    /// The depth maps that highlights look into.
    pub(crate) fn seen_depth(&self) -> &Arc<DepthLayers> {
        if self.shares_scratch { &self.stages.scratch.blank } else { &self.depth_maps.layers }
    }

    /// What is allocated counts from here on.
    pub(super) fn note_memory(&mut self) {
        self.account.set(self.memory().total());
    }

    /// What another body left in shared depth maps is not looked at.
    pub(super) fn draw_shared_depth(&mut self) {
        if self.shares_scratch && self.pending.contains(Stage::Gather) {
            self.pending.insert(StageSet::from_stage_on(Stage::Shadow));
        }
    }

    /// Whether there may be as much as the next frame needs.
    pub(super) fn check_growth(&self, layers: u32, sky: bool, evaluate: Evaluate) -> Result<(), Error> {
        let now = self.memory().total();
        let mut then = now;
        let resolution = self.shadows.resolution;
        if !self.shares_scratch && !self.depth_maps.layers.fit(resolution, layers) {
            then = then - self.depth_maps.layers.bytes() + depth_bytes(resolution, layers.max(1));
        }
        if sky && self.sky.depth().is_none() {
            then += SkyMemory::size(&self.shadows, self.extent.texels);
            then += if self.shares_scratch { 0 } else { depth_bytes(SkyMemory::width(&self.shadows), 1) };
        }
        if let Some(theta) = self.dual_theta().filter(|_| !self.shares_lists(evaluate)) {
            let demand = Demand { list_entries: self.list_entries, theta, evaluate };
            if !self.dual.as_ref().is_some_and(|memory| memory.serves(demand, &self.tree, &self.limits)) {
                then = then - self.own_lists() + ListSizes::new(&self.tree, demand, &self.limits).bytes();
            }
        }
        then += self.solver_growth();
        if then > now { self.account.check(then) } else { Ok(()) }
    }

    pub(super) fn make_room_for_views(&mut self, device: &wgpu::Device, layers: u32) {
        let (here, width) = (&self.depth_maps.layers, self.shadows.resolution);
        let layers = self.depth_layers(device, Some(here), width, layers.max(1));
        if !Arc::ptr_eq(&self.depth_maps.layers, &layers) {
            self.depth_maps.layers = layers;
            self.bind_gather(device);
        }
    }

    /// Layers of depth to draw into: shared ones as they are now, or those that are `here` if they fit.
    pub(super) fn depth_layers(
        &self,
        device: &wgpu::Device,
        here: Option<&Arc<DepthLayers>>,
        width: u32,
        layers: u32,
    ) -> Arc<DepthLayers> {
        if self.shares_scratch {
            return self.stages.scratch.depth(device, width, layers);
        }
        match here.filter(|here| here.fit(width, layers)) {
            Some(here) => Arc::clone(here),
            None => Arc::new(DepthLayers::new(device, width, layers)),
        }
    }

    /// Bytes of lists that are no others'.
    fn own_lists(&self) -> u64 {
        let own = self.dual.as_ref().filter(|_| !self.shares_lists(self.evaluated));
        own.map_or(0, |memory| memory.lists.sizes().bytes())
    }

    /// Exitance at points is summed up when the picture is drawn: then the lists have to last.
    pub(super) fn shares_lists(&self, evaluate: Evaluate) -> bool {
        self.shares_scratch && evaluate == Evaluate::PerTexel
    }

    /// Whether there are other shared lists than those that are bound.
    pub(super) fn scratch_grew(&self, device: &wgpu::Device) -> bool {
        let bound = self.dual.as_ref().filter(|_| self.shares_lists(self.evaluated));
        bound.is_some_and(|memory| {
            let current = self.stages.scratch.lists(device, memory.lists.sizes());
            !Arc::ptr_eq(&current, &memory.lists)
        })
    }
}
