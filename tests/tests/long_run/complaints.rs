//! What wgpu and the driver's validation have to say.

use log::{Level, LevelFilter, Log, Metadata, Record};
use std::sync::{Mutex, PoisonError};

static HEARD: Mutex<Vec<String>> = Mutex::new(Vec::new());
static EAR: Ear = Ear;

/// wgpu's words where the layer is missing.
const NO_LAYER: &str = "unable to find layer";
/// Set to 1, a missing layer is a complaint too.
const REQUIRED: &str = "TRANSLUME_VALIDATION";

struct Ear;

impl Log for Ear {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.level() <= Level::Warn
    }

    fn log(&self, record: &Record<'_>) {
        if self.enabled(record.metadata()) {
            let words = format!("{} {}: {}", record.level(), record.target(), record.args());
            HEARD.lock().unwrap_or_else(PoisonError::into_inner).push(words);
        }
    }

    fn flush(&self) {}
}

/// Warnings and errors of this process since it began to listen.
pub struct Complaints;

impl Complaints {
    pub fn listen() -> Self {
        log::set_logger(&EAR).unwrap();
        log::set_max_level(LevelFilter::Warn);
        let complaints = Self;
        log::warn!("a test of the ear");
        assert_eq!(complaints.take().len(), 1, "nothing is heard");
        complaints
    }

    fn take(&self) -> Vec<String> {
        std::mem::take(&mut HEARD.lock().unwrap_or_else(PoisonError::into_inner))
    }

    pub fn expect_none(&self) {
        let (missing, complaints): (Vec<_>, Vec<_>) =
            self.take().into_iter().partition(|words| words.contains(NO_LAYER));
        assert!(
            complaints.is_empty(),
            "{} complaints: {:#?}",
            complaints.len(),
            &complaints[..complaints.len().min(5)]
        );
        if !missing.is_empty() {
            let is_required = std::env::var(REQUIRED).is_ok_and(|value| value == "1");
            assert!(!is_required, "{}", missing[0]);
            eprintln!(
                "not validated by Vulkan: install its validation layers (Debian: vulkan-validationlayers)"
            );
        }
    }
}
