//! Memory that bodies take turns with, because none needs it beyond its own part of a frame.

use crate::memory::{Account, Ledger};
use crate::stages::scatter::dual::{ListSizes, Lists};
use crate::stages::shadow::DepthLayers;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The largest that any body asked for. Bodies hold on to what they were given until they are prepared again, and then take what is here.
pub(crate) struct Scratch {
    held: Mutex<Held>,
    /// A depth map without anything in it.
    pub blank: Arc<DepthLayers>,
}

struct Held {
    /// One for each width.
    depth: Vec<Arc<DepthLayers>>,
    lists: Option<Arc<Lists>>,
    account: Account,
}

impl Scratch {
    pub fn new(device: &wgpu::Device, ledger: &Arc<Ledger>) -> Self {
        let held = Held { depth: Vec::new(), lists: None, account: Account::new(ledger) };
        Self { held: Mutex::new(held), blank: Arc::new(DepthLayers::new(device, 1, 1)) }
    }

    /// Depth maps of this width with so many layers or more.
    pub fn depth(&self, device: &wgpu::Device, width: u32, layers: u32) -> Arc<DepthLayers> {
        let mut held = self.lock();
        let known = held.depth.iter().position(|depth| depth.texture.width() == width);
        if let Some(k) = known.filter(|k| held.depth[*k].fit(width, layers)) {
            return Arc::clone(&held.depth[k]);
        }
        let depth = Arc::new(DepthLayers::new(device, width, layers));
        match known {
            Some(k) => held.depth[k] = Arc::clone(&depth),
            None => held.depth.push(Arc::clone(&depth)),
        }
        held.settle();
        depth
    }

    /// Lists and expansions of these sizes or larger.
    pub fn lists(&self, device: &wgpu::Device, sizes: ListSizes) -> Arc<Lists> {
        let mut held = self.lock();
        if let Some(lists) = held.lists.as_ref().filter(|lists| lists.hold(sizes)) {
            return Arc::clone(lists);
        }
        let sizes = held.lists.as_ref().map_or(sizes, |lists| lists.sizes().or_larger(sizes));
        let lists = Arc::new(Lists::new(device, sizes));
        held.lists = Some(Arc::clone(&lists));
        held.settle();
        lists
    }

    /// What another body would make of it is as good as what a panic left.
    fn lock(&self) -> MutexGuard<'_, Held> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Held {
    fn settle(&mut self) {
        let depth: u64 = self.depth.iter().map(|depth| depth.bytes()).sum();
        self.account.set(depth + self.lists.as_ref().map_or(0, |lists| lists.sizes().bytes()));
    }
}
