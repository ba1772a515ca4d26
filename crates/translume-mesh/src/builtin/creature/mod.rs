//! A creature with thin ears, and the egg it melts into.
//!
//! | module | what it does |
//! | --- | --- |
//! | [`anatomy`] | the body, part by part |
//! | [`field`] | the signed distance field that the parts make |
//! | [`surface_nets`] | from the field to triangles |
//! | [`relax`] | even triangles |
//! | [`egg`] | the same triangles around an egg, by [`spherical`](crate::spherical) |

mod anatomy;
mod egg;
mod field;
mod relax;
mod surface_nets;

use glam::Vec3;

use crate::normals::smooth_normals;
use crate::spherical::coarsen::Rings;
use crate::{Mesh, MorphTarget};

/// A box around the creature with room to spare, mm.
const BOX: [Vec3; 2] = [Vec3::new(-43.0, -4.0, -36.5), Vec3::new(43.0, 102.0, 41.0)];
/// Surface nets put about (this / step)² triangles on the creature; mm.
const STEP_SCALE: f32 = 230.6;
/// Coarser grids would miss parts of the ears: a sheet must be thicker than a cell's diagonal, √3 steps.
const MAX_STEP: f32 = 1.5;
/// Rounds after which the triangles hardly get more even.
const RELAX_ROUNDS: usize = 8;

/// A plump creature, 98 mm tall, that sits on y = 0 and looks along +z: one smooth closed surface of genus 0 with some
/// 50,000 even triangles. Its two large ears are sheets less than 3 mm thick, for light to shine through.
///
/// Its one morph target, "egg", lays the same triangles around an egg of 82 mm that stands on y = 0, without a fold and
/// with areas as even as the ears allow. Takes about a second.
#[must_use]
pub fn creature() -> Mesh {
    creature_with(50_000)
}

/// The [`creature`] with about `triangles` triangles, within 5 %; values outside 2,000 to 500,000 are clamped.
#[must_use]
pub fn creature_with(triangles: usize) -> Mesh {
    let wanted = triangles.clamp(2_000, 500_000);
    let field = anatomy::creature();
    let step = (STEP_SCALE / (wanted as f32).sqrt()).min(MAX_STEP);
    let (mut positions, mut triangles) = surface_nets::surface_nets(&field, BOX, step);
    if step == MAX_STEP {
        (positions, triangles) = thinned(&positions, &triangles, wanted);
    }
    relax::relax(&field, &mut positions, &triangles, RELAX_ROUNDS);
    let laid = egg::lay(&positions, &triangles);
    let position_deltas = laid.iter().zip(&positions).map(|(&there, &here)| (there - here).into()).collect();
    let positions = positions.into_iter().map(Into::into).collect::<Vec<_>>();
    Mesh {
        name: "creature".into(),
        // As on a deformed pose, so that the first bit of melting does not change the shading.
        normals: smooth_normals(&positions, &triangles),
        positions,
        triangles,
        targets: vec![MorphTarget { name: "egg".into(), position_deltas }],
        ..Mesh::default()
    }
}

/// A closed mesh of genus 0 brought down to `wanted` triangles.
fn thinned(positions: &[Vec3], triangles: &[[u32; 3]], wanted: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut rings = Rings::new(positions.len(), triangles);
    // Euler: twice as many triangles as vertices, less four.
    rings.coarsen(positions, wanted / 2 + 2);
    let mut ids = vec![0; positions.len()];
    let mut kept = Vec::new();
    for v in rings.present() {
        ids[v as usize] = kept.len() as u32;
        kept.push(positions[v as usize]);
    }
    (kept, rings.triangles().into_iter().map(|triangle| triangle.map(|v| ids[v as usize])).collect())
}

#[cfg(test)]
mod tests;
