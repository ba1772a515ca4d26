//! Bodies that paths run through.

use glam::DVec3;

use super::{Fan, Vantage};

/// Where a line crosses the boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Distance from the origin, mm, ≥ 0.
    pub t: f64,
    /// Unit normal of the boundary, outwards.
    pub normal: DVec3,
}

/// A body with a closed boundary that does not cross itself. Directions are of unit length.
pub trait Shape: Sync {
    /// Calls `found` for every crossing of a ray, in no order.
    fn crossings(&self, origin: DVec3, direction: DVec3, found: &mut dyn FnMut(Crossing));

    /// What makes it quick to find the crossings of rays that have a point or a direction in common; `None` where nothing does.
    fn fan(&self, _vantage: Vantage) -> Option<Fan> {
        None
    }

    /// As [`Shape::crossings`], for a ray of the vantage that this body made the fan for.
    fn crossings_seen(&self, _fan: &Fan, origin: DVec3, direction: DVec3, found: &mut dyn FnMut(Crossing)) {
        self.crossings(origin, direction, found);
    }

    /// The first crossing towards the outside (`leaving`) or towards the inside, no further than `within` mm.
    fn first(&self, origin: DVec3, direction: DVec3, leaving: bool, within: f64) -> Option<Crossing>;

    /// A lower bound of the distance to the boundary, mm, where the point is inside; 0 or less elsewhere, and negative only outside.
    fn clearance(&self, point: DVec3) -> f64;

    /// Lowest and highest coordinates, mm.
    fn extent(&self) -> [DVec3; 2];
}

impl Crossing {
    /// Whether the ray goes from the inside to the outside here.
    #[must_use]
    pub fn leaves(&self, direction: DVec3) -> bool {
        self.normal.dot(direction) > 0.0
    }
}

/// A line through a convex body: in and out.
fn choose(both: [Crossing; 2], leaving: bool) -> Option<Crossing> {
    Some(both[usize::from(leaving)]).filter(|crossing| crossing.t >= 0.0)
}

/// Calls `found` for those of both that lie ahead.
fn ahead(both: Option<[Crossing; 2]>, found: &mut dyn FnMut(Crossing)) {
    both.into_iter().flatten().filter(|crossing| crossing.t >= 0.0).for_each(found);
}

/// An exact sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Middle, mm.
    pub center: [f64; 3],
    /// Radius, mm.
    pub radius: f64,
}

impl Ball {
    fn both(&self, origin: DVec3, direction: DVec3) -> Option<[Crossing; 2]> {
        let offset = origin - DVec3::from(self.center);
        let middle = -offset.dot(direction);
        // Distance of the line from the centre without cancellation: Hearn and Baker 2004.
        let square = self.radius * self.radius - (offset + direction * middle).length_squared();
        let half = (square > 0.0).then(|| square.sqrt())?;
        let crossing = |t: f64| Crossing { t, normal: (offset + direction * t) / self.radius };
        Some([crossing(middle - half), crossing(middle + half)])
    }
}

impl Shape for Ball {
    fn crossings(&self, origin: DVec3, direction: DVec3, found: &mut dyn FnMut(Crossing)) {
        ahead(self.both(origin, direction), found);
    }

    fn first(&self, origin: DVec3, direction: DVec3, leaving: bool, within: f64) -> Option<Crossing> {
        choose(self.both(origin, direction)?, leaving).filter(|crossing| crossing.t <= within)
    }

    fn clearance(&self, point: DVec3) -> f64 {
        self.radius - point.distance(self.center.into())
    }

    fn extent(&self) -> [DVec3; 2] {
        [-self.radius, self.radius].map(|offset| DVec3::from(self.center) + offset)
    }
}

/// An exact box, its edges along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Corner of least coordinates, mm.
    pub low: [f64; 3],
    /// Opposite corner, mm.
    pub high: [f64; 3],
}

impl Block {
    fn both(&self, origin: DVec3, direction: DVec3) -> Option<[Crossing; 2]> {
        let mut both = [f64::NEG_INFINITY, f64::INFINITY].map(|t| Crossing { t, normal: DVec3::ZERO });
        for axis in 0..3 {
            let [o, d] = [origin[axis], direction[axis]];
            if d == 0.0 {
                if o < self.low[axis] || o > self.high[axis] {
                    return None;
                }
                continue;
            }
            let (near, far) = if d > 0.0 { (self.low, self.high) } else { (self.high, self.low) };
            let outwards = DVec3::AXES[axis] * d.signum();
            let [enter, leave] = [near, far].map(|side| (side[axis] - o) / d);
            if enter > both[0].t {
                both[0] = Crossing { t: enter, normal: -outwards };
            }
            if leave < both[1].t {
                both[1] = Crossing { t: leave, normal: outwards };
            }
        }
        (both[0].t < both[1].t).then_some(both)
    }
}

impl Shape for Block {
    fn crossings(&self, origin: DVec3, direction: DVec3, found: &mut dyn FnMut(Crossing)) {
        ahead(self.both(origin, direction), found);
    }

    fn first(&self, origin: DVec3, direction: DVec3, leaving: bool, within: f64) -> Option<Crossing> {
        choose(self.both(origin, direction)?, leaving).filter(|crossing| crossing.t <= within)
    }

    fn clearance(&self, point: DVec3) -> f64 {
        (point - DVec3::from(self.low)).min(DVec3::from(self.high) - point).min_element()
    }

    fn extent(&self) -> [DVec3; 2] {
        [self.low.into(), self.high.into()]
    }
}
