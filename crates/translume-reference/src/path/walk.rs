//! One path: from the eye into the body, from collision to collision, until it leaves.

use glam::DVec3;

use super::dice::Dice;
use super::lamp::{Aim, Lamp};
use super::volume::Group;
use super::{Crossing, PathTracer, Shape};
use crate::fresnel::{refracted_cos, transmittance};
use crate::rgb::accumulate;

/// Roulette sets in where a path's weight falls below this.
const LIGHT: f64 = 0.3;

/// Mean optical depth towards a light up to which a connection is surely made.
const SURE: f64 = 1.0;

/// How many points towards a light are asked for their distance to the boundary.
const PROBES: u32 = 6;

/// What one path brings.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Harvest {
    pub radiance: [f64; 3],
    /// The part that was scattered once.
    pub single: [f64; 3],
    /// Whether the path met the body.
    pub met: bool,
}

/// A path under way.
struct Walk<'a> {
    tracer: &'a PathTracer<'a>,
    group: &'a Group,
    dice: &'a mut Dice,
    harvest: Harvest,
    /// In each channel; the light that the path will find counts by it.
    weight: [f64; 3],
    scatterings: u32,
    /// Where the last straight line began, and how far along it the path is, with how much of that inside.
    origin: DVec3,
    direction: DVec3,
    travelled: f64,
    inside: f64,
    /// Density with which the last collision chose the direction, 1/sr.
    density: f64,
}

impl PathTracer<'_> {
    /// Follows a path from the eye along a unit direction.
    pub(super) fn follow(&self, group: &Group, eye: DVec3, direction: DVec3, dice: &mut Dice) -> Harvest {
        let mut walk = Walk {
            tracer: self,
            group,
            dice,
            harvest: Harvest::default(),
            weight: group.albedo.map(|albedo| f64::from(u8::from(albedo > 0.0))),
            scatterings: 0,
            origin: eye,
            direction,
            travelled: 0.0,
            inside: 0.0,
            density: 0.0,
        };
        if self.is_matched() {
            walk.collide_ahead();
        } else {
            walk.refract_in();
        }
        walk.harvest
    }
}

impl Walk<'_> {
    /// The first collision on the straight way through an index-matched body. Light that does not collide is not part of the picture,
    /// so the collision is certain and weighs as much as it is probable.
    fn collide_ahead(&mut self) {
        let mut crossings = Vec::new();
        self.tracer.shape.crossings(self.origin, self.direction, &mut |crossing| crossings.push(crossing));
        self.harvest.met = !crossings.is_empty();
        crossings.sort_by(|a, b| a.t.total_cmp(&b.t));
        let segments = segments(&crossings, self.direction);
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
        let Some(crossing) = self.tracer.shape.first(self.origin, self.direction, false) else {
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
            let heaviest = self.weight.into_iter().fold(0.0, f64::max);
            if heaviest < LIGHT {
                if self.dice.roll() * LIGHT >= heaviest {
                    return;
                }
                self.weight = self.weight.map(|weight| weight * LIGHT / heaviest);
            }
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
        loop {
            if is_inside {
                let at = self.at();
                if left < shape.clearance(at) {
                    self.place(self.travelled + left);
                    return true;
                }
                // Rounding can leave a point outside of a sharp edge; such paths, one in billions, end.
                let Some(crossing) = shape.first(at, self.direction, true) else {
                    return false;
                };
                if left <= crossing.t {
                    self.place(self.travelled + left);
                    return true;
                }
                left -= crossing.t;
                self.inside += crossing.t;
                self.travelled += crossing.t;
                is_inside = self.is_kept(&crossing, true);
            } else {
                let crossing = shape.first(self.at(), self.direction, false);
                self.meet_lights(crossing.map_or(f64::INFINITY, |crossing| crossing.t));
                let Some(crossing) = crossing else {
                    return false;
                };
                self.travelled += crossing.t;
                is_inside = !self.is_kept(&crossing, false);
            }
        }
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
        (self.origin, self.travelled, self.inside) = (to, 0.0, 0.0);
    }

    /// Light of some extent on the way ahead outside. Where it was also aimed at, both count by the balance heuristic (Veach and Guibas
    /// 1995), in whose terms a path got here with the density of its direction times the probability not to have collided.
    fn meet_lights(&mut self, free: f64) {
        if self.scatterings == 0 {
            return;
        }
        for lamp in &self.tracer.lamps {
            let ahead = |distance: f64| (self.travelled..=self.travelled + free).contains(&distance);
            let Some(sight) = lamp.sight(self.origin, self.direction).filter(|sight| ahead(sight.distance))
            else {
                continue;
            };
            let own = self.density * (-self.group.sigma_t * self.inside).exp();
            let is_aimed_at = self.tracer.is_matched() && lamp.is_aimed_at();
            self.reap(sight.radiance, if is_aimed_at { own / (own + sight.density) } else { 1.0 });
        }
    }

    /// Straight connections to the lights, as an index-matched boundary bends none.
    fn connect(&mut self) {
        for lamp in self.tracer.lamps.iter().filter(|lamp| lamp.is_aimed_at()) {
            self.connect_to(lamp);
        }
    }

    fn connect_to(&mut self, lamp: &Lamp) {
        let Some(aim) = lamp.aim(self.origin, self.dice) else {
            return;
        };
        let (shape, sigma_t) = (self.tracer.shape, self.group.sigma_t);
        // Most connections have to cross too much of the body to matter. One is made with the probability that light gets through what
        // is surely inside, or rather e times that.
        let patience = SURE + self.dice.exponential();
        let surely = sigma_t * surely_inside(shape, self.origin, &aim, [1.0, patience].map(|x| x / sigma_t));
        if surely > patience {
            return;
        }
        let Some(inside) = inside(shape, self.origin, &aim, lamp) else {
            return;
        };
        let depth = sigma_t * inside - (surely - SURE).max(0.0);
        let phase = self.tracer.volume.phase(self.direction.dot(aim.direction));
        let share = if aim.density.is_finite() {
            let met = phase * (-sigma_t * inside).exp();
            aim.density / (aim.density + met)
        } else {
            1.0
        };
        self.reap(aim.light, share * phase * (-depth).exp());
    }

    fn reap(&mut self, light: [f64; 3], factor: f64) {
        let found = std::array::from_fn(|k| self.weight[k] * light[k]);
        accumulate(&mut self.harvest.radiance, found, factor);
        if self.scatterings == 1 {
            accumulate(&mut self.harvest.single, found, factor);
        }
    }
}

/// Parts of a ray from outside that are inside.
fn segments(crossings: &[Crossing], direction: DVec3) -> Vec<[f64; 2]> {
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
fn inside(shape: &dyn Shape, origin: DVec3, aim: &Aim, lamp: &Lamp) -> Option<f64> {
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
fn surely_inside(shape: &dyn Shape, origin: DVec3, aim: &Aim, [step, enough]: [f64; 2]) -> f64 {
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
