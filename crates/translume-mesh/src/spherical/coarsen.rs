//! Takes the vertices of a closed mesh away one by one, remembering how to put them back.
//!
//! Half-edge collapses in rounds of independent vertices, as in progressive meshes (Hoppe 1996) and the hierarchy of
//! Dobkin and Kirkpatrick (1985): each round takes about a quarter of the vertices, evenly over the surface.

use glam::Vec3;

/// No vertex may gather more neighbours than this while others can go.
const MAX_DEGREE: usize = 12;
/// No triangle counts as flatter than this: doubled area over longest edge², see [`thinness`].
const FLATTEST: f32 = 1e-6;

/// A closed manifold mesh as the counter-clockwise ring of neighbours of each vertex; rings of absent vertices are empty.
pub struct Rings(pub Vec<Vec<u32>>);

/// What a removal may lead to.
struct Limits {
    thinness: f32,
    degree: usize,
}

impl Limits {
    /// Good places are used up: accepts thinner triangles, then more of them about a vertex.
    fn widen(&mut self) {
        if self.thinness <= 1.0 / FLATTEST {
            self.thinness *= 4.0;
        } else {
            self.degree = self.degree.saturating_mul(2);
        }
    }
}

/// A vertex that was merged into `ring[into]`.
pub struct Removal {
    pub vertex: u32,
    pub ring: Vec<u32>,
    pub into: usize,
}

impl Rings {
    pub fn new(vertices: usize, triangles: &[[u32; 3]]) -> Self {
        let mut spokes = vec![Vec::with_capacity(8); vertices];
        for &[a, b, c] in triangles {
            for (v, from, to) in [(a, b, c), (b, c, a), (c, a, b)] {
                spokes[v as usize].push((from, to));
            }
        }
        let chain = |spokes: Vec<(u32, u32)>| {
            let mut ring = Vec::with_capacity(spokes.len());
            let mut next = spokes.first().map(|&(from, _)| from);
            while let Some(v) = next.filter(|_| ring.len() < spokes.len()) {
                ring.push(v);
                next = spokes.iter().find(|&&(from, _)| from == v).map(|&(_, to)| to);
            }
            ring
        };
        Self(spokes.into_iter().map(chain).collect())
    }

    /// The vertices that are still there.
    pub fn present(&self) -> impl Iterator<Item = u32> {
        (0..self.0.len() as u32).filter(|&v| !self.0[v as usize].is_empty())
    }

    /// Every triangle once, starting at its lowest vertex.
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        let fans = self.present().flat_map(|v| {
            let ring = &self.0[v as usize];
            (0..ring.len()).map(move |i| [v, ring[i], ring[(i + 1) % ring.len()]])
        });
        fans.filter(|&[v, a, b]| v < a && v < b).collect()
    }

    /// Takes vertices away until `keep` (≥ 4) are left; one list of removals per round.
    ///
    /// It always gets there on a closed surface of genus 0: by Euler's formula some vertex has at most five neighbours,
    /// and as no two chords between them can cross on the other side, it can be merged into one of them.
    pub fn coarsen(&mut self, positions: &[Vec3], keep: usize) -> Vec<Vec<Removal>> {
        let mut rounds = Vec::new();
        let mut count = self.present().count();
        let mut limits = Limits { thinness: 20.0, degree: MAX_DEGREE };
        while count > keep && limits.degree < usize::MAX {
            let removed = self.round(positions, count - keep, &limits);
            count -= removed.len();
            if removed.len() * 20 < count {
                limits.widen();
            }
            if !removed.is_empty() {
                rounds.push(removed);
            }
        }
        rounds
    }

    /// One independent set of at most `limit` vertices, those in the densest places first.
    fn round(&mut self, positions: &[Vec3], limit: usize, limits: &Limits) -> Vec<Removal> {
        let mut order = self.present().map(|v| (self.extent(positions, v), v)).collect::<Vec<_>>();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut locked = vec![false; self.0.len()];
        let mut removed = Vec::new();
        for (_, vertex) in order {
            if removed.len() == limit {
                break;
            }
            if locked[vertex as usize] {
                continue;
            }
            if let Some(into) = self.best_target(positions, vertex, limits) {
                let ring = std::mem::take(&mut self.0[vertex as usize]);
                ring.iter().for_each(|&r| locked[r as usize] = true);
                let removal = Removal { vertex, ring, into };
                self.remove(&removal);
                removed.push(removal);
            }
        }
        removed
    }

    /// Sum of squared distances to the neighbours: small where vertices are dense and neighbours few.
    fn extent(&self, positions: &[Vec3], v: u32) -> f32 {
        let ring = &self.0[v as usize];
        ring.iter().map(|&r| positions[r as usize].distance_squared(positions[v as usize])).sum::<f32>()
    }

    /// The neighbour to merge `v` into that leaves the best triangles, if they are within the limits.
    fn best_target(&self, positions: &[Vec3], v: u32, limits: &Limits) -> Option<usize> {
        let ring = &self.0[v as usize];
        if ring.len() > limits.degree.saturating_add(1) {
            return None;
        }
        let normal = fan(ring, 0).map(|[a, b, c]| cross(positions, [a, b, c])).sum::<Vec3>();
        let cost = |into: usize| fan(ring, into).map(|t| thinness(positions, t, normal)).fold(0.0, f32::max);
        (0..ring.len())
            .filter(|&into| self.keeps_manifold(ring, into, limits.degree))
            .map(|into| (cost(into), into))
            .filter(|&(cost, _)| cost < limits.thinness)
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, into)| into)
    }

    /// The link condition: the target may share no neighbour with the ring but the two beside it.
    fn keeps_manifold(&self, ring: &[u32], into: usize, degree: usize) -> bool {
        let n = ring.len();
        let target = &self.0[ring[into] as usize];
        target.len() + n <= degree.saturating_add(4)
            && (2..n - 1).all(|k| !target.contains(&ring[(into + k) % n]))
            // A side vertex of degree 3 would be left with two neighbours.
            && [1, n - 1].iter().all(|k| self.0[ring[(into + k) % n] as usize].len() > 3)
    }

    fn remove(&mut self, Removal { vertex, ring, into }: &Removal) {
        let n = ring.len();
        let target = ring[*into];
        for k in 1..n {
            let neighbours = &mut self.0[ring[(into + k) % n] as usize];
            let Some(at) = neighbours.iter().position(|r| r == vertex) else { continue };
            if k == 1 || k == n - 1 {
                neighbours.remove(at);
            } else {
                neighbours[at] = target;
            }
        }
        let beyond = (2..n - 1).map(|k| ring[(into + k) % n]);
        let neighbours = &mut self.0[target as usize];
        if let Some(at) = neighbours.iter().position(|r| r == vertex) {
            neighbours.splice(at..=at, beyond);
        }
    }

    /// Undoes the latest removal that is not yet undone.
    pub fn restore(&mut self, Removal { vertex, ring, into }: Removal) {
        let n = ring.len();
        let target = ring[into];
        for k in 1..n {
            let neighbours = &mut self.0[ring[(into + k) % n] as usize];
            let Some(at) = neighbours.iter().position(|&r| r == target) else { continue };
            // Around a ring vertex the target, the removed vertex and the rest follow each other counter-clockwise.
            match k {
                1 => neighbours.insert(at, vertex),
                _ if k == n - 1 => neighbours.insert(at + 1, vertex),
                _ => neighbours[at] = vertex,
            }
        }
        let neighbours = &mut self.0[target as usize];
        let after = neighbours.iter().position(|&r| r == ring[(into + 1) % n]).unwrap_or(0);
        neighbours.rotate_left(after);
        neighbours.splice(1..n - 2, [vertex]);
        self.0[vertex as usize] = ring;
    }
}

/// The triangles that close the hole inside a ring, all from one of its vertices.
fn fan(ring: &[u32], from: usize) -> impl Iterator<Item = [u32; 3]> {
    let n = ring.len();
    (1..n - 1).map(move |k| [ring[from], ring[(from + k) % n], ring[(from + k + 1) % n]])
}

fn cross(positions: &[Vec3], triangle: [u32; 3]) -> Vec3 {
    let [a, b, c] = triangle.map(|v| positions[v as usize]);
    (b - a).cross(c - a)
}

/// Longest edge² over the doubled area as seen along `normal`: 1.2 when equilateral, huge when turned away.
fn thinness(positions: &[Vec3], triangle: [u32; 3], normal: Vec3) -> f32 {
    let [a, b, c] = triangle.map(|v| positions[v as usize]);
    let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
    let area = cross(positions, triangle).dot(normal.normalize_or_zero());
    longest / area.max(FLATTEST * longest)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two cones base to base, with `n` vertices on the rim.
    fn spindle(n: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let rim = (0..n).map(|k| {
            let (z, x) = (std::f32::consts::TAU * k as f32 / n as f32).sin_cos();
            Vec3::new(x, 0.0, z)
        });
        let positions = [Vec3::Y, Vec3::NEG_Y].into_iter().chain(rim).collect();
        let next = |k| 2 + (k + 1) % n;
        (positions, (0..n).flat_map(|k| [[0, next(k), 2 + k], [1, 2 + k, next(k)]]).collect())
    }

    /// Even where no vertex may keep as many neighbours as it has.
    #[test]
    fn a_tetrahedron_is_left_and_everything_comes_back() {
        let (positions, triangles) = spindle(300);
        let mut rings = Rings::new(positions.len(), &triangles);
        let sorted = |rings: &Rings| {
            let mut triangles = rings.triangles();
            triangles.sort_unstable();
            triangles
        };
        let before = sorted(&rings);
        let rounds = rings.coarsen(&positions, 4);
        assert_eq!((before.len(), rings.present().count(), rings.triangles().len()), (600, 4, 4));
        rounds.into_iter().flatten().rev().for_each(|removal| rings.restore(removal));
        assert_eq!(sorted(&rings), before);
    }

    /// A ring of handles keeps what it needs: seven vertices at least (Möbius 1861), so never a tetrahedron.
    #[test]
    fn a_torus_is_left_a_torus() {
        let n = 12;
        let at = |i: u32, j: u32| (i % n) * n + j % n;
        let position = |v: u32| {
            let [i, j] = [v / n, v % n].map(|k| std::f32::consts::TAU * k as f32 / n as f32);
            Vec3::new((2.0 + j.cos()) * i.cos(), j.sin(), (2.0 + j.cos()) * i.sin())
        };
        let quads = (0..n * n).map(|v| (v / n, v % n));
        let triangles = quads
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect::<Vec<_>>();
        let positions = (0..n * n).map(position).collect::<Vec<_>>();
        let mut rings = Rings::new(positions.len(), &triangles);
        rings.coarsen(&positions, 4);
        let left = rings.present().count();
        assert!(left >= 7 && rings.triangles().len() == 2 * left, "V − E + F stays 0");
    }
}
