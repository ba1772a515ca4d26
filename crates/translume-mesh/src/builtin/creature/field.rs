//! Signed distance fields: a body as a smooth union of simple shapes.
//!
//! Distances are approximate away from the surface and right to first order near it, which is all that meshing needs.

use glam::{Mat3, Vec2, Vec3};

/// A shape about its own origin, in its own axes, mm.
#[derive(Clone, Copy)]
pub enum Shape {
    Ellipsoid {
        radii: Vec3,
    },
    /// A ball of radius `ends[0]` at the origin that runs into one of radius `ends[1]` at `to`.
    Limb {
        to: Vec3,
        ends: [f32; 2],
    },
    /// A sheet with a round rim: an egg-shaped outline in the xy plane, `half` wide and high, wider above the origin
    /// than below by the factor 1 ± `taper`, and bent towards +z by `bend` · (x², y²).
    Leaf {
        half: Vec2,
        taper: f32,
        bend: Vec2,
        thickness: f32,
    },
}

/// One shape put in its place.
#[derive(Clone, Copy)]
pub struct Part {
    pub shape: Shape,
    pub at: Vec3,
    /// Turns by these angles (degrees) about x, then y, then z.
    pub turn: Vec3,
    /// Width of the fillet to what is there already, mm.
    pub blend: f32,
    /// Whether a mirror image stands at −x.
    pub paired: bool,
}

/// Distances beyond this many millimetres outside are cut off, so that a sample looks at nearby parts only.
pub const FAR: f32 = 8.0;

/// A smooth body standing on the floor y = 0.
pub struct Field {
    parts: Vec<Placed>,
    /// Rounding of the edge where the body meets the floor, mm.
    floor_blend: f32,
}

struct Placed {
    part: Part,
    to_local: Mat3,
    /// A ball about the part, and the width of its fillet.
    bound: (Vec3, f32),
}

impl Field {
    pub fn new(parts: &[Part], floor_blend: f32) -> Self {
        Self { parts: parts.iter().map(Placed::new).collect(), floor_blend }
    }

    /// Signed distance, mm, negative inside, at most [`FAR`].
    pub fn distance(&self, p: Vec3) -> f32 {
        let mut distance = FAR;
        for placed in &self.parts {
            let blend = placed.part.blend;
            let mut own = placed.distance(p, distance);
            if placed.part.paired {
                own = smooth_min(own, placed.distance(Vec3::new(-p.x, p.y, p.z), distance), blend);
            }
            distance = smooth_min(distance, own, blend);
        }
        -smooth_min(-distance, p.y, self.floor_blend)
    }

    /// Distance and its gradient, from four samples at the corners of a tetrahedron.
    fn distance_and_gradient(&self, p: Vec3) -> (f32, Vec3) {
        // Wide enough that f32 rounding (10⁻⁵ mm) turns the gradient by less than 10⁻³.
        const STEP: f32 = 0.05;
        const CORNERS: [Vec3; 4] = [
            Vec3::new(1.0, -1.0, -1.0),
            Vec3::new(-1.0, -1.0, 1.0),
            Vec3::new(-1.0, 1.0, -1.0),
            Vec3::new(1.0, 1.0, 1.0),
        ];
        let samples = CORNERS.map(|corner| (corner, self.distance(p + STEP * corner)));
        let mean = samples.iter().map(|(_, d)| d / 4.0).sum();
        let gradient = samples.iter().map(|&(corner, d)| corner * (d / (4.0 * STEP))).sum();
        (mean, gradient)
    }

    /// One Newton step to the surface.
    pub fn project(&self, p: Vec3) -> Vec3 {
        let (distance, gradient) = self.distance_and_gradient(p);
        // A slope below 1/2 would be a fold of the field, and the step must not jump across it.
        p - gradient * (distance / gradient.length_squared().max(0.25))
    }
}

impl Placed {
    fn new(part: &Part) -> Self {
        let [x, y, z] = part.turn.to_array().map(f32::to_radians);
        let to_world = Mat3::from_rotation_z(z) * Mat3::from_rotation_y(y) * Mat3::from_rotation_x(x);
        let (center, radius) = part.shape.bound();
        // Ellipsoids understate their distance, so their fillets reach somewhat farther than `blend`.
        let bound = (part.at + to_world * center, radius + 1.5 * part.blend + 1.0);
        Self { part: *part, to_local: to_world.transpose(), bound }
    }

    /// Distance to the shape; any large number where it is too far to matter beside a distance of `limit`.
    fn distance(&self, p: Vec3, limit: f32) -> f32 {
        let (center, radius) = self.bound;
        let reach = (radius + limit).max(0.0);
        if p.distance_squared(center) > reach * reach {
            return 1e3;
        }
        self.part.shape.distance(self.to_local * (p - self.part.at))
    }
}

impl Shape {
    /// Centre and radius of a ball around it.
    fn bound(&self) -> (Vec3, f32) {
        match *self {
            Self::Ellipsoid { radii } => (Vec3::ZERO, radii.max_element()),
            Self::Limb { to, ends } => (to / 2.0, to.length() / 2.0 + ends[0].max(ends[1])),
            Self::Leaf { half, taper, bend, thickness } => {
                let bulge = (bend * half * half).abs().element_sum();
                (Vec3::ZERO, half.y.max(half.x * (1.0 + taper)) + bulge + thickness)
            }
        }
    }

    fn distance(&self, p: Vec3) -> f32 {
        match *self {
            Self::Ellipsoid { radii } => ellipsoid(p, radii),
            Self::Limb { to, ends } => {
                let along = (p.dot(to) / to.length_squared()).clamp(0.0, 1.0);
                p.distance(along * to) - (ends[0] + along * (ends[1] - ends[0]))
            }
            Self::Leaf { half, taper, bend, thickness } => {
                let radius = thickness / 2.0;
                let widened = p.x / (1.0 + taper * (p.y / half.y).clamp(-1.0, 1.0));
                let outline = ellipsoid(Vec3::new(widened, p.y, 0.0), Vec3::new(half.x, half.y, 1.0));
                let slope = 2.0 * bend * p.truncate();
                let height =
                    (p.z - bend.dot(p.truncate() * p.truncate())) / (1.0 + slope.length_squared()).sqrt();
                Vec2::new((outline + radius).max(0.0), height).length() - radius
            }
        }
    }
}

/// First-order distance to an ellipsoid (exact on its axes): k(k − 1) / |∇k²/2| with k = |p / radii|.
fn ellipsoid(p: Vec3, radii: Vec3) -> f32 {
    let scaled = p / radii;
    let k = scaled.length();
    k * (k - 1.0) / (scaled / radii).length().max(1e-6)
}

/// Minimum with a cubic fillet of width `blend` (twice differentiable).
fn smooth_min(a: f32, b: f32, blend: f32) -> f32 {
    let overlap = (blend - (a - b).abs()).max(0.0) / blend;
    a.min(b) - overlap * overlap * overlap * blend / 6.0
}
