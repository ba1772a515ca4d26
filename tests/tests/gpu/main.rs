//! Every stage on a real adapter against its CPU twin, then the whole against closed forms, hard cases and pictures.
//! Figures in comments were measured on lavapipe (Mesa's software Vulkan), the least precise adapter at hand.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a failure here is a failed test")]

mod area_light;
mod caster_host;
mod casters;
mod closure;
mod cluster;
mod composite;
mod deform;
mod dual;
mod entry;
mod errors;
mod evaluate;
mod furnace;
mod gather;
mod golden;
mod hard_light;
mod host_vertices;
mod irradiance;
mod layout;
mod memory;
mod oriented;
mod pattern;
mod profiles;
mod readback;
mod scatter;
mod shadow;
mod sky;
mod stability;
mod stages;
mod timings;
mod transport;
mod variation;
mod work;
