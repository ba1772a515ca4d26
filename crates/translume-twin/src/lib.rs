//! What translume is given, as `translume-reference` takes it: lengths in millimetres, double precision, one profile per channel.
//!
//! The reference shares no code with the library and does not depend on it; whoever compares the two translates here.

mod light;
mod profile;
mod surface;

pub use light::{light, map};
pub use profile::{boundary, dipoles, medium, profiles};
pub use surface::surface;
