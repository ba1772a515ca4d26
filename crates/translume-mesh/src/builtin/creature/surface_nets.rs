//! Naive surface nets (Gibson 1998): one vertex in every grid cell that the surface crosses, one quad for every grid
//! edge it crosses.

use glam::{UVec3, Vec3};

use super::field::{FAR, Field};

/// Corners along one side of a block; blocks far from the surface are filled with one sample.
const BLOCK: u32 = 4;
/// How much the field's distances may overstate the true ones.
const DOUBT: f32 = 1.25;

/// A regular grid of corners over a box.
struct Grid<'a> {
    field: &'a Field,
    low: Vec3,
    step: f32,
    size: UVec3,
    /// Distance at every corner; away from the surface only the sign is right.
    corners: Vec<f32>,
}

/// Meshes the zero level of a field inside the box `low`..`high`, on a grid of spacing `step`, all mm. The surface must
/// stay two steps away from the box's sides.
pub fn surface_nets(field: &Field, [low, high]: [Vec3; 2], step: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let size = ((high - low) / step).ceil().as_uvec3() + 1;
    let mut grid = Grid { field, low, step, size, corners: vec![0.0; size.element_product() as usize] };
    grid.sample();
    grid.settle_checkerboards();
    let (positions, cells) = grid.vertices();
    let triangles = grid.triangles(&positions, &cells);
    (positions, triangles)
}

impl Grid<'_> {
    fn index(&self, at: UVec3) -> usize {
        ((at.z * self.size.y + at.y) * self.size.x + at.x) as usize
    }

    fn point(&self, at: UVec3) -> Vec3 {
        self.low + self.step * at.as_vec3()
    }

    fn sample(&mut self) {
        // From a block's middle to its farthest corner, and one step to a crossed edge beyond.
        let reach = DOUBT * self.step * ((BLOCK - 1) as f32 / 2.0 * 3f32.sqrt() + 1.0);
        debug_assert!(reach < FAR);
        for block in boxes(self.size.map(|n| n.div_ceil(BLOCK))) {
            let first = BLOCK * block;
            let middle = self.field.distance(self.point(first) + self.step * (BLOCK - 1) as f32 / 2.0);
            for offset in boxes((self.size - first).min(UVec3::splat(BLOCK))) {
                let at = first + offset;
                let index = self.index(at);
                self.corners[index] =
                    if middle.abs() > reach { middle } else { self.field.distance(self.point(at)) };
            }
        }
    }

    /// A face whose corners alternate in sign would put four quads on one edge. The surface passes such a face almost
    /// flat, so moving its nearest corner across changes little (and the vertices are projected later).
    fn settle_checkerboards(&mut self) {
        const AXES: [UVec3; 3] = [UVec3::X, UVec3::Y, UVec3::Z];
        let mut settled = false;
        while !settled {
            settled = true;
            for at in boxes(self.size - 1) {
                for (u, v) in [(0, 1), (1, 2), (2, 0)].map(|(u, v)| (AXES[u], AXES[v])) {
                    let face = [at, at + u, at + u + v, at + v].map(|at| self.index(at));
                    let inside = face.map(|k| self.corners[k] < 0.0);
                    if inside[0] == inside[2] && inside[1] == inside[3] && inside[0] != inside[1] {
                        let distance = |&k: &usize| self.corners[k].abs();
                        let nearest = face.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
                        nearest.into_iter().for_each(|k| self.corners[k] = -self.corners[k]);
                        settled = false;
                    }
                }
            }
        }
    }

    /// A vertex for every crossed cell, at the mean of its crossed edges; and the vertex of every cell.
    fn vertices(&self) -> (Vec<Vec3>, Vec<u32>) {
        let mut positions = Vec::new();
        let mut cells = vec![u32::MAX; self.corners.len()];
        for cell in boxes(self.size - 1) {
            let values: [f32; 8] = std::array::from_fn(|k| self.corners[self.index(cell + corner(k))]);
            let inside = values.iter().filter(|&&d| d < 0.0).count();
            if inside == 0 || inside == 8 {
                continue;
            }
            let (mut sum, mut crossings) = (Vec3::ZERO, 0.0);
            for (a, b) in (0..8).flat_map(|a| [1, 2, 4].map(|bit| (a, a | bit))).filter(|(a, b)| a != b) {
                if (values[a] < 0.0) != (values[b] < 0.0) {
                    let along = values[a] / (values[a] - values[b]);
                    sum += corner(a).as_vec3().lerp(corner(b).as_vec3(), along);
                    crossings += 1.0;
                }
            }
            cells[self.index(cell)] = positions.len() as u32;
            positions.push(self.point(cell) + self.step * sum / crossings);
        }
        (positions, cells)
    }

    /// A quad around every crossed edge, cut along its shorter diagonal.
    fn triangles(&self, positions: &[Vec3], cells: &[u32]) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(2 * positions.len());
        for (axis, at) in [UVec3::X, UVec3::Y, UVec3::Z]
            .into_iter()
            .flat_map(|axis| boxes(self.size - 1).map(move |at| (axis, at)))
        {
            let [here, there] = [at, at + axis].map(|at| self.corners[self.index(at)] < 0.0);
            if here == there {
                continue;
            }
            // With (axis, u, v) right-handed the four cells run counter-clockwise seen from the far end.
            let (u, v) = (UVec3::new(axis.z, axis.x, axis.y), UVec3::new(axis.y, axis.z, axis.x));
            let mut quad = [at - u - v, at - v, at, at - u].map(|cell| cells[self.index(cell)]);
            if there {
                quad.reverse();
            }
            let [a, b, c, d] = quad;
            let length = |a: u32, b: u32| positions[a as usize].distance_squared(positions[b as usize]);
            let shorter = length(a, c) < length(b, d);
            triangles.extend(if shorter { [[a, b, c], [a, c, d]] } else { [[b, c, d], [b, d, a]] });
        }
        triangles
    }
}

fn corner(k: usize) -> UVec3 {
    UVec3::new(k as u32 & 1, k as u32 >> 1 & 1, k as u32 >> 2)
}

/// All (x, y, z) below `size`, x fastest.
fn boxes(size: UVec3) -> impl Iterator<Item = UVec3> {
    (0..size.z)
        .flat_map(move |z| (0..size.y).flat_map(move |y| (0..size.x).map(move |x| UVec3::new(x, y, z))))
}
