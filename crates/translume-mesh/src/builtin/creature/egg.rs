//! The egg that the creature melts into.

use glam::{DVec3, Vec3};

use crate::spherical::cover::Cover;
use crate::spherical::ovoid::Ovoid;

/// Radius at half the height and half the height, mm.
pub const RADII: [f64; 2] = [31.0, 41.0];
/// How much slimmer the upper half is: the radius carries e^(−taper·y), y from −1 at the bottom to 1 at the top.
pub const TAPER: f64 = 0.2;

/// Where each vertex of a closed mesh of genus 0 goes on the egg that stands on y = 0.
pub fn lay(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let middle = RADII[1] * DVec3::Y;
    let ovoid = Ovoid { radius: RADII[0], half: RADII[1], taper: TAPER };
    let mut cover = Cover::new(ovoid, positions.iter().map(|p| p.as_dvec3() - middle).collect(), triangles);
    while cover.refine() {}
    cover.points().iter().map(|&p| (p + middle).as_vec3()).collect()
}
