//! Work beside the window, which ends when nobody wants it any more.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use translume::wgpu::WasmNotSend;

/// Work that ends when it is dropped, as soon as it looks.
pub struct Task {
    /// No two are the same: what the work tells says whose it is.
    number: u64,
    cancelled: Arc<AtomicBool>,
}

impl Task {
    /// The work hears its number, and is told to end by the flag. It has a thread of its own; in a browser, which has one thread, the
    /// window stands still except where the work waits for something.
    pub fn start(work: impl AsyncFnOnce(u64, &AtomicBool) + WasmNotSend + 'static) -> Self {
        static NUMBER: AtomicU64 = AtomicU64::new(1);
        let task = Self {
            number: NUMBER.fetch_add(1, Ordering::Relaxed),
            cancelled: Arc::new(AtomicBool::new(false)),
        };
        let (number, cancelled) = (task.number, Arc::clone(&task.cancelled));
        #[cfg(not(target_arch = "wasm32"))]
        std::thread::spawn(move || pollster::block_on(work(number, &cancelled)));
        #[cfg(target_arch = "wasm32")]
        wasm_bindgen_futures::spawn_local(async move {
            super::web::next_picture().await;
            work(number, &cancelled).await;
        });
        task
    }

    pub fn is(&self, number: u64) -> bool {
        self.number == number
    }
}

impl Drop for Task {
    fn drop(&mut self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }
}
