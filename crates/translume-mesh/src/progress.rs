//! How long work tells of itself.

/// How far long work has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// What is going on. An atlas: `segmenting`, `flattening`, `evening out`, `packing`, `splitting`, `rasterising` or `ordering`;
    /// a file: `reading`, `parsing` or `repairing`.
    pub stage: &'static str,
    /// Units of work finished in this stage.
    pub done: usize,
    /// Units of work in this stage, where known.
    pub total: Option<usize>,
}
