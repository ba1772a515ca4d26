//! Spreads the vertices of a mesh evenly over the surface it came from.

use glam::Vec3;

use super::field::Field;

/// Moves every vertex towards the middle of its triangles within the tangent plane and back onto the zero level of
/// `field`, `rounds` times.
pub fn relax(field: &Field, positions: &mut [Vec3], triangles: &[[u32; 3]], rounds: usize) {
    for _ in 0..rounds {
        let rings = rings(positions, triangles);
        for (position, ring) in positions.iter_mut().zip(rings) {
            let normal = ring.normal.normalize_or_zero();
            *position += (ring.moment / ring.area - *position).reject_from_normalized(normal);
            // One sample: the mesh's normal stands in for the gradient until the last rounds.
            *position -= field.distance(*position) * normal;
        }
    }
    for _ in 0..2 {
        positions.iter_mut().for_each(|position| *position = field.project(*position));
    }
}

/// Sums over the triangles around a vertex.
#[derive(Clone, Copy, Default)]
struct Ring {
    area: f32,
    /// Area-weighted normals and centres: large triangles pull harder, so they shrink and small ones grow.
    normal: Vec3,
    moment: Vec3,
}

fn rings(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Ring> {
    let mut rings = vec![Ring::default(); positions.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| positions[v as usize]);
        let normal = (b - a).cross(c - a);
        let area = normal.length();
        for &v in triangle {
            let ring = &mut rings[v as usize];
            ring.area += area;
            ring.normal += normal;
            ring.moment += area * (a + b + c) / 3.0;
        }
    }
    rings
}
