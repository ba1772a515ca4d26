//! A sphere with near-even triangles.

use std::collections::HashMap;

use glam::Vec3;

use crate::Mesh;

/// More would be 80 million triangles.
const MAX_SUBDIVISIONS: u32 = 10;

/// A sphere as an icosahedron whose triangles are split into four `subdivisions` times: 20·4ⁿ triangles
/// (5 gives 20,480), shared vertices on the exact sphere, exact radial normals.
///
/// `radius` in millimetres, > 0. `subdivisions` above 10 count as 10.
#[must_use]
pub fn sphere(center: [f32; 3], radius: f32, subdivisions: u32) -> Mesh {
    let (mut directions, mut triangles) = icosahedron();
    for _ in 0..subdivisions.min(MAX_SUBDIVISIONS) {
        triangles = split(&mut directions, &triangles);
    }
    Mesh {
        name: "sphere".into(),
        positions: directions.iter().map(|&d| (Vec3::from(center) + radius * d).into()).collect(),
        normals: directions.iter().map(|&d| d.into()).collect(),
        triangles,
        ..Mesh::default()
    }
}

/// Twelve vertices: the cyclic permutations of (0, ±1, ±φ), made unit.
fn icosahedron() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let golden = f32::midpoint(1.0, 5.0f32.sqrt());
    let corners = [[-1.0, -golden], [1.0, -golden], [-1.0, golden], [1.0, golden]];
    let directions = (0..3)
        .flat_map(|axis| {
            corners.map(|[short, long]| {
                let mut corner = [0.0; 3];
                corner[(axis + 1) % 3] = short;
                corner[(axis + 2) % 3] = long;
                Vec3::from(corner).normalize()
            })
        })
        .collect::<Vec<_>>();
    let triangles = faces(&directions);
    (directions, triangles)
}

/// The outward triples of vertices that are all neighbours; neighbours on an icosahedron have cosine 1/√5.
fn faces(directions: &[Vec3]) -> Vec<[u32; 3]> {
    let near = |a: usize, b: usize| directions[a].dot(directions[b]) > 0.4;
    let mut faces = Vec::with_capacity(20);
    for a in 0..directions.len() {
        for b in a + 1..directions.len() {
            for c in (b + 1..directions.len()).filter(|&c| near(a, b) && near(b, c) && near(c, a)) {
                let outward = directions[a].dot(directions[b].cross(directions[c])) > 0.0;
                faces.push((if outward { [a, b, c] } else { [a, c, b] }).map(|v| v as u32));
            }
        }
    }
    faces
}

fn split(directions: &mut Vec<Vec3>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut midpoints = HashMap::with_capacity(triangles.len() * 3 / 2);
    let mut midpoint = |a: u32, b: u32| {
        *midpoints.entry((a.min(b), a.max(b))).or_insert_with(|| {
            directions.push((directions[a as usize] + directions[b as usize]).normalize());
            directions.len() as u32 - 1
        })
    };
    triangles
        .iter()
        .flat_map(|&[a, b, c]| {
            let (ab, bc, ca) = (midpoint(a, b), midpoint(b, c), midpoint(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::topology::{Topology, check_clean, signed_volume};

    #[test]
    fn is_a_closed_sphere_of_the_stated_size() {
        let mesh = sphere([1.0, 2.0, 3.0], 50.0, 5);
        assert_eq!(mesh.triangles.len(), 20_480);
        check_clean(&mesh);
        let topology = Topology::of(&mesh);
        assert_eq!((topology.euler(), topology.components, topology.bad_edges), (2, 1, 0));
        for (&p, &n) in mesh.positions.iter().zip(&mesh.normals) {
            let offset = Vec3::from(p) - Vec3::new(1.0, 2.0, 3.0);
            // f32 rounding of coordinates up to 53 is 2·10⁻⁶ each.
            assert!((offset.length() - 50.0).abs() < 1e-5 && offset.normalize().distance(n.into()) < 1e-6);
        }
        let ball = 4.0 / 3.0 * std::f64::consts::PI * 50f64.powi(3);
        // A chord mesh of edge h misses about h²/(4R²) of the volume: h ≈ 2 mm, so 0.04 %; twice that is allowed.
        let volume = signed_volume(&mesh);
        assert!(volume < ball && volume > 0.999 * ball, "{volume} of {ball}");
    }

    #[test]
    fn triangles_are_even() {
        let mesh = sphere([0.0; 3], 1.0, 4);
        let areas = crate::builtin::topology::areas(&mesh);
        let (low, high) = areas.iter().fold((f64::MAX, 0.0), |(l, h): (f64, f64), &a| (l.min(a), h.max(a)));
        assert!(high / low < 1.5, "split midpoints stay within 1.5, {high} / {low}");
    }

    #[test]
    fn a_hole_and_an_inside_out_sphere_are_noticed() {
        let mut mesh = sphere([0.0; 3], 1.0, 2);
        mesh.triangles.pop();
        assert_eq!(Topology::of(&mesh).bad_edges, 3);
        mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        assert!(signed_volume(&mesh) < 0.0);
    }
}
