//! Boxes around poses that nobody has computed yet: what depth maps and the kernel table have to reach.

use crate::pose::Pose;
use glam::{Mat4, Vec3};
use std::f32::consts::FRAC_PI_2;
use translume_mesh::Mesh;
use translume_mesh::warp::{Axis, Warp};

/// How far the weights of a vertex's influences may be from adding up to 1.
pub(crate) const WEIGHT_SLACK: f32 = 1e-3;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub low: Vec3,
    pub high: Vec3,
}

/// Boxes of a mesh at rest and at each morph target's full weight, model units; one part for each joint that moves a vertex, or
/// one for all of a mesh without a skin.
#[derive(Clone, Debug)]
pub(crate) struct PoseBounds {
    parts: Vec<Part>,
    axis: Axis,
}

#[derive(Clone, Debug)]
struct Part {
    joint: Option<usize>,
    rest: Bounds,
    targets: Vec<Target>,
}

#[derive(Clone, Copy, Debug)]
struct Target {
    moved: Bounds,
    delta: Bounds,
}

impl Bounds {
    const EMPTY: Self = Self { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY };

    pub fn around(points: impl Iterator<Item = Vec3>) -> Self {
        points.fold(Self::EMPTY, |Self { low, high }, p| Self { low: low.min(p), high: high.max(p) })
    }

    fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Of two boxes around the same thing.
    fn intersection(self, other: Self) -> Self {
        let low = self.low.max(other.low);
        // Rounding must not turn a flat box inside out.
        Self { low, high: self.high.min(other.high).max(low) }
    }

    pub fn contains(self, point: Vec3) -> bool {
        self.low.cmple(point).all() && point.cmple(self.high).all()
    }

    fn grown(self, by: f32) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    /// Σ weight · box.
    fn weighted(parts: impl Iterator<Item = (f32, Self)>) -> Self {
        let nothing = Self { low: Vec3::ZERO, high: Vec3::ZERO };
        parts.fold(nothing, |sum, (weight, part)| {
            let (a, b) = (part.low * weight, part.high * weight);
            Self { low: sum.low + a.min(b), high: sum.high + a.max(b) }
        })
    }

    pub fn corners(self) -> [Vec3; 8] {
        std::array::from_fn(|k| {
            let pick = Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32);
            self.low + (self.high - self.low) * pick
        })
    }

    fn transformed(self, matrix: Mat4) -> Self {
        Self::around(self.corners().into_iter().map(|corner| matrix.transform_point3(corner)))
    }
}

impl PoseBounds {
    pub fn new(mesh: &Mesh) -> Self {
        let all = 0..mesh.positions.len();
        let parts = match &mesh.skin {
            None => vec![Part::new(mesh, None, &all)],
            Some(skin) => {
                let mut moved = vec![Vec::new(); skin.joints];
                for (k, influence) in skin.influences.iter().enumerate() {
                    if influence.weight > 0.0 {
                        moved[influence.joint as usize].push(k / skin.per_vertex);
                    }
                }
                let moved = moved.into_iter().enumerate().filter(|(_, vertices)| !vertices.is_empty());
                moved.map(|(joint, vertices)| Part::new(mesh, Some(joint), &vertices.into_iter())).collect()
            }
        };
        Self { parts, axis: Axis::of(mesh) }
    }

    /// The axis of warps that bring none.
    pub fn axis(&self) -> Axis {
        self.axis
    }

    /// A box around the posed mesh, model units. A skinned vertex is a mean of where its joints take it, so the union over the joints
    /// holds it.
    pub fn posed(&self, pose: &Pose) -> Bounds {
        if let Some(adopted) = &pose.adopted {
            return adopted.bounds;
        }
        let inflate = pose.warp.inflate.abs();
        let skinned = self.parts.iter().fold(Bounds::EMPTY, |all, part| {
            let morphed = part.morphed(&pose.weights).grown(inflate);
            all.union(match part.joint {
                None => morphed,
                Some(joint) => {
                    let there = morphed.transformed(Mat4::from_cols_array_2d(&pose.joints[joint]));
                    there.grown(WEIGHT_SLACK * there.low.abs().max(there.high.abs()).max_element())
                }
            })
        });
        warped(skinned, &pose.warp, &pose.warp.axis.unwrap_or(self.axis))
    }
}

impl Part {
    fn new(mesh: &Mesh, joint: Option<usize>, vertices: &(impl Iterator<Item = usize> + Clone)) -> Self {
        let rest = |v: usize| Vec3::from(mesh.positions[v]);
        let targets = mesh.targets.iter().map(|target| {
            let delta = |v: usize| Vec3::from(target.position_deltas[v]);
            Target {
                moved: Bounds::around(vertices.clone().map(|v| rest(v) + delta(v))),
                delta: Bounds::around(vertices.clone().map(delta)),
            }
        });
        Self { joint, rest: Bounds::around(vertices.clone().map(rest)), targets: targets.collect() }
    }

    /// A pose is (1 − Σw)·rest + Σ w·target, and it is rest + Σ w·delta; the same sums of boxes hold it. The first is tight where one
    /// target takes over, the second where many move a little.
    fn morphed(&self, weights: &[f32]) -> Bounds {
        let targets = || weights.iter().copied().zip(&self.targets);
        let rest = |weight| std::iter::once((weight, self.rest));
        let between = rest(1.0 - weights.iter().sum::<f32>()).chain(targets().map(|(w, t)| (w, t.moved)));
        let added = rest(1.0).chain(targets().map(|(w, t)| (w, t.delta)));
        Bounds::weighted(between).intersection(Bounds::weighted(added))
    }
}

/// Around a box after twist and bend. Each moves the points of an edge along circles, so the extremes are at the ends of arcs and
/// where those cross the axes' directions.
fn warped(bounds: Bounds, warp: &Warp, axis: &Axis) -> Bounds {
    bent(twisted(bounds, warp.twist, axis), warp.bend, axis)
}

fn twisted(bounds: Bounds, angle: f32, axis: &Axis) -> Bounds {
    if angle == 0.0 {
        return bounds;
    }
    let range = [bounds.low.y, bounds.high.y].map(|y| angle * fraction(axis, y));
    let corners = bounds.corners().into_iter().filter(|corner| corner.y == bounds.low.y);
    let turned = corners.flat_map(|corner| {
        let aside = corner - Vec3::from(axis.foot);
        // x is greatest where the turn has brought the corner to the x axis, z a quarter turn off.
        let extremes = quarters(range, aside.z.atan2(aside.x)).map(move |turn| rotated(corner, axis, turn));
        range.map(|turn| rotated(corner, axis, turn)).into_iter().chain(extremes)
    });
    let Bounds { low, high } = Bounds::around(turned);
    Bounds { low: low.with_y(bounds.low.y), high: high.with_y(bounds.high.y) }
}

fn bent(bounds: Bounds, angle: f32, axis: &Axis) -> Bounds {
    if angle == 0.0 {
        return bounds;
    }
    let ends = [bounds.low.y, bounds.high.y];
    let range = ends.map(|y| angle * fraction(axis, y));
    let foot = axis.foot[1];
    let inside = quarters(range, 0.0).map(|turn| foot + axis.height * (turn / angle));
    // Where the axis begins and ends an arc goes over into a straight line.
    let joins = [foot, foot + axis.height].into_iter().filter(|y| (bounds.low.y..=bounds.high.y).contains(y));
    let heights = ends.into_iter().chain(joins).chain(inside);
    let edges = heights.flat_map(|y| [bounds.low, bounds.high].map(|corner| corner.with_y(y)));
    Bounds::around(edges.map(|point| axis.bend(angle, point.to_array()).into()))
}

/// Height on the axis, 0 at the foot to 1 at the top.
fn fraction(axis: &Axis, y: f32) -> f32 {
    if axis.height > 0.0 { ((y - axis.foot[1]) / axis.height).clamp(0.0, 1.0) } else { 0.0 }
}

fn rotated(point: Vec3, axis: &Axis, angle: f32) -> Vec3 {
    let foot = Vec3::from(axis.foot);
    foot + glam::Quat::from_rotation_y(angle) * (point - foot)
}

/// Angles that are `first` and whole quarter turns apart, within a range: all, or one full turn's worth of them.
fn quarters([from, to]: [f32; 2], first: f32) -> impl Iterator<Item = f32> {
    let (from, to) = (from.min(to), from.max(to));
    let next = ((from - first) / FRAC_PI_2).ceil();
    (0..4_u8).map(move |k| first + (next + f32::from(k)) * FRAC_PI_2).take_while(move |angle| *angle <= to)
}

#[cfg(test)]
mod tests;
