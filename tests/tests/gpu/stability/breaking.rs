//! What is broken must be noticed by every kind of check.

use super::demand::{
    Demand, Figure, against_order, apart, brightest, excess, excess_in_all, off, rise, through, unlike,
    unsound,
};
use super::scene::{Scene, USUAL, sky};
use super::way::{Column, Glow, Way};
use super::{ROUNDING, SEAMS, judge, row};
use translume::Medium;
use translume_tests::{Check, holds, notices};

fn check(measured: f64, bound: f64) -> Check {
    Figure { row: "broken", demand: "figure", way: "hand", column: Column::Cpu, measured, bound }.check()
}

/// Two receivers of a medium that returns half, a quarter and an eighth.
fn good() -> Glow {
    Glow {
        entering: vec![[1.0; 3]; 2],
        leaving: vec![[0.5, 0.25, 0.125]; 2],
        places: vec![[0.0; 3], [5.0, 0.0, 0.0]],
        areas: vec![1.0; 2],
    }
}

const TOTALS: [f64; 3] = [0.5, 0.25, 0.125];

fn broken(change: impl FnOnce(&mut Glow)) -> Glow {
    let mut glow = good();
    change(&mut glow);
    glow
}

/// What `measure` says of a good glow holds; of each broken one it is noticed.
fn tells(measure: impl Fn(&Glow) -> f64, bound: f64, bad: &[Glow]) {
    holds(check(measure(&good()), bound));
    for glow in bad {
        notices(check(measure(glow), bound));
    }
}

#[test]
fn numbers_that_are_none_are_noticed() {
    let of = |x: f64| [broken(|g| g.leaving[1][2] = x), broken(|g| g.entering[0][0] = x)];
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e-12, 1e31] {
        tells(unsound, 0.0, &of(x));
    }
    tells(unsound, 0.0, &[Glow::default()]);
    notices(check(f64::NAN, f64::INFINITY));
}

#[test]
fn too_much_light_is_noticed() {
    let bright = broken(|g| g.leaving[1][2] *= 1.01);
    let nan = broken(|g| g.leaving[0][0] = f64::NAN);
    tells(|g| excess(g, TOTALS, 1.0), ROUNDING, &[bright.clone(), nan.clone()]);
    tells(|g| excess_in_all(g, TOTALS).unwrap(), ROUNDING, &[bright]);
    // Light from nothing.
    tells(|g| excess(g, TOTALS, 1.0), ROUNDING, &[broken(|g| g.entering = vec![[0.0; 3]; 2])]);
    holds(check(brightest(&broken(|g| g.leaving = vec![[0.0; 3]; 2])), 1e-20));
    notices(check(brightest(&good()), 1e-20));
}

#[test]
fn another_order_is_noticed() {
    tells(|g| against_order(g, [2, 1, 0]), 1e-3, &[broken(|g| g.leaving[1] = [0.5, 0.25, 0.251])]);
    notices(check(against_order(&good(), [0, 1, 2]), 1e-3));
    notices(check(unlike(&good()), 1e-3));
    holds(check(unlike(&broken(|g| g.leaving = vec![[0.2; 3]; 2])), 1e-3));
}

#[test]
fn another_limit_is_noticed() {
    let dim = broken(|g| g.leaving[0][1] *= 0.98);
    tells(|g| off(g, TOTALS, 1.0), 0.01, &[dim.clone(), broken(|g| g.places[0] = [9.0; 3])]);
    // Outside of the reach it may be what it likes.
    holds(check(off(&broken(|g| g.leaving[1][1] *= 0.98), TOTALS, 1.0), 0.01));
    tells(|g| apart(g, &good()), 1e-3, &[dim, broken(|g| g.leaving.truncate(1))]);
}

#[test]
fn a_sequence_that_rises_is_noticed() {
    let falling = [[1.0; 3], [0.5; 3], [0.1; 3]];
    holds(check(rise(&falling), 1e-3));
    notices(check(rise(&[[1.0; 3], [0.5; 3], [0.1, 0.51, 0.1]]), 1e-3));
    notices(check(rise(&falling[..1]), 1e-3));
    // Nothing is in the dark.
    notices(check(through(&good())[0], f64::INFINITY));
}

/// The table as a whole notices what its rows are told wrong.
#[test]
fn a_wrong_row_is_noticed() {
    let ways: Vec<Way> = Way::all().into_iter().filter(|way| way.name() == "dual").collect();
    let ball = || Scene::ball(USUAL);
    let judged = |demand| judge("broken", &[row("wrong", ball(), vec![demand]).excess(SEAMS)], &ways);
    holds(judged(Demand::Falling));
    notices(judged(Demand::Rising));
    notices(judged(Demand::Dark));
    notices(judged(Demand::Alike(0.01)));
    let darker = Scene::ball(Medium { sigma_a: [0.031, 0.2, 0.4], ..USUAL });
    notices(judged(Demand::Like("another medium", Box::new(darker), 1e-3)));
    notices(judged(Demand::Limit(|_, totals| totals, 0.01, 10.0)));
    notices(judge("broken", &[row("wrong", ball(), vec![]).excess(-0.5)], &ways));
    let slabs = [8.0, 4.0].map(|mm| Scene::sheets(USUAL, mm, false));
    let [thick, thin] = slabs;
    notices(judge("broken", &[row("wrong", thick, vec![Demand::Dimmer(vec![thin])])], &ways));
    // Light where it must be dark, and a body without light that claims a limit.
    notices(judge("broken", &[row("wrong", ball().lit(&[sky()]), vec![Demand::Dark])], &ways));
    notices(judge("broken", &[row("wrong", ball().lit(&[]), vec![])], &ways));
}
