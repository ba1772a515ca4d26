//! A surface on its way around an egg: coarse to fine, as Praun and Hoppe lay a surface on a sphere.
//!
//! The mesh is thinned to a tetrahedron and that laid around the egg. Then the vertices return round by round, each into
//! the kernel of its ring, and after each round all vertices glide to where the triangles are least distorted.

use glam::{DVec3, Vec3};

use super::coarsen::{Removal, Rings};
use super::distortion::{Corner, Expansion, distortion, shape};
use super::ovoid::Ovoid;
use super::turn::rotation;

/// Gliding passes after each round: this many vertex moves in all, but within these bounds. Far transport happens while
/// the mesh is coarse, where passes are cheap.
const MOVES: usize = 100_000;
const SWEEPS: [usize; 2] = [4, 16];
/// The map is turned to face like the mesh while it has fewer vertices than this.
const TURNING: usize = 500;
/// Triangles shall become a little fatter than they are, so that slivers keep a height that f32 resolves: each squared
/// side grows by this share of that of a triangle of mean size.
const FATTENING: f64 = 0.02;
/// A present triangle shall have at most this many times its own area for the sake of those that are missing.
const MOST_GAIN: f64 = 2.0;

/// A closed surface of genus 0 laid around an egg about the origin.
pub(crate) struct Cover {
    ovoid: Ovoid,
    /// The surface itself, about a point from which it shall look as from the egg's middle.
    rest: Vec<DVec3>,
    /// The area that each present vertex stands for: a third of its triangles, and its share in absent ones.
    areas: Vec<f64>,
    /// Those areas over a third of the present triangles'.
    gains: Vec<f64>,
    directions: Vec<DVec3>,
    /// Where each direction meets the egg.
    points: Vec<DVec3>,
    rings: Rings,
    /// Removals that are not undone yet, the latest last.
    rounds: Vec<Vec<Removal>>,
    /// Area of the egg over the sum of the areas that present triangles shall have before scaling.
    scale: f64,
    /// Added to each squared side of a rest triangle.
    padding: f64,
    /// Scratch: the triangles about the vertex in hand.
    corners: Vec<Corner>,
}

impl Cover {
    /// Thins the surface and lays what is left.
    pub fn new(ovoid: Ovoid, rest: Vec<DVec3>, triangles: &[[u32; 3]]) -> Self {
        let count = rest.len();
        let mut rings = Rings::new(count, triangles);
        let positions = rest.iter().map(|p| p.as_vec3()).collect::<Vec<Vec3>>();
        let rounds = rings.coarsen(&positions, 4);
        let mut cover = Self {
            ovoid,
            areas: areas(&rest, triangles),
            rest,
            gains: vec![1.0; count],
            directions: vec![DVec3::ZERO; count],
            points: vec![DVec3::ZERO; count],
            rings,
            rounds,
            scale: 1.0,
            padding: 0.0,
            corners: Vec::new(),
        };
        for removal in cover.rounds.iter().flatten() {
            share(&mut cover.areas, removal, 1.0);
        }
        cover.start();
        cover
    }

    /// Puts the vertices of one round back and lets all of them glide; `false` when none is missing.
    pub fn refine(&mut self) -> bool {
        let Some(round) = self.rounds.pop() else { return false };
        round.into_iter().rev().for_each(|removal| self.restore(removal));
        self.settle();
        true
    }

    /// How many vertices are laid.
    pub fn laid(&self) -> usize {
        self.rings.present().count()
    }

    /// Where each vertex lies; the origin for one that is missing.
    pub fn points(&self) -> &[DVec3] {
        &self.points
    }

    fn start(&mut self) {
        let base = self.rings.present().collect::<Vec<_>>();
        let corners = [(1.0, 1.0, 1.0), (-1.0, 1.0, -1.0), (1.0, -1.0, -1.0), (-1.0, -1.0, 1.0)];
        for (&v, (x, y, z)) in base.iter().zip(corners) {
            self.set(v, DVec3::new(x, y, z).normalize());
        }
        if self.folded() {
            base.iter().for_each(|&v| self.set(v, -self.directions[v as usize]));
        }
        self.settle();
    }

    /// Whether a triangle is turned over.
    fn folded(&self) -> bool {
        let turned = |triangle: [u32; 3]| {
            let [a, b, c] = triangle.map(|v| self.points[v as usize]);
            a.dot(b.cross(c)) <= 0.0
        };
        self.rings.triangles().into_iter().any(turned)
    }

    fn set(&mut self, v: u32, direction: DVec3) {
        self.directions[v as usize] = direction;
        self.points[v as usize] = self.ovoid.point(direction);
    }

    fn restore(&mut self, removal: Removal) {
        share(&mut self.areas, &removal, -1.0);
        let v = removal.vertex;
        self.gains[v as usize] = self.gains[removal.ring[removal.into] as usize];
        let direction = self.kernel(&removal.ring, removal.into);
        self.rings.restore(removal);
        self.set(v, direction);
        self.improve(v);
    }

    /// A direction whose point sees the whole ring counter-clockwise. The ring is a fan from `ring[from]`, so some point
    /// close to that vertex does.
    fn kernel(&self, ring: &[u32], from: usize) -> DVec3 {
        let at = |k: usize| self.points[ring[k % ring.len()] as usize];
        let sides = (0..ring.len()).map(|k| at(k).cross(at(k + 1)).normalize_or_zero()).collect::<Vec<_>>();
        let margin = |direction: DVec3| {
            let point = self.ovoid.point(direction);
            sides.iter().map(|side| side.dot(point)).fold(f64::MAX, f64::min)
        };
        let middle = (0..ring.len()).map(at).sum::<DVec3>() / ring.len() as f64;
        let inward = (sides[from] + sides[(from + ring.len() - 1) % ring.len()]).normalize_or_zero();
        let near = |halvings: i32| at(from) + self.ovoid.radius * 0.5f64.powi(halvings) * inward;
        let candidates = std::iter::once(middle).chain((0..40).map(near)).map(|p| self.ovoid.direction(p));
        candidates.max_by(|&a, &b| margin(a).total_cmp(&margin(b))).unwrap_or(DVec3::Y)
    }

    /// Lets all present vertices glide.
    fn settle(&mut self) {
        let present = self.rings.present().collect::<Vec<_>>();
        self.measure();
        for _ in 0..(MOVES / present.len().max(1)).clamp(SWEEPS[0], SWEEPS[1]) {
            if present.len() < TURNING {
                self.turn(&present);
            }
            present.iter().for_each(|&v| self.improve(v));
        }
    }

    /// One more pass over a finished map.
    pub fn glide(&mut self) {
        (0..self.rest.len() as u32).for_each(|v| self.improve(v));
    }

    /// Finds out what areas the present triangles shall have.
    fn measure(&mut self) {
        let triangles = self.rings.triangles();
        for (gain, (whole, present)) in
            self.gains.iter_mut().zip(self.areas.iter().zip(areas(&self.rest, &triangles)))
        {
            *gain = if present > 0.0 { (whole / present).clamp(MOST_GAIN.recip(), MOST_GAIN) } else { 1.0 };
        }
        let total = |points: &[DVec3]| areas(points, &triangles).iter().sum::<f64>();
        // The squared side of an equilateral triangle is its area times 4/√3.
        let mean = total(&self.rest) / triangles.len() as f64;
        self.padding = FATTENING * mean * 4.0 / 3f64.sqrt();
        self.scale = 1.0;
        let wanted = triangles.iter().map(|&triangle| self.wanted(triangle).0).sum::<f64>();
        self.scale = total(&self.points) / wanted;
    }

    /// The area that a triangle shall have, and the cotangents of its angles.
    fn wanted(&self, [a, b, c]: [u32; 3]) -> (f64, [f64; 3]) {
        let side =
            |p: u32, q: u32| self.rest[p as usize].distance_squared(self.rest[q as usize]) + self.padding;
        let (doubled, cot) = shape([side(b, c), side(c, a), side(a, b)]);
        let gain = [a, b, c].iter().map(|&v| self.gains[v as usize]).sum::<f64>() / 3.0;
        (self.scale * gain * doubled / 2.0, cot)
    }

    /// Turns the whole map so that directions agree best with those of the surface itself. Around an egg, which is no
    /// sphere, this might turn a large triangle over; then everything stays.
    fn turn(&mut self, present: &[u32]) {
        let pairs = present.iter().map(|&v| {
            let wanted = self.rest[v as usize].normalize_or_zero();
            (self.directions[v as usize], wanted)
        });
        let rotation = rotation(pairs);
        let before = present.iter().map(|&v| self.directions[v as usize]).collect::<Vec<_>>();
        for (&v, &direction) in present.iter().zip(&before) {
            self.set(v, (rotation * direction).normalize());
        }
        if self.folded() {
            present.iter().zip(before).for_each(|(&v, direction)| self.set(v, direction));
        }
    }

    /// Moves one vertex downhill in the distortion of its triangles.
    fn improve(&mut self, v: u32) {
        self.gather(v);
        let (direction, point) = (self.directions[v as usize], self.points[v as usize]);
        let energy = distortion(&self.corners, point);
        let (along, across) = direction.any_orthonormal_pair();
        let axes = [along, across].map(|t| self.ovoid.tangent(direction, point, t));
        let reach = self.corners.iter().map(|corner| corner.b.distance(point)).fold(f64::MAX, f64::min);
        let mut step = Expansion::new(&self.corners, point, axes).step(0.5 * reach / self.ovoid.radius);
        for _ in 0..6 {
            let moved = (direction + step.x * along + step.y * across).normalize();
            if distortion(&self.corners, self.ovoid.point(moved)) < energy {
                self.set(v, moved);
                return;
            }
            step *= 0.35;
        }
    }

    /// Collects the triangles about a vertex.
    fn gather(&mut self, v: u32) {
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        let ring = &self.rings.0[v as usize];
        for (k, &b) in ring.iter().enumerate() {
            let c = ring[(k + 1) % ring.len()];
            let (area, cot) = self.wanted([v, b, c]);
            corners.push(Corner { b: self.points[b as usize], c: self.points[c as usize], cot, area });
        }
        self.corners = corners;
    }
}

/// A third of the areas of the triangles about each point.
fn areas(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<f64> {
    let mut areas = vec![0.0; points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| points[v as usize]);
        let third = (b - a).cross(c - a).length() / 6.0;
        triangle.iter().for_each(|&v| areas[v as usize] += third);
    }
    areas
}

/// Gives what a removed vertex stood for to its neighbours, or takes it back with `sign` −1.
fn share(areas: &mut [f64], Removal { vertex, ring, .. }: &Removal, sign: f64) {
    let part = sign * areas[*vertex as usize] / ring.len() as f64;
    ring.iter().for_each(|&r| areas[r as usize] += part);
}
