//! A trefoil as a tube.

use std::f32::consts::TAU;

use glam::Vec3;

use crate::Mesh;

/// How often the knot winds about the torus' axis, and about its core.
const WINDINGS: [f32; 2] = [2.0, 3.0];
/// Radii of the torus that carries the knot: axis to core, core to knot, mm.
const TORUS: [f32; 2] = [29.0, 13.5];
/// Radius of the tube, mm.
const TUBE: f32 = 7.5;
/// Vertices along the knot and around the tube.
const STEPS: [u32; 2] = [312, 32];

/// The (2, 3) torus knot (trefoil) lying flat: a tube of radius 7.5 mm, 100 mm across, 19,968 triangles, exact normals.
///
/// The tube keeps a gap of at least 4 mm to itself.
#[must_use]
pub fn torus_knot() -> Mesh {
    let mut mesh = Mesh { name: "torus-knot".into(), ..Mesh::default() };
    for i in 0..STEPS[0] {
        let [center, side, up] = frame(TAU * i as f32 / STEPS[0] as f32);
        for j in 0..STEPS[1] {
            let (sin, cos) = (TAU * j as f32 / STEPS[1] as f32).sin_cos();
            let normal = cos * side + sin * up;
            mesh.positions.push((center + TUBE * normal).into());
            mesh.normals.push(normal.into());
        }
    }
    for i in 0..STEPS[0] {
        for j in 0..STEPS[1] {
            let vertex = |i: u32, j: u32| (i % STEPS[0]) * STEPS[1] + j % STEPS[1];
            let [a, b, c, d] = [vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// Point of the knot at parameter `t` in 0..2π, and two unit vectors across it. The torus' own normal steers them, so
/// the frame closes after one round without twist.
fn frame(t: f32) -> [Vec3; 3] {
    let [p, q] = WINDINGS;
    let ((sin_p, cos_p), (sin_q, cos_q)) = ((p * t).sin_cos(), (q * t).sin_cos());
    let distance = TORUS[0] + TORUS[1] * cos_q;
    let radial = Vec3::new(cos_p, 0.0, sin_p);
    let around = Vec3::new(-sin_p, 0.0, cos_p);
    let center = distance * radial + TORUS[1] * sin_q * Vec3::Y;
    let tangent = p * distance * around + q * TORUS[1] * (cos_q * Vec3::Y - sin_q * radial);
    let torus_normal = cos_q * radial + sin_q * Vec3::Y;
    let side = torus_normal.cross(tangent).normalize();
    [center, side, torus_normal]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::topology::{Topology, check_clean, normal_agreement, signed_volume};

    #[test]
    fn is_a_closed_ring_of_the_tubes_volume() {
        let mesh = torus_knot();
        assert_eq!(mesh.triangles.len(), 19_968);
        check_clean(&mesh);
        let topology = Topology::of(&mesh);
        assert_eq!((topology.euler(), topology.components, topology.bad_edges), (0, 1, 0));
        let points = (0..20_000).map(|i| frame(TAU * i as f32 / 20_000.0)[0]).collect::<Vec<_>>();
        let length: f32 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
        let tube = f64::from(length) * std::f64::consts::PI * f64::from(TUBE).powi(2);
        // Pappus: area × length. A 32-gon has 0.64 % less area than its circle; the rest is chords along the knot.
        let ratio = signed_volume(&mesh) / tube;
        assert!((0.985..1.0).contains(&ratio), "{ratio}");
        // Half a step around is 5.6°; steps along the tight inside add as much again.
        assert!(normal_agreement(&mesh) > 12f64.to_radians().cos());
    }

    #[test]
    fn the_tube_does_not_touch_itself() {
        let points = (0..1200).map(|i| frame(TAU * i as f32 / 1200.0)[0]).collect::<Vec<_>>();
        let mut gap = f32::MAX;
        for i in 0..1200usize {
            // 120 of 1200 steps along the knot are about 45 mm: nearer points are the same strand.
            for j in i + 120..(i + 1080).min(1200) {
                gap = gap.min(points[i].distance(points[j]) - 2.0 * TUBE);
            }
        }
        assert!(gap > 4.0, "{gap} mm");
    }
}
