//! A bound on what a document may unfold to by using the same data again.

/// Memory that any document may unfold to, however small its files.
const FLOOR: usize = 192 << 20;

/// Memory per byte of the document's files. A quantised mesh of strips, without any reuse, comes to 20.
const PER_BYTE: usize = 24;

/// What one of each takes, in bytes, while it is read and repaired; a third more than was measured.
pub(super) mod cost {
    pub(in super::super) const NODE: usize = 400;
    pub(in super::super) const JOINT: usize = 256;
    pub(in super::super) const MEMBER: usize = 256;
    pub(in super::super) const VERTEX: usize = 100;
    pub(in super::super) const INDEX: usize = 32;
    pub(in super::super) const DELTA: usize = 12;
    pub(in super::super) const INFLUENCE: usize = 16;
    pub(in super::super) const NUMBER: usize = 4;
    pub(in super::super) const BYTE: usize = 1;
}

/// Bytes of memory that are left to unfold to.
pub(super) struct Budget {
    total: usize,
    left: usize,
}

impl Budget {
    /// For a document whose files have so many bytes in all.
    pub(super) fn new(bytes: usize) -> Self {
        let total = bytes.saturating_mul(PER_BYTE).max(FLOOR);
        Self { total, left: total }
    }

    /// Takes what `count` things of a cost need, before memory is reserved for them.
    pub(super) fn take(&mut self, count: usize, cost: usize) -> Result<(), String> {
        self.left =
            count.checked_mul(cost).and_then(|bytes| self.left.checked_sub(bytes)).ok_or_else(|| {
                format!(
                    "the scene unfolds to more than {} MB; use less of the same data again",
                    self.total >> 20
                )
            })?;
        Ok(())
    }
}
