//! A path's light: straight ways from its collisions to lights and to the eye, and lights that it runs into.

use super::Fan;
use super::lamp::Lamp;
use super::walk::{Goal, RAY, Splat, Walk};
use super::way::{Way, inside, is_lit, surely_inside};
use crate::rgb::accumulate;

/// A way that was followed.
struct Passage {
    /// How much of it is inside, and how far away the last of it is, mm.
    inside: f64,
    last: f64,
    /// What gets through, over the probability to be followed.
    share: f64,
}

impl Walk<'_> {
    /// Light of some extent on the way ahead outside. Where it was also aimed at, both count by the balance heuristic (Veach and Guibas
    /// 1995), in whose terms a path got here with the density of its direction times the probability not to have collided.
    pub fn meet_lights(&mut self, free: f64) {
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
    pub fn connect(&mut self) {
        if matches!(self.goal, Goal::Eye { .. }) {
            return self.connect_to_eye();
        }
        let tracer = self.tracer;
        for (lamp, fan) in tracer.lamps.iter().zip(&tracer.fans).filter(|(lamp, _)| lamp.is_aimed_at()) {
            self.connect_to(lamp, fan.as_ref());
        }
    }

    fn connect_to(&mut self, lamp: &Lamp, fan: Option<&Fan>) {
        let Some(aim) = lamp.aim(self.origin, self.dice) else {
            return;
        };
        let clearance = self.clearance;
        let way =
            Way { origin: self.origin, direction: aim.direction, distance: aim.distance, clearance, fan };
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
        let Goal::Eye { film, .. } = self.goal else {
            return;
        };
        let Some(view) = film.view(self.origin) else {
            return;
        };
        let (clearance, fan) = (self.clearance, film.fan.as_ref());
        let way =
            Way { origin: self.origin, direction: view.direction, distance: view.distance, clearance, fan };
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
    fn pass(&mut self, way: &Way<'_>) -> Option<Passage> {
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
