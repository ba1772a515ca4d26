//! Both rivals on a real adapter, against closed forms, sums on the CPU and the integral over the surface.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a failure here is a failed test")]
#![allow(clippy::print_stdout, reason = "figures, for `--nocapture`")]

mod convergence;
mod edge;
mod errors;
mod figures;
mod frames;
mod plane;
mod scene;
mod slab;
mod twin;
