//! A tessellated box with hard edges.

use crate::Mesh;

/// An axis-aligned box from `min` to `max` (millimetres, `min` < `max` in every axis), each edge cut into
/// `divisions` parts along x, y and z (0 counts as 1).
///
/// The six sides have vertices of their own, so their edges are hard; positions along shared edges are bit-identical,
/// so welding by position closes the box.
#[must_use]
pub fn cuboid(min: [f32; 3], max: [f32; 3], divisions: [u32; 3]) -> Mesh {
    let mut mesh = Mesh { name: "box".into(), ..Mesh::default() };
    let divisions = divisions.map(|n| n.max(1));
    for axis in 0..3 {
        for far in [false, true] {
            side(&mut mesh, [min, max], divisions, axis, far);
        }
    }
    mesh
}

/// The side across `axis`, at `max` if `far`.
fn side(mesh: &mut Mesh, [min, max]: [[f32; 3]; 2], divisions: [u32; 3], axis: usize, far: bool) {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let first = mesh.positions.len() as u32;
    let coordinate = |k: usize, step: u32| match step {
        // The last step must hit `max` exactly, whatever the rounding of the others.
        step if step == divisions[k] => max[k],
        step => min[k] + (max[k] - min[k]) * (step as f32 / divisions[k] as f32),
    };
    for j in 0..=divisions[v] {
        for i in 0..=divisions[u] {
            let (mut position, mut normal) = ([0.0; 3], [0.0; 3]);
            position[axis] = if far { max[axis] } else { min[axis] };
            position[u] = coordinate(u, i);
            position[v] = coordinate(v, j);
            normal[axis] = if far { 1.0 } else { -1.0 };
            mesh.positions.push(position);
            mesh.normals.push(normal);
        }
    }
    let row = divisions[u] + 1;
    for j in 0..divisions[v] {
        for i in 0..divisions[u] {
            let [a, b] = [first + j * row + i, first + (j + 1) * row + i];
            let quad = if far { [a, a + 1, b + 1, b] } else { [a, b, b + 1, a + 1] };
            mesh.triangles.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::topology::{Topology, check_clean, signed_volume};

    #[test]
    fn welds_to_a_closed_box_of_the_stated_volume() {
        // Thirds and sevenths of odd numbers round, so shared edges are put to the test.
        let mesh = cuboid([-0.1, 0.3, -7.7], [1.1, 2.9, 5.5], [3, 7, 11]);
        assert_eq!(mesh.triangles.len(), 4 * (3 * 7 + 7 * 11 + 11 * 3));
        check_clean(&mesh);
        let topology = Topology::of(&mesh);
        assert_eq!((topology.euler(), topology.components, topology.bad_edges), (2, 1, 0));
        let expected = 1.2 * 2.6 * 13.2;
        assert!((signed_volume(&mesh) / expected - 1.0).abs() < 1e-6, "f32 coordinates, 1e-7 each");
        assert!(mesh.normals.iter().all(|n| n.iter().map(|x| x.abs()).sum::<f32>() == 1.0));
    }

    #[test]
    fn a_shifted_side_is_noticed() {
        let mut mesh = cuboid([0.0; 3], [1.0; 3], [2, 2, 2]);
        mesh.positions[0][0] += 1e-6;
        assert_ne!(Topology::of(&mesh).bad_edges, 0);
    }
}
