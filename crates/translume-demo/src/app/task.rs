//! Work on a thread of its own, which ends when nobody wants it any more.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Work that ends when it is dropped, as soon as it looks.
pub struct Task {
    /// No two are the same: what the work tells says whose it is.
    number: u64,
    cancelled: Arc<AtomicBool>,
}

impl Task {
    /// The work hears its number, and is told to end by the flag.
    pub fn start(work: impl FnOnce(u64, &AtomicBool) + Send + 'static) -> Self {
        static NUMBER: AtomicU64 = AtomicU64::new(1);
        let task = Self {
            number: NUMBER.fetch_add(1, Ordering::Relaxed),
            cancelled: Arc::new(AtomicBool::new(false)),
        };
        let (number, cancelled) = (task.number, Arc::clone(&task.cancelled));
        std::thread::spawn(move || work(number, &cancelled));
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
