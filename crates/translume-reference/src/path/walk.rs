//! One path: from the eye into the body, from collision to collision, until it leaves.

use glam::DVec3;

use super::emit::Ray;
use super::film::Film;
use super::volume::Group;
use super::way::{Way, crossings, is_lit, segments};
use super::{Crossing, Fan, PathTracer};
use crate::dice::Dice;
use crate::fresnel::{refracted_cos, transmittance};
use crate::lights::Region;

/// Roulette sets in where a path's weight falls below this.
const LIGHT: f64 = 0.3;

/// A free path that meets the boundary more often than this is caught in a corner, where rounding reflects it for ever.
const MOST_CROSSINGS: u32 = 10_000;

/// Steps that take as long as a ray, roughly.
pub(super) const RAY: u64 = 8;

/// What one path brings.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Harvest {
    pub radiance: [f64; 3],
    /// The part that was scattered once.
    pub single: [f64; 3],
    /// Whether the path met the body.
    pub met: bool,
    /// What it took, in steps.
    pub work: u64,
}

/// What a path of light brings to a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Splat {
    pub pixel: usize,
    pub radiance: [f64; 3],
    /// The part that was scattered once.
    pub single: [f64; 3],
}

/// What a path is connected to.
pub(super) enum Goal<'a> {
    Lights,
    Eye { film: &'a Film, region: Option<Region>, found: &'a mut Vec<Splat> },
}

/// A path under way.
pub(super) struct Walk<'a> {
    pub tracer: &'a PathTracer<'a>,
    pub group: &'a Group,
    pub dice: &'a mut Dice,
    pub goal: Goal<'a>,
    pub harvest: Harvest,
    /// In each channel; the light that the path will find counts by it.
    pub weight: [f64; 3],
    /// What the path set out with.
    pub start: [f64; 3],
    pub scatterings: u32,
    /// Where the last straight line began, and how far along it the path is, with how much of that inside.
    pub origin: DVec3,
    pub direction: DVec3,
    pub travelled: f64,
    pub inside: f64,
    /// A lower bound of the distance from there to the boundary, mm.
    pub clearance: f64,
    /// Density with which the last collision chose the direction, 1/sr.
    pub density: f64,
}

impl PathTracer<'_> {
    /// Follows a path from the eye along a unit direction.
    pub(super) fn follow(&self, group: &Group, film: &Film, direction: DVec3, dice: &mut Dice) -> Harvest {
        let ray = Ray { origin: film.eye, direction, power: [1.0; 3] };
        self.walk(group, (&ray, film.fan.as_ref()), dice, Goal::Lights)
    }

    /// Follows light from its source through an index-matched boundary. It is `found` at every collision, in one pixel more than once;
    /// returns what it took.
    pub(super) fn shine(
        &self,
        group: &Group,
        (ray, lamp): (&Ray, usize),
        dice: &mut Dice,
        (film, found): (&Film, &mut Vec<Splat>),
    ) -> u64 {
        let region = self.lamps[lamp].region();
        self.walk(group, (ray, self.fans[lamp].as_ref()), dice, Goal::Eye { film, region, found }).work
    }

    fn walk(
        &self,
        group: &Group,
        (ray, fan): (&Ray, Option<&Fan>),
        dice: &mut Dice,
        goal: Goal<'_>,
    ) -> Harvest {
        let mut walk = Walk {
            tracer: self,
            group,
            dice,
            goal,
            harvest: Harvest::default(),
            weight: group.albedo.map(|albedo| f64::from(u8::from(albedo > 0.0))),
            start: ray.power,
            scatterings: 0,
            origin: ray.origin,
            direction: ray.direction,
            travelled: 0.0,
            inside: 0.0,
            clearance: 0.0,
            density: 0.0,
        };
        if self.is_matched() {
            walk.collide_ahead(fan);
        } else {
            walk.refract_in();
        }
        walk.harvest
    }
}

impl Walk<'_> {
    /// The first collision on the straight way through an index-matched body. Light that does not collide is not part of the picture,
    /// so the collision is certain and weighs as much as it is probable.
    fn collide_ahead(&mut self, fan: Option<&Fan>) {
        let way = Way {
            origin: self.origin,
            direction: self.direction,
            distance: f64::INFINITY,
            clearance: 0.0,
            fan,
        };
        let mut met = Vec::new();
        crossings(self.tracer.shape, &way, &mut |crossing| met.push(crossing));
        self.harvest.met = !met.is_empty();
        self.harvest.work += RAY;
        met.sort_by(|a, b| a.t.total_cmp(&b.t));
        let segments = segments(&met, self.direction);
        if let (Goal::Eye { region, .. }, Some([enter, _])) = (&self.goal, segments.first())
            && !is_lit(*region, self.origin + self.direction * *enter)
        {
            return;
        }
        let length: f64 = segments.iter().map(|[from, to]| to - from).sum();
        let probability = -(-self.group.sigma_t * length).exp_m1();
        if probability <= 0.0 {
            return;
        }
        let mut left = -(-self.dice.roll() * probability).ln_1p() / self.group.sigma_t;
        for [from, to] in segments {
            if left <= to - from {
                self.weight = self.weight.map(|weight| weight * probability);
                self.place(from + left);
                return self.wander();
            }
            left -= to - from;
        }
    }

    /// Through a refracting boundary; what it mirrors is not part of the picture.
    fn refract_in(&mut self) {
        let Some(crossing) = self.tracer.shape.first(self.origin, self.direction, false, f64::INFINITY)
        else {
            return;
        };
        self.harvest.met = true;
        let cos = -crossing.normal.dot(self.direction);
        let enters = transmittance(self.tracer.volume.ior, cos);
        if enters <= 0.0 {
            return;
        }
        self.weight = self.weight.map(|weight| weight * enters);
        self.bend(self.origin + self.direction * crossing.t, crossing.normal, true);
        if self.run_to_collision(true) {
            self.wander();
        }
    }

    /// From a collision on.
    fn wander(&mut self) {
        loop {
            self.weight = std::array::from_fn(|k| self.weight[k] * self.group.albedo[k]);
            self.scatterings += 1;
            self.harvest.work += 1;
            let heaviest = self.weight.into_iter().fold(0.0, f64::max);
            if heaviest < LIGHT {
                if self.dice.roll() * LIGHT >= heaviest {
                    return;
                }
                self.weight = self.weight.map(|weight| weight * LIGHT / heaviest);
            }
            self.clearance = self.tracer.shape.clearance(self.origin);
            if self.tracer.is_matched() {
                self.connect();
            }
            let before = self.direction;
            let after = self.tracer.volume.scatter(before, self.dice);
            self.density = self.tracer.volume.phase(before.dot(after));
            self.direction = after;
            if !self.run_to_collision(true) {
                return;
            }
        }
    }

    /// Straight on until the path collides (`true`) or is lost outside.
    fn run_to_collision(&mut self, mut is_inside: bool) -> bool {
        let mut left = self.dice.exponential() / self.group.sigma_t;
        let shape = self.tracer.shape;
        for _ in 0..MOST_CROSSINGS {
            if is_inside {
                if self.travelled == 0.0 && left < self.clearance {
                    self.place(self.travelled + left);
                    return true;
                }
                self.harvest.work += RAY;
                let Some(crossing) = shape.first(self.at(), self.direction, true, left) else {
                    self.place(self.travelled + left);
                    // Rounding can leave a path outside of a sharp edge, one in billions.
                    return shape.clearance(self.origin) >= 0.0;
                };
                left -= crossing.t;
                self.inside += crossing.t;
                self.travelled += crossing.t;
                is_inside = self.is_kept(&crossing, true);
            } else {
                let crossing = shape.first(self.at(), self.direction, false, f64::INFINITY);
                self.meet_lights(crossing.map_or(f64::INFINITY, |crossing| crossing.t));
                let Some(crossing) = crossing else {
                    return false;
                };
                self.travelled += crossing.t;
                is_inside = !self.is_kept(&crossing, false);
            }
        }
        false
    }

    /// Whether the path stays on its side of the boundary; it bends as it has to.
    fn is_kept(&mut self, crossing: &Crossing, is_inside: bool) -> bool {
        if self.tracer.is_matched() {
            return false;
        }
        let ior = self.tracer.volume.ior;
        let cos = crossing.normal.dot(self.direction).abs();
        let passes = transmittance(if is_inside { 1.0 / ior } else { ior }, cos);
        let is_kept = self.dice.roll() >= passes;
        if is_kept {
            self.turn(
                self.at(),
                self.direction - crossing.normal * (2.0 * crossing.normal.dot(self.direction)),
            );
        } else {
            self.bend(self.at(), crossing.normal, !is_inside);
        }
        is_kept
    }

    /// Snell's law at a point of the boundary, `into` the body or out of it. The radiance's factor of η² is left out: the path ends on the
    /// side where it began.
    fn bend(&mut self, at: DVec3, outwards: DVec3, into: bool) {
        let ior = self.tracer.volume.ior;
        let (eta, normal) = if into { (ior, outwards) } else { (1.0 / ior, -outwards) };
        let cos = -normal.dot(self.direction);
        let along = self.direction + normal * cos;
        self.turn(at, along / eta - normal * refracted_cos(eta, cos));
    }

    fn turn(&mut self, to: DVec3, direction: DVec3) {
        self.place_at(to);
        self.direction = direction.normalize();
    }

    fn at(&self) -> DVec3 {
        self.origin + self.direction * self.travelled
    }

    fn place(&mut self, distance: f64) {
        self.place_at(self.origin + self.direction * distance);
    }

    fn place_at(&mut self, to: DVec3) {
        (self.origin, self.travelled, self.inside, self.clearance) = (to, 0.0, 0.0, 0.0);
    }
}
