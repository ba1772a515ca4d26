//! Built-in models: made by formula at start-up, so that a demo and a test need no file.
//!
//! Lengths are millimetres, y points up, faces wind counter-clockwise seen from outside, normals have unit length.
//! Every function is deterministic: the same call returns the same bits.

mod creature;
mod cuboid;
mod sphere;
mod teapot;
mod torus_knot;

#[cfg(test)]
mod topology;

pub use creature::{creature, creature_with};
pub use cuboid::cuboid;
pub use sphere::sphere;
pub use teapot::{teapot, teapot_with};
pub use torus_knot::torus_knot;

use crate::Mesh;

/// The names that [`builtin`] knows.
pub const NAMES: &[&str] = &["sphere", "torus-knot", "teapot", "creature"];

/// The built-in model of that name (one of [`NAMES`]), about 100 mm across; `None` for any other name.
#[must_use]
pub fn builtin(name: &str) -> Option<Mesh> {
    match name {
        "sphere" => Some(sphere([0.0; 3], 50.0, 5)),
        "torus-knot" => Some(torus_knot()),
        "teapot" => Some(teapot()),
        "creature" => Some(creature()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_listed_name_is_known_and_no_other() {
        for &name in NAMES.iter().filter(|&&name| name != "creature") {
            assert_eq!(builtin(name).map(|mesh| mesh.name).as_deref(), Some(name));
        }
        assert!(NAMES.contains(&"creature"));
        assert_eq!(builtin("bunny"), None);
    }
}
