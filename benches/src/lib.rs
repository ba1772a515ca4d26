//! What the benchmarks of the GPU share: a device, the models of Table 1 of Gong et al. 2008, the ways to scatter, and a scene with a
//! stopwatch.

#![allow(
    clippy::expect_used,
    clippy::panic,
    reason = "code of benchmarks: a failure here is a failed benchmark"
)]
#![allow(clippy::print_stderr, reason = "tells what is left out")]

mod gpu;
mod models;
mod modes;
mod picture;
mod scene;

pub use gpu::Gpu;
pub use models::{Model, bunny, bunny_to_egg, creature, small_creature, teapot};
pub use modes::{METHODS, MODES, Mode};
pub use scene::{Change, Scene};

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, SamplingMode};
use std::time::Duration;

/// A group whose benchmarks take two to three seconds each: ten samples, of one frame where a frame is slow.
pub fn group<'a>(criterion: &'a mut Criterion, what: &str, gpu: &Gpu) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(format!("{what}, {} on {}", gpu.clock(), gpu.adapter));
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(2));
    group
}
