//! One path: from the eye into the body, from collision to collision, until it leaves.

use glam::DVec3;

use super::emit::Ray;
use super::film::Film;
use super::lamp::Lamp;
use super::volume::Group;
use super::way::{Way, inside, is_lit, segments, surely_inside};
use super::{Crossing, PathTracer};
use crate::dice::Dice;
use crate::fresnel::{refracted_cos, transmittance};
use crate::lights::Region;
use crate::rgb::accumulate;

/// Roulette sets in where a path's weight falls below this.
const LIGHT: f64 = 0.3;

/// A free path that meets the boundary more often than this is caught in a corner, where rounding reflects it for ever.
const MOST_CROSSINGS: u32 = 10_000;

/// Steps that take as long as a ray, roughly.
const RAY: u64 = 8;

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
enum Goal<'a> {
    Lights,
    Eye { film: &'a Film, region: Option<Region>, found: &'a mut Vec<Splat> },
}

/// A path under way.
struct Walk<'a> {
    tracer: &'a PathTracer<'a>,
    group: &'a Group,
    dice: &'a mut Dice,
    goal: Goal<'a>,
    harvest: Harvest,
    /// In each channel; the light that the path will find counts by it.
    weight: [f64; 3],
    /// What the path set out with.
    start: [f64; 3],
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
        let ray = Ray { origin: eye, direction, power: [1.0; 3] };
        self.walk(group, &ray, dice, Goal::Lights)
    }

    /// Follows light from its source through an index-matched boundary. It is `found` at every collision, in one pixel more than once;
    /// returns what it took.
    pub(super) fn shine(
        &self,
        group: &Group,
        (ray, region): (&Ray, Option<Region>),
        dice: &mut Dice,
        (film, found): (&Film, &mut Vec<Splat>),
    ) -> u64 {
        self.walk(group, ray, dice, Goal::Eye { film, region, found }).work
    }

    fn walk(&self, group: &Group, ray: &Ray, dice: &mut Dice, goal: Goal<'_>) -> Harvest {
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
        self.harvest.work += RAY;
        crossings.sort_by(|a, b| a.t.total_cmp(&b.t));
        let segments = segments(&crossings, self.direction);
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
                let at = self.at();
                if left < shape.clearance(at) {
                    self.place(self.travelled + left);
                    return true;
                }
                self.harvest.work += RAY;
                let Some(crossing) = shape.first(at, self.direction, true, left) else {
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
        (self.origin, self.travelled, self.inside) = (to, 0.0, 0.0);
    }

    /// Light of some extent on the way ahead outside. Where it was also aimed at, both count by the balance heuristic (Veach and Guibas
    /// 1995), in whose terms a path got here with the density of its direction times the probability not to have collided.
    fn meet_lights(&mut self, free: f64) {
        if self.scatterings == 0 || matches!(self.goal, Goal::Eye { .. }) {
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

    /// Straight connections, as an index-matched boundary bends none.
    fn connect(&mut self) {
        if matches!(self.goal, Goal::Eye { .. }) {
            return self.connect_to_eye();
        }
        for lamp in self.tracer.lamps.iter().filter(|lamp| lamp.is_aimed_at()) {
            self.connect_to(lamp);
        }
    }

    fn connect_to(&mut self, lamp: &Lamp) {
        let Some(aim) = lamp.aim(self.origin, self.dice) else {
            return;
        };
        let way = Way { origin: self.origin, direction: aim.direction, distance: aim.distance };
        let Some(Passage { inside, last, share }) = self.pass(&way) else {
            return;
        };
        if !is_lit(lamp.region(), way.at(last)) {
            return;
        }
        let phase = self.tracer.volume.phase(self.direction.dot(aim.direction));
        let weight = if aim.density.is_finite() {
            let met = phase * (-self.group.sigma_t * inside).exp();
            aim.density / (aim.density + met)
        } else {
            1.0
        };
        self.reap(aim.light, weight * phase * share);
    }

    fn connect_to_eye(&mut self) {
        let Goal::Eye { film, .. } = &self.goal else {
            return;
        };
        let Some(view) = film.view(self.origin) else {
            return;
        };
        let way = Way { origin: self.origin, direction: view.direction, distance: view.distance };
        let Some(Passage { share, .. }) = self.pass(&way) else {
            return;
        };
        let phase = self.tracer.volume.phase(self.direction.dot(view.direction));
        let radiance = self.found([view.density; 3], phase * share);
        let single = if self.scatterings == 1 { radiance } else { [0.0; 3] };
        if let Goal::Eye { found, .. } = &mut self.goal {
            found.push(Splat { pixel: view.pixel, radiance, single });
        }
    }

    /// What light gets through. Most ways cross too much of the body to matter. One is followed with the probability that light gets through
    /// what is surely inside, and not weakened by that again.
    fn pass(&mut self, way: &Way) -> Option<Passage> {
        let (shape, sigma_t) = (self.tracer.shape, self.group.sigma_t);
        let patience = self.dice.exponential();
        let surely = sigma_t * surely_inside(shape, way, [1.0, patience].map(|x| x / sigma_t));
        if surely > patience {
            return None;
        }
        self.harvest.work += RAY;
        let [inside, last] = inside(shape, way);
        Some(Passage { inside, last, share: (surely - sigma_t * inside).exp() })
    }

    fn reap(&mut self, light: [f64; 3], factor: f64) {
        let found = self.found(light, factor);
        accumulate(&mut self.harvest.radiance, found, 1.0);
        if self.scatterings == 1 {
            accumulate(&mut self.harvest.single, found, 1.0);
        }
    }

    fn found(&self, light: [f64; 3], factor: f64) -> [f64; 3] {
        std::array::from_fn(|k| self.start[k] * self.weight[k] * light[k] * factor)
    }
}

/// A way that was followed.
struct Passage {
    /// How much of it is inside, and how far away the last of it is, mm.
    inside: f64,
    last: f64,
    /// What gets through, over the probability to be followed.
    share: f64,
}
