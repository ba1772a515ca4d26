//! The harness of translume's GPU tests: a device with WebGPU's default limits, bodies to run on it, and the same scene for the
//! CPU twins of `translume-reference`.
//!
//! A comparison is a function that returns a [`Check`]. Its test says that it [`holds`]; a sibling breaks the input and says that
//! the same function [`notices`].

#![allow(clippy::expect_used, clippy::panic, reason = "code of tests: a failure here is a failed test")]
#![allow(clippy::print_stderr, reason = "measured figures, for `--nocapture`")]

mod check;
mod fixture;
mod gpu;
mod models;
mod picture;
mod twin;

pub use check::{Check, at_least, at_most, holds, notices, relative_rmse, rmse_by_area};
pub use fixture::Fixture;
pub use gpu::{Gpu, gpu};
pub use models::{Model, creature, cuboids, limb, plane, sphere, sphere_with, teapot};
pub use picture::{Shot, difference};
pub use translume_twin::dipoles;
pub use twin::{Pose, light, luminous, profiles, sum};
