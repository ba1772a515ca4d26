//! What must hold of a row, and the figures that say whether it does.

use super::scene::Scene;
use super::way::{Bodies, Column, Glow, Way, ceiling};
use translume_tests::{Check, relative_rmse};

/// Below this no light: the kernel table writes nothing as e^−80 = 2e-35 per mm² and watt.
const DARK: f64 = 1e-20;

/// What must hold beside "finite and not negative" and the bound of energy.
pub enum Demand {
    /// No light leaves.
    Dark,
    /// Red ≤ green ≤ blue everywhere.
    Rising,
    /// Red ≥ green ≥ blue everywhere.
    Falling,
    /// The channels are the same but for this share.
    Alike(f64),
    /// Exitance is that of another scene, which the words tell, but for this relative RMSE.
    Like(&'static str, Box<Scene>, f64),
    /// Exitance over the largest irradiance is so much for a profile of these totals, but for this share, within so many mm of the origin.
    Limit(fn(&Scene, [f64; 3]) -> [f64; 3], f64, f64),
    /// A white body vanishes in a white sky. Only paths know that: the other ways take a ball for flat.
    Vanishing,
    /// The mean over receivers that no light reaches falls from this scene to each of the next.
    Dimmer(Vec<Scene>),
}

/// One measured figure with its bound.
#[derive(Clone, Debug)]
pub struct Figure {
    pub row: &'static str,
    pub demand: &'static str,
    pub way: &'static str,
    pub column: Column,
    pub measured: f64,
    pub bound: f64,
}

impl Figure {
    /// NaN does not hold.
    pub fn check(&self) -> Check {
        if self.measured <= self.bound {
            return Ok(());
        }
        let Self { row, demand, way, measured, bound, .. } = self;
        Err(format!("{row}: {demand} by {way} is {measured:.3e}, but may be {bound:.1e} at most"))
    }
}

/// How many numbers are negative, infinite or none at all.
pub fn unsound(glow: &Glow) -> f64 {
    let values = glow.entering.iter().chain(&glow.leaving).flatten();
    let wrong = values.filter(|x| !(0.0..=1e30).contains(*x)).count();
    if glow.leaving.is_empty() { f64::NAN } else { wrong as f64 }
}

fn most(values: &[[f64; 3]], channel: usize) -> f64 {
    values.iter().map(|value| value[channel]).fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
}

/// Largest exitance over what a total reflectance makes of the largest irradiance on that many faces, less 1.
pub fn excess(glow: &Glow, totals: [f64; 3], faces: f64) -> f64 {
    let of = |k: usize| {
        let allowed = totals[k] * most(&glow.entering, k) * faces;
        let found = most(&glow.leaving, k);
        if allowed > 0.0 { found / allowed - 1.0 } else { found }
    };
    (0..3).map(of).fold(f64::NEG_INFINITY, |a, b| if b > a || b.is_nan() { b } else { a })
}

/// What leaves in all over what a total reflectance makes of all that enters, less 1. `None` where not all texels are known.
pub fn excess_in_all(glow: &Glow, totals: [f64; 3]) -> Option<f64> {
    let sum = |values: &[[f64; 3]], k: usize| {
        values.iter().zip(&glow.areas).map(|(value, area)| value[k] * area).sum::<f64>()
    };
    let of = |k: usize| sum(&glow.leaving, k) / (totals[k] * sum(&glow.entering, k)) - 1.0;
    (!glow.areas.is_empty()).then(|| (0..3).map(of).fold(f64::NAN, f64::max))
}

pub fn brightest(glow: &Glow) -> f64 {
    (0..3).map(|k| most(&glow.leaving, k)).fold(0.0, f64::max)
}

/// The largest share by which a channel lies above the next. What is a millionth of the brightest is rounding.
pub fn against_order(glow: &Glow, order: [usize; 3]) -> f64 {
    let least = 1e-6 * brightest(glow);
    let over = |value: &[f64; 3], low: usize, high: usize| value[low] / value[high].max(least) - 1.0;
    let pairs = [(order[0], order[1]), (order[1], order[2])];
    let each = glow.leaving.iter().flat_map(|value| pairs.map(|(low, high)| over(value, low, high)));
    each.fold(f64::NEG_INFINITY, f64::max)
}

/// The largest share by which green or blue differ from red.
pub fn unlike(glow: &Glow) -> f64 {
    let each = glow.leaving.iter().flat_map(|[r, g, b]| [g / r - 1.0, b / r - 1.0]);
    each.map(f64::abs).fold(0.0, f64::max)
}

/// Relative RMSE of a glow against another.
pub fn apart(glow: &Glow, other: &Glow) -> f64 {
    let alike = glow.leaving.len() == other.leaving.len();
    if alike { relative_rmse(&glow.leaving, &other.leaving) } else { f64::NAN }
}

/// The largest relative difference from what is expected, at places within `reach` mm of the origin.
pub fn off(glow: &Glow, expected: [f64; 3], reach: f64) -> f64 {
    let light = [0, 1, 2].map(|k| most(&glow.entering, k));
    let near = |place: &[f64; 3]| place.iter().map(|x| x * x).sum::<f64>().sqrt() <= reach;
    let inside = (0..glow.leaving.len()).filter(|&i| glow.places.get(i).is_none_or(near));
    let each = inside.flat_map(|i| [0, 1, 2].map(|k| glow.leaving[i][k] / light[k] / expected[k] - 1.0));
    // Nowhere near is as bad as far off.
    each.map(f64::abs).fold(f64::NAN, f64::max)
}

/// Mean exitance where no light enters.
pub fn through(glow: &Glow) -> [f64; 3] {
    let dark: Vec<_> =
        glow.leaving.iter().zip(&glow.entering).filter(|(_, light)| **light == [0.0; 3]).collect();
    [0, 1, 2].map(|k| dark.iter().map(|(value, _)| value[k]).sum::<f64>() / dark.len() as f64)
}

/// The largest share by which a step of a falling sequence rises.
pub fn rise(sequence: &[[f64; 3]]) -> f64 {
    let steps = sequence.windows(2).flat_map(|pair| [0, 1, 2].map(|k| pair[1][k] / pair[0][k] - 1.0));
    steps.fold(f64::NAN, f64::max)
}

impl Demand {
    pub fn name(&self) -> &'static str {
        match self {
            Self::Dark => "no light, W/m²",
            Self::Rising => "grows with albedo",
            Self::Falling => "falls with absorption",
            Self::Alike(_) => "continuous",
            Self::Like(words, ..) => words,
            Self::Limit(..) => "equal to the limit",
            Self::Vanishing => "as bright as the sky",
            Self::Dimmer(_) => "falls with thickness",
        }
    }

    /// Whether the way can say something of it.
    pub fn applies(&self, way: &Way) -> bool {
        match self {
            Self::Vanishing => *way == Way::Paths,
            // The pattern is far off by nature and sees through nothing.
            Self::Limit(..) | Self::Dimmer(_) if way.is_pattern() => false,
            // These know E at texels, but not whether any is where they look.
            Self::Dimmer(_) => matches!(way, Way::Method(..) | Way::Profile(..)),
            _ => true,
        }
    }

    /// The figure and its bound.
    pub fn measure(&self, way: &Way, scene: &Scene, glow: &Glow, bodies: &mut Bodies) -> [f64; 2] {
        // One walk for all channels, whose table interpolates each on its own: measured 1e-4.
        let rounding = 1e-3;
        // Paths of channels that differ are other paths: twice the noise of the mean.
        let noise = if *way == Way::Paths { 0.05 } else { 0.0 };
        // Totals of half-spaces are known to 1.5 %, and the middle of a disc counts: measured 3.9 % in all.
        let peak = if way.is_peaked() { 0.03 } else { 0.0 };
        match self {
            Self::Dark => [brightest(glow), DARK],
            Self::Vanishing => [off(glow, [1.0; 3], 0.0), noise],
            Self::Rising => [against_order(glow, [0, 1, 2]), rounding + noise],
            Self::Falling => [against_order(glow, [2, 1, 0]), rounding + noise],
            Self::Alike(bound) => [unlike(glow), bound + noise],
            Self::Like(_, other, bound) => [apart(glow, &way.glow(other, bodies)), bound + noise],
            Self::Limit(limit, bound, reach) => {
                let expected = limit(scene, ceiling(way, &scene.medium));
                [off(glow, expected, *reach), bound + peak]
            }
            Self::Dimmer(next) => {
                let mut sequence = vec![through(glow)];
                sequence.extend(next.iter().map(|scene| through(&way.glow(scene, bodies))));
                [rise(&sequence), rounding]
            }
        }
    }
}
