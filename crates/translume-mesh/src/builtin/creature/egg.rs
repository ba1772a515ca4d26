//! Lays the creature's surface around an egg without a fold.
//!
//! Coarse to fine, as Praun and Hoppe (2003, "Spherical parametrization and remeshing") lay a surface on a sphere: thin
//! the mesh to a tetrahedron, lay that around the egg, then put the vertices back one round at a time, each into the
//! kernel of its ring, and after each round let all vertices glide to where the triangles are least distorted.

use glam::{DMat3, DVec3, Vec3};

use super::coarsen::{Removal, Rings};

/// Radius at the widest and half the height, mm.
pub const RADII: [f64; 2] = [31.0, 41.0];
/// How much slimmer the upper half is: the radius carries e^(−taper·y), y from −1 at the bottom to 1 at the top.
pub const TAPER: f64 = 0.2;
/// How much an uneven area weighs against a bad angle.
const EVENNESS: i32 = 2;
/// Gliding passes after each round: this many vertex moves in all, but within these bounds. Far transport happens while
/// the mesh is coarse, where passes are cheap.
const MOVES: usize = 20_000;
const SWEEPS: [usize; 2] = [3, 16];
/// The map is turned to face like the creature while it has fewer vertices than this.
const TURNING: usize = 500;

/// The point of the egg in a direction of the unit sphere, seen from the egg's middle, mm.
fn on_egg(direction: DVec3) -> DVec3 {
    let slim = RADII[0] * (-TAPER * direction.y).exp();
    DVec3::new(slim * direction.x, RADII[1] * direction.y, slim * direction.z)
}

/// Where each vertex of a closed mesh of genus 0 goes on the egg that stands on y = 0.
pub fn lay(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut rings = Rings::new(positions.len(), triangles);
    let rounds = rings.coarsen(positions, 4);
    let mut cover = Cover {
        rest: positions.iter().map(|p| p.as_dvec3()).collect(),
        directions: vec![DVec3::ZERO; positions.len()],
        points: vec![DVec3::ZERO; positions.len()],
        rings,
        scale: 1.0,
        corners: Vec::new(),
    };
    cover.start();
    for round in rounds.into_iter().rev() {
        for removal in round.into_iter().rev() {
            cover.restore(removal);
        }
        cover.rescale();
        let present = cover.rings.present().count();
        for _ in 0..(MOVES / present).clamp(SWEEPS[0], SWEEPS[1]) {
            cover.glide();
        }
    }
    cover.points.iter().map(|p| (*p + RADII[1] * DVec3::Y).as_vec3()).collect()
}

/// The mesh on its way around the egg.
struct Cover {
    rest: Vec<DVec3>,
    directions: Vec<DVec3>,
    /// [`on_egg`] of each direction.
    points: Vec<DVec3>,
    rings: Rings,
    /// Area of the egg over that of the present mesh.
    scale: f64,
    /// Scratch: the triangles about the vertex in hand.
    corners: Vec<Corner>,
}

/// A triangle (v, b, c) about a vertex v.
struct Corner {
    b: DVec3,
    c: DVec3,
    /// Cotangents of the rest triangle's angles at v, b and c.
    cot: [f64; 3],
    /// Its rest area, scaled to the egg.
    area: f64,
}

impl Cover {
    /// Lays the last vertices, a tetrahedron: any closed mesh of genus 0 that we met thins down to one.
    fn start(&mut self) {
        let base = self.rings.present().collect::<Vec<_>>();
        let corners = [(1.0, 1.0, 1.0), (-1.0, 1.0, -1.0), (1.0, -1.0, -1.0), (-1.0, -1.0, 1.0)];
        for (&v, (x, y, z)) in base.iter().zip(corners) {
            self.set(v, DVec3::new(x, y, z).normalize());
        }
        let ring = &self.rings.0[base[0] as usize];
        let [a, b, c] = [base[0], ring[0], ring[1]].map(|v| self.directions[v as usize]);
        if a.dot(b.cross(c)) < 0.0 {
            base.iter().for_each(|&v| self.set(v, -self.directions[v as usize]));
        }
        self.rescale();
    }

    fn set(&mut self, v: u32, direction: DVec3) {
        self.directions[v as usize] = direction;
        self.points[v as usize] = on_egg(direction);
    }

    fn restore(&mut self, removal: Removal) {
        let v = removal.vertex;
        let direction = self.kernel(&removal.ring, removal.into);
        self.rings.restore(removal);
        self.set(v, direction);
        self.improve(v);
    }

    /// A direction that sees the whole ring counter-clockwise. The ring is a fan from `ring[from]`, so some direction
    /// close to that vertex does.
    fn kernel(&self, ring: &[u32], from: usize) -> DVec3 {
        let at = |k: usize| self.directions[ring[k % ring.len()] as usize];
        let sides = (0..ring.len()).map(|k| at(k).cross(at(k + 1)).normalize_or_zero()).collect::<Vec<_>>();
        let margin = |d: DVec3| sides.iter().map(|side| side.dot(d)).fold(f64::MAX, f64::min);
        let middle = (0..ring.len()).map(at).sum::<DVec3>().normalize_or_zero();
        let inward = (sides[from] + sides[(from + ring.len() - 1) % ring.len()]).normalize_or_zero();
        let near = |step: i32| (at(from) + 0.5f64.powi(step) * inward).normalize();
        let candidates = std::iter::once(middle).chain((0..40).map(near));
        candidates.max_by(|&a, &b| margin(a).total_cmp(&margin(b))).unwrap_or(middle)
    }

    fn rescale(&mut self) {
        let (mut rest, mut laid) = (0.0, 0.0);
        for triangle in self.rings.triangles() {
            let [a, b, c] = triangle.map(|v| self.rest[v as usize]);
            rest += (b - a).cross(c - a).length();
            let [a, b, c] = triangle.map(|v| self.points[v as usize]);
            laid += (b - a).cross(c - a).length();
        }
        self.scale = laid / rest;
    }

    /// One pass of improvement over all present vertices.
    fn glide(&mut self) {
        let present = self.rings.present().collect::<Vec<_>>();
        if present.len() < TURNING {
            self.turn(&present);
        }
        for v in present {
            self.improve(v);
        }
    }

    /// Turns the whole map so that directions agree best with those of the creature: the rotation next to the matrix
    /// of their products, by Newton's iteration for the polar decomposition.
    fn turn(&mut self, present: &[u32]) {
        let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
        let wanted = |v: u32| (self.rest[v as usize] - RADII[1] * DVec3::Y).normalize_or_zero();
        let mut matrix = present
            .iter()
            .map(|&v| outer(wanted(v), self.directions[v as usize]))
            .fold(DMat3::ZERO, |sum, product| sum + product)
            * (1.0 / present.len() as f64);
        if matrix.determinant() < 1e-6 {
            return;
        }
        for _ in 0..20 {
            matrix = (matrix + matrix.inverse().transpose()) * 0.5;
        }
        for &v in present {
            self.set(v, (matrix * self.directions[v as usize]).normalize());
        }
    }

    /// Moves one vertex downhill in the distortion of its triangles.
    fn improve(&mut self, v: u32) {
        self.gather(v);
        let (direction, point) = (self.directions[v as usize], self.points[v as usize]);
        let (energy, slope) = distortion(&self.corners, point);
        // Derivatives of the egg's point along two tangents of the sphere.
        let (along, across) = direction.any_orthonormal_pair();
        let tangent = |t: DVec3| (on_egg((direction + 1e-6 * t).normalize()) - point) / 1e-6;
        let descent = -(slope.dot(tangent(along)) * along + slope.dot(tangent(across)) * across);
        let reach = self.corners.iter().map(|corner| corner.b.distance(point)).fold(f64::MAX, f64::min);
        let mut step = 0.5 * reach / (RADII[0] * descent.length().max(1e-30));
        for _ in 0..6 {
            let moved = (direction + step * descent).normalize();
            let trial = on_egg(moved);
            if distortion(&self.corners, trial).0 < energy {
                self.directions[v as usize] = moved;
                self.points[v as usize] = trial;
                return;
            }
            step *= 0.35;
        }
    }

    fn gather(&mut self, v: u32) {
        let ring = &self.rings.0[v as usize];
        let rest = |v: u32| self.rest[v as usize];
        let cotangent = |at: DVec3, p: DVec3, q: DVec3, doubled: f64| (p - at).dot(q - at) / doubled;
        self.corners.clear();
        self.corners.extend((0..ring.len()).map(|k| {
            let (b, c) = (ring[k], ring[(k + 1) % ring.len()]);
            let [x, y, z] = [v, b, c].map(rest);
            let doubled = (y - x).cross(z - x).length().max(1e-9);
            Corner {
                b: self.points[b as usize],
                c: self.points[c as usize],
                cot: [cotangent(x, y, z, doubled), cotangent(y, z, x, doubled), cotangent(z, x, y, doubled)],
                area: self.scale * doubled / 2.0,
            }
        }));
    }
}

/// How much the triangles about a vertex at `v` are distorted, and the gradient by `v`; infinite if one is turned over.
///
/// Per triangle, with the singular values σ of its map: ½(σ₁/σ₂ + σ₂/σ₁) · ½(τ + 1/τ)ⁿ · area, where τ is its area over
/// the wanted one (Degener, Meseth, Klein 2003, "An adaptable surface parameterization method").
fn distortion(corners: &[Corner], v: DVec3) -> (f64, DVec3) {
    let (mut energy, mut slope) = (0.0, DVec3::ZERO);
    for Corner { b, c, cot, area } in corners {
        // Area seen from the egg's middle: it vanishes before the triangle turns over.
        let outward = b.cross(*c);
        let depth = 2.0 * (v + *b + *c).length() / 3.0;
        let laid = v.dot(outward) / depth;
        if laid <= 0.0 {
            return (f64::INFINITY, DVec3::ZERO);
        }
        let [vb, vc] = [v - *b, v - *c];
        let dirichlet = 0.25
            * (cot[0] * b.distance_squared(*c) + cot[1] * vc.length_squared() + cot[2] * vb.length_squared());
        let dirichlet_slope = 0.5 * (cot[1] * vc + cot[2] * vb);
        let laid_slope = outward / depth;
        let ratio = laid / area;
        let evenness = 0.5 * (ratio + 1.0 / ratio);
        let term = area * dirichlet / laid * evenness.powi(EVENNESS);
        let by_laid =
            -1.0 / laid + f64::from(EVENNESS) * 0.5 * (1.0 - 1.0 / (ratio * ratio)) / (evenness * area);
        energy += term;
        slope += term * (dirichlet_slope / dirichlet + by_laid * laid_slope);
    }
    (energy, slope)
}
