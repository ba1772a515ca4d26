//! GPU memory: how much bodies take, and that it stays below what the host allows.

use crate::Error;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Bytes of GPU memory, by what they are for.
///
/// ```no_run
/// # fn example(device: &translume::wgpu::Device, queue: &translume::wgpu::Queue, body: &mut translume::Body) -> Result<(), translume::Error> {
/// let memory = body.memory();
/// println!("{:.1} MB, {:.1} of them for shadows", memory.total() as f64 / 1e6, memory.shadows as f64 / 1e6);
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct MemoryUse {
    /// Rest pose, targets, skin and the deformed vertices.
    pub mesh: u64,
    /// Texels, their tree, and the exitance texture.
    pub atlas: u64,
    /// Kernel table, and lists and expansions of the scatter.
    pub scatter: u64,
    /// Depth maps, and what texels see of the sky.
    pub shadows: u64,
}

impl MemoryUse {
    /// All of it.
    #[must_use]
    pub fn total(&self) -> u64 {
        let Self { mesh, atlas, scatter, shadows } = self;
        mesh + atlas + scatter + shadows
    }
}

/// What all bodies of a [`Translume`](crate::Translume) take together.
#[derive(Debug)]
pub(crate) struct Ledger {
    used: AtomicU64,
    budget: Option<u64>,
}

impl Ledger {
    pub fn new(budget: Option<u64>) -> Arc<Self> {
        Arc::new(Self { used: AtomicU64::new(0), budget })
    }

    pub fn used(&self) -> u64 {
        self.used.load(Ordering::Relaxed)
    }
}

/// One share of it, given back when dropped.
#[derive(Debug)]
pub(crate) struct Account {
    ledger: Arc<Ledger>,
    bytes: u64,
}

impl Account {
    pub fn new(ledger: &Arc<Ledger>) -> Self {
        Self { ledger: Arc::clone(ledger), bytes: 0 }
    }

    /// Whether this share may become so large.
    pub fn check(&self, bytes: u64) -> Result<(), Error> {
        let others = self.ledger.used().saturating_sub(self.bytes);
        match self.ledger.budget {
            Some(budget) if others.saturating_add(bytes) > budget => {
                Err(Error::Memory { required: bytes, available: budget.saturating_sub(others), budget })
            }
            _ => Ok(()),
        }
    }

    pub fn set(&mut self, bytes: u64) {
        self.ledger.used.fetch_add(bytes.wrapping_sub(self.bytes), Ordering::Relaxed);
        self.bytes = bytes;
    }
}

impl Drop for Account {
    fn drop(&mut self) {
        self.set(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_add_up_and_come_back() {
        let ledger = Ledger::new(Some(100));
        let (mut a, mut b) = (Account::new(&ledger), Account::new(&ledger));
        a.set(60);
        b.set(30);
        assert_eq!(ledger.used(), 90);
        assert_eq!(b.check(40), Ok(()));
        assert_eq!(b.check(41), Err(Error::Memory { required: 41, available: 40, budget: 100 }));
        a.set(10);
        assert_eq!((ledger.used(), b.check(90)), (40, Ok(())));
        drop(b);
        assert_eq!(ledger.used(), 10);
        let free = Account::new(&Ledger::new(None));
        assert_eq!(free.check(u64::MAX), Ok(()));
    }
}
