//! The window, driven without one: what a hand would do, and what must have come of it.

mod files;
mod handles;
mod look;
mod monkey;
mod motion;
mod round_trip;
mod snapshots;
mod stalls;
mod truth;
mod window;
