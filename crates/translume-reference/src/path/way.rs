//! How much of a straight way is inside a body.

use glam::DVec3;

use super::{Crossing, Fan, Shape};
use crate::lights::Region;

/// How many points of a way are asked for their distance to the boundary.
const PROBES: u32 = 6;

/// Parts of a ray from outside that are inside.
pub(crate) fn segments(crossings: &[Crossing], direction: DVec3) -> Vec<[f64; 2]> {
    let mut segments = Vec::new();
    let mut since = None;
    for crossing in crossings {
        match (crossing.leaves(direction), since) {
            (false, None) => since = Some(crossing.t),
            (true, Some(from)) => {
                segments.push([from, crossing.t]);
                since = None;
            }
            _ => {}
        }
    }
    segments
}

/// A straight way from a point of the body to one outside.
#[derive(Clone, Copy)]
pub(super) struct Way<'a> {
    pub origin: DVec3,
    /// Unit vector.
    pub direction: DVec3,
    /// mm; infinite for a light that is a direction.
    pub distance: f64,
    /// A lower bound of the distance from its origin to the boundary, mm.
    pub clearance: f64,
    /// Of the ways to the same point or along the same direction.
    pub fan: Option<&'a Fan>,
}

/// Calls `found` for every crossing of a way and beyond its end, in no order.
pub(super) fn crossings(shape: &dyn Shape, way: &Way<'_>, found: &mut dyn FnMut(Crossing)) {
    match way.fan {
        Some(fan) => shape.crossings_seen(fan, way.origin, way.direction, found),
        None => shape.crossings(way.origin, way.direction, found),
    }
}

/// How much of a way is inside, mm, and how far away the last of it is. Every way out counts by its distance, every way in against it, so
/// that the order does not matter.
pub(super) fn inside(shape: &dyn Shape, way: &Way<'_>) -> [f64; 2] {
    let (mut length, mut balance, mut last) = (0.0, 1, 0.0f64);
    crossings(shape, way, &mut |crossing| {
        if crossing.t > way.distance {
            return;
        }
        if crossing.leaves(way.direction) {
            length += crossing.t;
            balance -= 1;
            last = last.max(crossing.t);
        } else {
            length -= crossing.t;
            balance += 1;
        }
    });
    if balance > 0 && way.distance.is_finite() {
        length += f64::from(balance) * way.distance;
    }
    [length.max(0.0), last]
}

/// A lower bound of the same, from spheres around points of the way, a `step` apart or more, that the boundary does not reach into; it
/// need not go on beyond `enough`.
pub(super) fn surely_inside(shape: &dyn Shape, way: &Way<'_>, [step, enough]: [f64; 2]) -> f64 {
    let (mut length, mut end, mut t) = (0.0, 0.0, 0.0);
    for _ in 0..PROBES {
        let radius = if t > 0.0 { shape.clearance(way.at(t)) } else { way.clearance }.max(0.0);
        let (from, to) = ((t - radius).max(end), (t + radius).min(way.distance));
        if to > from {
            length += to - from;
            end = to;
        }
        t = (t + radius).max(end) + step.max(radius);
        if length > enough || t >= way.distance {
            break;
        }
    }
    length
}

/// Whether light enters at a point.
pub(crate) fn is_lit(region: Option<Region>, at: DVec3) -> bool {
    region.is_none_or(|(low, high)| at.cmpge(low.into()).all() && at.cmple(high.into()).all())
}

impl Way<'_> {
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Ball, Closed};
    use super::*;
    use crate::Surface;
    use crate::dice::Dice;
    use crate::testing::octasphere;

    fn up(origin: DVec3) -> Way<'static> {
        Way { origin, direction: DVec3::Y, distance: f64::INFINITY, clearance: 0.0, fan: None }
    }

    /// The bound stays below the way inside, and is a good part of it where that is long.
    #[test]
    fn bound_is_a_close_one() {
        let (positions, triangles) = octasphere(5.0, 5);
        let surface = Surface::flat(positions, triangles);
        let mesh = Closed::new(&surface).unwrap();
        let mut dice = Dice::new([1; 4]);
        let (mut bounds, mut lengths) = (0.0, 0.0);
        for _ in 0..2000 {
            let point = DVec3::new(dice.roll(), dice.roll(), dice.roll()) * 10.0 - 5.0;
            if point.length() > 4.9 {
                continue;
            }
            let [exact, _] = inside(&Ball { center: [0.0; 3], radius: 5.0 }, &up(point));
            let [length, _] = inside(&mesh, &up(point));
            // Facets of level 5 lie within 0.06 % of the radius; along the surface that is more.
            assert!((length - exact).abs() < 0.05, "{length} {exact}");
            let bound = surely_inside(
                &mesh,
                &Way { clearance: mesh.clearance(point), ..up(point) },
                [0.5, f64::INFINITY],
            );
            assert!(bound <= length, "{bound} {length}");
            (bounds, lengths) = (bounds + bound, lengths + length);
        }
        assert!(bounds > 0.6 * lengths, "{bounds} {lengths}");
    }

    #[test]
    fn light_enters_its_region_alone() {
        let ball = Ball { center: [0.0; 3], radius: 5.0 };
        let region = Some(([0.0, 0.0, -9.0], [9.0; 3]));
        let way = |x: f64| {
            let way = up(DVec3::new(x, -1.0, 0.0));
            let [length, last] = inside(&ball, &way);
            is_lit(region, way.at(last)).then_some(length)
        };
        assert!((way(3.0).unwrap() - 5.0).abs() < 1e-12);
        assert_eq!(way(-3.0), None);
    }

    #[test]
    fn only_what_is_inside_is_a_segment() {
        let at = |t: f64, x: f64| Crossing { t, normal: DVec3::new(x, 0.0, 0.0) };
        let crossings = [at(1.0, -1.0), at(2.0, 1.0), at(4.0, -1.0), at(7.0, 1.0)];
        assert_eq!(segments(&crossings, DVec3::X), [[1.0, 2.0], [4.0, 7.0]]);
        // The first way out has no way in, as inside.
        assert_eq!(segments(&crossings[1..], DVec3::X), [[4.0, 7.0]]);
    }
}
