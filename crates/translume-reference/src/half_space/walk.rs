//! One walk after the other.

use super::direction::{around, scatter};
use super::tally::Tally;
use super::{Entry, Setup};
use crate::dice::Dice;
use crate::fresnel::transmittance;
use std::f64::consts::TAU;

/// From this order on half of the walks go on, at twice the weight, whenever the order has grown fourfold: as many steps again, spread
/// over an octave of distance more.
const FIRST_ROULETTE: u64 = 64;
/// Nothing goes on beyond; what is on its way still is reported as unfinished. Less than 10⁻⁹ of it is left at albedos below 0.99998.
const LAST_ORDER: u64 = 1 << 20;
/// Walks end where no albedo leaves more than this.
const LEAST_WEIGHT: f64 = 1e-10;

/// A number of walks with the dice of this batch, as means over them.
pub(super) fn batch(setup: &Setup, batch: u64, photons: u64) -> Tally {
    let mut tally = Tally::new(setup);
    let mut dice = Dice::stream(setup.seed, batch);
    let mut weights = vec![0.0; setup.albedos.len()];
    for _ in 0..photons {
        weights.fill(1.0);
        let direction = around([0.0, 0.0, 1.0], entry_cosine(setup, &mut dice), TAU * dice.roll());
        Walk { setup, place: [0.0; 3], direction, order: 0, weights: &mut weights }
            .run(&mut dice, &mut tally);
    }
    tally.divide(photons as f64);
    tally
}

/// Cosine to the inward normal just inside.
fn entry_cosine(setup: &Setup, dice: &mut Dice) -> f64 {
    match setup.entry {
        Entry::Normal => 1.0,
        Entry::Aslant(cosine) => cosine,
        Entry::Cosine => dice.roll().sqrt(),
        // Rejection: the share that enters is what Fresnel's equations let in.
        Entry::Diffuse => loop {
            let outside = dice.roll().sqrt();
            if dice.roll() < transmittance(setup.ior, outside) {
                let sine = (1.0 - outside * outside).max(0.0).sqrt() / setup.ior;
                break (1.0 - sine * sine).max(0.0).sqrt();
            }
        },
    }
}

/// Light on its way. The surface is z = 0, the medium below it at z > 0.
struct Walk<'a> {
    setup: &'a Setup,
    place: [f64; 3],
    direction: [f64; 3],
    order: u64,
    /// One for each albedo.
    weights: &'a mut [f64],
}

impl Walk<'_> {
    fn run(mut self, dice: &mut Dice, tally: &mut Tally) {
        while self.fly(dice, tally) {
            self.order += 1;
            let mut most = 0.0_f64;
            for ((weight, albedo), absorbed) in
                self.weights.iter_mut().zip(&self.setup.albedos).zip(&mut tally.absorbed)
            {
                *absorbed += *weight * (1.0 - albedo);
                *weight *= albedo;
                most = most.max(*weight);
            }
            if most < LEAST_WEIGHT {
                return;
            }
            if self.order == LAST_ORDER {
                tally.give_up(self.weights);
                return;
            }
            if self.is_roulette_due() {
                if dice.roll() < 0.5 {
                    return;
                }
                self.weights.iter_mut().for_each(|weight| *weight *= 2.0);
            }
            self.direction = scatter(dice, self.direction, self.setup.anisotropy);
        }
    }

    fn is_roulette_due(&self) -> bool {
        self.order >= FIRST_ROULETTE
            && self.order.is_power_of_two()
            && (self.order.trailing_zeros() - FIRST_ROULETTE.trailing_zeros()).is_multiple_of(2)
    }

    /// To the next scattering, by way of faces that throw it back. False where it has left.
    fn fly(&mut self, dice: &mut Dice, tally: &mut Tally) -> bool {
        let mut left = dice.exponential();
        loop {
            let down = self.direction[2];
            let below = down > 0.0;
            let way =
                if below { (self.setup.thickness - self.place[2]) / down } else { self.place[2] / -down };
            if !way.is_finite() {
                self.advance(left);
                return true;
            }
            let through = transmittance(1.0 / self.setup.ior, down.abs());
            if through > 0.0 {
                let at = [0, 1].map(|k| self.place[k] + way * self.direction[k]);
                let share = through * (-way).exp();
                tally.leave(below, self.order, at[0].hypot(at[1]), share, self.weights);
            }
            if left < way {
                self.advance(left);
                return true;
            }
            if dice.roll() < through {
                return false;
            }
            self.advance(way);
            self.place[2] = if below { self.setup.thickness } else { 0.0 };
            self.direction[2] = -down;
            left -= way;
        }
    }

    fn advance(&mut self, way: f64) {
        (0..3).for_each(|k| self.place[k] += way * self.direction[k]);
    }
}
