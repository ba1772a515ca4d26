//! Reflectance of a flat half-space, all orders of scattering, from the Monte Carlo of `translume_reference::half_space`.
//!
//! Light scattered once has a closed form along the normal. The rest is a table over r, √(1 − α') and η of the ratio to a source one
//! mean free path deep with the true rate of decay, which hardly varies: it is near constant far away and grows like −ln r at 0.

use super::beam;
use super::channel::Channel;
use super::radial::Radial;
use super::sampled::{RANGE, Sampled, Shape};
use std::f64::consts::{LN_2, TAU};
use std::sync::LazyLock;

/// How light goes on when it has just entered.
///
/// ```
/// use translume::{Entry, Profile};
///
/// assert_eq!(Profile::default(), Profile::HalfSpace(Entry::Normal));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Entry {
    /// Along the normal. What enters aslant wanders as far, and more of it returns: the gather knows the angle of each light and multiplies with
    /// a gain ([`Profile::slant`](crate::Profile::slant)).
    #[default]
    Normal,
    /// As the same radiance from all sides enters, whatever the lights. A little closer than [`Normal`](Self::Normal) where hardly anything absorbs
    /// and a sky is all the light there is: less of it wanders far, which a total does not tell.
    Diffuse,
}

/// R_d with all orders of scattering.
pub(crate) fn half_space(channel: &Channel, entry: Entry) -> Sampled {
    let extinction = channel.extinction();
    let slice = TABLE.slice(channel, entry);
    let shape = Shape {
        decay: slice.rate * extinction,
        // 1/r of light scattered once has no core.
        smooth_length: 0.0,
        range: RANGE.map(|x| x / extinction),
    };
    let single = |r: f64| match entry {
        Entry::Normal => beam::scaled_single(channel, shape.decay, r),
        Entry::Diffuse => channel.albedo() * slice.scaled_single(r * extinction) * extinction * extinction,
    };
    let weight = (channel.albedo() * extinction).powi(2);
    let multiple = |r: f64| weight * slice.scaled_multiple(r * extinction);
    let plain = Sampled::new(&shape, |r| single(r) + multiple(r));
    let gain = slice.gain(plain.total(), &Sampled::new(&shape, multiple));
    Sampled::new(&shape, |r| single(r) + gain * multiple(r))
}

static TABLE: LazyLock<Table> = LazyLock::new(|| Table::parse(include_bytes!("half_space.bin")));

/// As the example `half_space_table` of `translume-reference` writes it.
struct Table {
    iors: Vec<f64>,
    /// √(1 − α').
    roots: Vec<f64>,
    /// Middle of the first ring, mean free paths; the others follow at `STEP`.
    first: f64,
    rings: usize,
    /// For each entry and index a row of light scattered once, then for each root a row of the rest and a share.
    values: Vec<f64>,
}

/// Of ln r between rings.
const STEP: f64 = LN_2 / 3.0;

impl Table {
    fn parse(bytes: &[u8]) -> Self {
        let (words, _) = bytes.as_chunks::<4>();
        let mut numbers = words.iter().map(|word| f64::from(f32::from_le_bytes(*word)));
        let [iors, roots, rings] = [(); 3].map(|()| numbers.next().unwrap_or(0.0) as usize);
        let mut take = |count: usize| numbers.by_ref().take(count).collect::<Vec<_>>();
        let (iors, roots, middles) = (take(iors), take(roots), take(rings));
        Self { iors, roots, first: middles.first().copied().unwrap_or(1.0), rings, values: numbers.collect() }
    }

    /// Everything about one medium. Beyond the first and last index the table goes on as there.
    fn slice(&self, channel: &Channel, entry: Entry) -> Slice {
        let root = (channel.absorption / channel.extinction()).sqrt();
        let across = Stencil::new(&self.roots, root);
        // What reflects all of some directions behaves differently from what does not: no curve goes through an index of 1.
        let matched = self.iors.partition_point(|&ior| ior < 1.0);
        let side = if channel.ior < 1.0 { 0..matched + 1 } else { matched..self.iors.len() };
        let indices = Stencil::new(&self.iors[side.clone()], channel.ior);
        let mut slice = Slice {
            rate: decay_rate(channel),
            root,
            first: self.first.ln(),
            single: vec![0.0; self.rings],
            multiple: vec![0.0; self.rings],
            absorbed_over_root: 0.0,
        };
        let per_index = self.rings + self.roots.len() * (self.rings + 1);
        for (index, of_index) in indices.terms(side.start) {
            let index = index + if entry == Entry::Diffuse { self.iors.len() } else { 0 };
            let block = &self.values[index * per_index..(index + 1) * per_index];
            let (single, rest) = block.split_at(self.rings);
            add(&mut slice.single, of_index, single);
            for (root, of_root) in across.terms(0) {
                let row = &rest[root * (self.rings + 1)..];
                add(&mut slice.multiple, of_index * of_root, &row[..self.rings]);
                slice.absorbed_over_root += of_index * of_root * row[self.rings];
            }
        }
        slice
    }
}

fn add(sums: &mut [f64], weight: f64, values: &[f64]) {
    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
}

/// Lagrange's cubic through the four nodes around a place, at the ends through the last four.
struct Stencil {
    first: usize,
    weights: [f64; 4],
}

impl Stencil {
    /// `nodes`: four at least, ascending.
    fn new(nodes: &[f64], at: f64) -> Self {
        let at = at.clamp(nodes[0], nodes[nodes.len() - 1]);
        let first = nodes.partition_point(|&node| node <= at).clamp(2, nodes.len() - 2) - 2;
        let four = &nodes[first..first + 4];
        let weight = |k: usize| {
            let others = (0..4).filter(|&m| m != k);
            others.map(|m| (at - four[m]) / (four[k] - four[m])).product()
        };
        Self { first, weights: std::array::from_fn(weight) }
    }

    fn terms(&self, offset: usize) -> impl Iterator<Item = (usize, f64)> {
        self.weights.iter().enumerate().map(move |(k, &weight)| (offset + self.first + k, weight))
    }
}

/// What the table knows of one medium, lengths in mean free paths.
struct Slice {
    /// κ.
    rate: f64,
    /// √(1 − α').
    root: f64,
    /// ln of the first ring's middle.
    first: f64,
    single: Vec<f64>,
    multiple: Vec<f64>,
    absorbed_over_root: f64,
}

impl Slice {
    /// e^(κr) times light scattered once, over α'.
    fn scaled_single(&self, r: f64) -> f64 {
        let (logarithm, _) = self.at(&self.single, r);
        (logarithm - (1.0 - self.rate) * r).exp() / r
    }

    /// e^(κr) times light scattered more than once, over α'².
    fn scaled_multiple(&self, r: f64) -> f64 {
        let d = r.hypot(1.0);
        let source = (1.0 + self.rate * d) * (-self.rate / (d + r)).exp() / d.powi(3);
        let (logarithm, below) = self.at(&self.multiple, r);
        // Towards 0 it grows like the logarithm that the first rings show.
        let slope = (self.multiple[0] - self.multiple[3]) / (3.0 * STEP);
        logarithm.exp() * (1.0 + slope.max(0.0) * below) * source / TAU
    }

    /// Cubic through the rings, constant outside; and by how much ln r is below the first.
    fn at(&self, values: &[f64], r: f64) -> (f64, f64) {
        let last = values.len() - 1;
        let place = (r.ln() - self.first) / STEP;
        let inside = place.clamp(0.0, last as f64);
        let k = (inside as usize).min(last - 1);
        let t = inside - k as f64;
        let [before, from, to, after] = [k.saturating_sub(1), k, k + 1, (k + 2).min(last)].map(|k| values[k]);
        // Catmull and Rom's.
        let (slope, next, rise) = (0.5 * (to - before), 0.5 * (after - from), to - from);
        let value =
            from + t * (slope + t * (3.0 * rise - 2.0 * slope - next + t * (slope + next - 2.0 * rise)));
        (value, (inside - place).max(0.0) * STEP)
    }

    /// What light scattered more than once is multiplied with so that all returns what the walks returned: 1 exactly where nothing is
    /// absorbed. Where much is, what returns is too little for the absorbed share to tell it, and rings are as good.
    fn gain(&self, plain: f64, multiple: &Sampled) -> f64 {
        let expected = 1.0 - self.root * self.absorbed_over_root;
        let sure = ((0.8 - self.root) / 0.2).clamp(0.0, 1.0);
        1.0 + sure * (expected - plain) / multiple.total()
    }
}

/// κ of e^(−κr): the root of α'·artanh(κ) = κ (Case, Zweifel 1967). √(3(1 − α')) of diffusion where next to nothing is absorbed.
fn decay_rate(channel: &Channel) -> f64 {
    let lost = channel.absorption / channel.extinction();
    if lost < 1e-6 {
        return (3.0 * lost).sqrt();
    }
    // With κ = tanh y, (1 − lost)·y = tanh y.
    let (mut below, mut above) = (0.0, 1.0 / (1.0 - lost).max(1e-9));
    for _ in 0..60 {
        let y = 0.5 * (below + above);
        if (1.0 - lost) * y < f64::tanh(y) { below = y } else { above = y }
    }
    f64::tanh(below)
}
