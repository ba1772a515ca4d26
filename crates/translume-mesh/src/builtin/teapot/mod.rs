//! Newell's teapot from its 32 bicubic Bézier patches.

mod patches;

use std::collections::HashMap;

use glam::DVec3;

use crate::Mesh;

/// One of Newell's units in millimetres: handle to spout is 6.43 units, so 100 mm.
const SCALE: f64 = 15.55;

/// Sixteen control points: first index along a profile or tube, second across it.
type Patch = [[DVec3; 4]; 4];

/// The teapot at 6 × 6 quads per patch: 2,256 triangles, the count in Table 1 of Gong et al. 2008.
///
/// See [`teapot_with`].
#[must_use]
pub fn teapot() -> Mesh {
    teapot_with(6)
}

/// Newell's teapot (1975), 100 mm from handle to spout, standing on y = 0, spout towards +x.
///
/// Each of the 32 patches becomes `divisions` × `divisions` quads (0 counts as 1), the degenerate triangles at the two
/// poles dropped: 64 n² − 8 n triangles. Normals come from the derivatives of the patches. Body with rim and bottom, lid,
/// handle and spout are four separate open pieces, smooth within, as Newell left them.
#[must_use]
pub fn teapot_with(divisions: u32) -> Mesh {
    let mut mesh = Mesh { name: "teapot".into(), ..Mesh::default() };
    for part in parts() {
        append(&mut mesh, &part, divisions.max(1));
    }
    mesh
}

/// Body, lid, handle, spout, every patch oriented outward, millimetres, y up.
fn parts() -> [Vec<Patch>; 4] {
    use patches::{BOTTOM, KNOB, LID, LOWER_BODY, LOWER_HANDLE, LOWER_SPOUT};
    use patches::{RIM, UPPER_BODY, UPPER_HANDLE, UPPER_SPOUT};
    [
        [RIM, UPPER_BODY, LOWER_BODY, BOTTOM].iter().flat_map(revolve).collect(),
        [KNOB, LID].iter().flat_map(revolve).collect(),
        [UPPER_HANDLE, LOWER_HANDLE].iter().flat_map(halves).collect(),
        [LOWER_SPOUT, UPPER_SPOUT].iter().flat_map(halves).collect(),
    ]
}

/// From Newell's axes (z up) to ours.
fn millimetres(x: f64, y: f64, z: f64) -> DVec3 {
    SCALE * DVec3::new(x, z, -y)
}

/// Four quarter turns of a profile.
fn revolve(profile: &[[f64; 3]; 4]) -> [Patch; 4] {
    [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)].map(|(cos, sin)| {
        profile.map(|[radius, control, height]| {
            [(radius, 0.0), (radius, control), (control, radius), (0.0, radius)]
                .map(|(x, y)| millimetres(cos * x - sin * y, sin * x + cos * y, height))
        })
    })
}

/// Both halves of a tube; the mirrored one keeps the section's order, so both face outward.
fn halves(half: &patches::HalfTube) -> [Patch; 2] {
    [-1.0, 1.0].map(|side| {
        half.map(|[x0, z0, x1, z1, width]| {
            let section = [(x0, 0.0, z0), (x0, side * width, z0), (x1, side * width, z1), (x1, 0.0, z1)];
            let [a, b, c, d] = section.map(|(x, y, z)| millimetres(x, y, z));
            if side > 0.0 { [a, b, c, d] } else { [d, c, b, a] }
        })
    })
}

/// Tessellates the patches of one part and welds them where they meet.
fn append(mesh: &mut Mesh, patches: &[Patch], divisions: u32) {
    let first = mesh.positions.len();
    let mut ids = HashMap::new();
    let mut normals = Vec::new();
    for patch in patches {
        let mut vertex = |i: u32, j: u32| {
            let [point, normal] =
                evaluate(patch, f64::from(i) / f64::from(divisions), f64::from(j) / f64::from(divisions));
            // Neighbouring patches reach the same point by other roundings: 10⁻⁶ mm tells points from errors.
            let key = (point * 1e6).round().as_i64vec3();
            let id = *ids.entry(key).or_insert_with(|| {
                mesh.positions.push(point.as_vec3().into());
                normals.push(DVec3::ZERO);
                first + normals.len() - 1
            });
            normals[id - first] += normal;
            id as u32
        };
        for i in 0..divisions {
            for j in 0..divisions {
                let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
                let proper = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
                mesh.triangles.extend([[a, b, c], [a, c, d]].into_iter().filter(proper));
            }
        }
    }
    mesh.normals.extend(normals.iter().map(|n| <[f32; 3]>::from(n.normalize().as_vec3())));
}

/// Point and unit normal at (u, v), both 0 to 1.
fn evaluate(patch: &Patch, u: f64, v: f64) -> [DVec3; 2] {
    let normal = |u: f64, v: f64| tangent(patch, u, v, true).cross(tangent(patch, u, v, false));
    let mut across = normal(u, v);
    if across.length() < 1e-9 * SCALE * SCALE {
        // A pole: one side of the patch is a point. The limit of the normal lies a little inside.
        across = normal(u.clamp(1e-4, 1.0 - 1e-4), v);
    }
    let point = weigh(patch, bernstein(u), bernstein(v));
    [point, across.normalize()]
}

/// Derivative along u or v.
fn tangent(patch: &Patch, u: f64, v: f64, along_u: bool) -> DVec3 {
    if along_u { weigh(patch, slopes(u), bernstein(v)) } else { weigh(patch, bernstein(u), slopes(v)) }
}

fn weigh(patch: &Patch, along: [f64; 4], across: [f64; 4]) -> DVec3 {
    (0..4).map(|i| (0..4).map(|j| along[i] * across[j] * patch[i][j]).sum::<DVec3>()).sum()
}

/// Cubic Bernstein polynomials at t.
fn bernstein(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
}

/// Their derivatives.
fn slopes(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [-3.0 * s * s, 3.0 * s * s - 6.0 * s * t, 6.0 * s * t - 3.0 * t * t, 3.0 * t * t]
}

#[cfg(test)]
mod tests;
