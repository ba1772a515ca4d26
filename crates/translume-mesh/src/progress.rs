//! What long work tells of itself: how far it has come, and how long it took.

/// How far long work has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// What is going on. An atlas: `segmenting`, `flattening`, `packing`, `splitting`, `rasterising` or `ordering`;
    /// a file: `reading`, `parsing` or `repairing`; a sphere or an egg: `coarsening`, `laying` or `checking`.
    pub stage: &'static str,
    /// Units of work finished in this stage.
    pub done: usize,
    /// Units of work in this stage, where known.
    pub total: Option<usize>,
}

/// Wall time; always zero in a browser without threads, where the standard clock is missing.
pub(crate) struct Stopwatch(#[cfg(not(target_arch = "wasm32"))] std::time::Instant);

impl Stopwatch {
    pub fn start() -> Self {
        Self(
            #[cfg(not(target_arch = "wasm32"))]
            std::time::Instant::now(),
        )
    }

    pub fn seconds(&self) -> f64 {
        #[cfg(not(target_arch = "wasm32"))]
        return self.0.elapsed().as_secs_f64();
        #[cfg(target_arch = "wasm32")]
        0.0
    }
}
