//! The map as a mesh keeps it, in f32.

use glam::DVec3;

use super::cover::Cover;
use super::figures::corners;
use super::ovoid::Ovoid;
use super::surface::Surface;
use super::{Egg, SphericalError};
use crate::mesh::Mesh;

/// Passes over a finished map to right triangles that are turned over or lean, as seldom happens to large slivers.
const PATIENCE: usize = 20;

/// What a mesh keeps of a map.
pub(super) struct Laid {
    pub deltas: Vec<[f32; 3]>,
    /// Where the deltas lead to.
    pub positions: Vec<[f32; 3]>,
    flipped: usize,
    pub leaning: usize,
}

impl Laid {
    fn new(mesh: &Mesh, surface: &Surface, egg: &Egg, cover: &Cover) -> Self {
        let middle = DVec3::from(egg.center.map(f64::from));
        let delta = |(&v, p): (&u32, &[f32; 3])| {
            let target = cover.points()[v as usize] + middle;
            (target - DVec3::from(p.map(f64::from))).as_vec3().to_array()
        };
        let deltas = surface.welded.iter().zip(&mesh.positions).map(delta).collect::<Vec<_>>();
        let moved = |(p, d): (&[f32; 3], &[f32; 3])| std::array::from_fn(|k| p[k] + d[k]);
        let positions = mesh.positions.iter().zip(&deltas).map(moved).collect::<Vec<_>>();
        let (flipped, leaning) = turned(&mesh.triangles, &positions, &egg.ovoid(), middle);
        Self { deltas, positions, flipped, leaning }
    }
}

/// Rounds the map to f32, after some more passes where that turns a triangle over or one leans.
pub(super) fn settle(
    mesh: &Mesh,
    surface: &Surface,
    egg: &Egg,
    cover: &mut Cover,
) -> Result<Laid, SphericalError> {
    let mut laid = Laid::new(mesh, surface, egg, cover);
    for _ in 0..PATIENCE {
        if laid.flipped + laid.leaning == 0 {
            break;
        }
        cover.glide();
        laid = Laid::new(mesh, surface, egg, cover);
    }
    if laid.flipped == 0 {
        return Ok(laid);
    }
    let (flipped, triangles) = (laid.flipped, mesh.triangles.len());
    Err(SphericalError::TooFine { mesh: mesh.name.clone(), flipped, triangles })
}

/// Triangles that face inwards, and triangles that do not but lean away from the egg: from the mean of the normals at
/// their corners by 90° or more.
fn turned(triangles: &[[u32; 3]], laid: &[[f32; 3]], ovoid: &Ovoid, middle: DVec3) -> (usize, usize) {
    let (mut flipped, mut leaning) = (0, 0);
    for &triangle in triangles {
        let [a, b, c] = corners(laid, triangle).map(|p| p - middle);
        let face = (b - a).cross(c - a);
        let outward = [a, b, c].iter().map(|&p| ovoid.normal(p).normalize_or_zero()).sum::<DVec3>();
        let upright = face.dot(a) > 0.0;
        flipped += usize::from(!upright);
        leaning += usize::from(upright && face.dot(outward) <= 0.0);
    }
    (flipped, leaning)
}
