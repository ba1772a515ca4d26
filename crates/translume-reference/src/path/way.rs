//! How much of a straight way is inside a body.

use glam::DVec3;

use super::lamp::{Aim, Lamp};
use super::{Crossing, Shape};

/// How many points towards a light are asked for their distance to the boundary.
const PROBES: u32 = 6;

/// Parts of a ray from outside that are inside.
pub(super) fn segments(crossings: &[Crossing], direction: DVec3) -> Vec<[f64; 2]> {
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

/// How much of the way to a light is inside, mm; `None` where its light does not enter. Every way out counts by its distance, every way
/// in against it, so that the order does not matter.
pub(super) fn inside(shape: &dyn Shape, origin: DVec3, aim: &Aim, lamp: &Lamp) -> Option<f64> {
    let (mut length, mut balance, mut entry) = (0.0, 1, 0.0f64);
    shape.crossings(origin, aim.direction, &mut |crossing| {
        if crossing.t > aim.distance {
            return;
        }
        if crossing.leaves(aim.direction) {
            length += crossing.t;
            balance -= 1;
            entry = entry.max(crossing.t);
        } else {
            length -= crossing.t;
            balance += 1;
        }
    });
    if balance > 0 && aim.distance.is_finite() {
        length += f64::from(balance) * aim.distance;
    }
    let at = origin + aim.direction * entry;
    let is_dark =
        lamp.region().is_some_and(|(low, high)| at.cmplt(low.into()).any() || at.cmpgt(high.into()).any());
    (!is_dark).then_some(length.max(0.0))
}

/// A lower bound of the same, from spheres around points of the way, a `step` apart or more, that the boundary does not reach into; it
/// need not go on beyond `enough`.
pub(super) fn surely_inside(shape: &dyn Shape, origin: DVec3, aim: &Aim, [step, enough]: [f64; 2]) -> f64 {
    let (mut length, mut end, mut t) = (0.0, 0.0, 0.0);
    for _ in 0..PROBES {
        let radius = shape.clearance(origin + aim.direction * t).max(0.0);
        let (from, to) = ((t - radius).max(end), (t + radius).min(aim.distance));
        if to > from {
            length += to - from;
            end = to;
        }
        t = (t + radius).max(end) + step.max(radius);
        if length > enough || t >= aim.distance {
            break;
        }
    }
    length
}

#[cfg(test)]
mod tests {
    use super::super::dice::Dice;
    use super::super::{Ball, Closed};
    use super::*;
    use crate::testing::octasphere;
    use crate::{Light, Surface};

    fn sun(region: Option<([f64; 3], [f64; 3])>) -> Lamp {
        let (to_light, irradiance) = ([0.0, 1.0, 0.0], [1.0; 3]);
        Lamp::new(&Light::Directional { to_light, irradiance, shadow: true, region }).unwrap()
    }

    /// The bound stays below the way inside, and is a good part of it where that is long.
    #[test]
    fn bound_is_a_close_one() {
        let (positions, triangles) = octasphere(5.0, 5);
        let surface = Surface::flat(positions, triangles);
        let mesh = Closed::new(&surface).unwrap();
        let (lamp, mut dice) = (sun(None), Dice::new([1; 4]));
        let (mut bounds, mut lengths) = (0.0, 0.0);
        for _ in 0..2000 {
            let point = DVec3::new(dice.roll(), dice.roll(), dice.roll()) * 10.0 - 5.0;
            if point.length() > 4.9 {
                continue;
            }
            let aim = lamp.aim(point, &mut dice).unwrap();
            let exact = inside(&Ball { center: [0.0; 3], radius: 5.0 }, point, &aim, &lamp).unwrap();
            let length = inside(&mesh, point, &aim, &lamp).unwrap();
            // Facets of level 5 lie within 0.06 % of the radius; along the surface that is more.
            assert!((length - exact).abs() < 0.05, "{length} {exact}");
            let bound = surely_inside(&mesh, point, &aim, [0.5, f64::INFINITY]);
            assert!(bound <= length, "{bound} {length}");
            (bounds, lengths) = (bounds + bound, lengths + length);
        }
        assert!(bounds > 0.6 * lengths, "{bounds} {lengths}");
    }

    #[test]
    fn light_enters_its_region_alone() {
        let ball = Ball { center: [0.0; 3], radius: 5.0 };
        let lamp = sun(Some(([0.0, 0.0, -9.0], [9.0; 3])));
        let way = |x: f64| {
            let point = DVec3::new(x, -1.0, 0.0);
            inside(&ball, point, &lamp.aim(point, &mut Dice::new([0; 4])).unwrap(), &lamp)
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
