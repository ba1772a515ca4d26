//! From the rings of `half_space_rings` to the table that `translume` ships.
//!
//! `cargo run --release -p translume-reference --example half_space_table -- rings.csv crates/translume/src/profile/half_space.bin`
//!
//! Little-endian 32-bit floats: how many indices, roots and rings; these themselves, a ring by its middle; then for both entries, every index:
//! ln of light scattered once per ring over e^(−r)/r, then for every root √(1 − α): ln of the rest per ring over that of a source one mean
//! free path deep, and the absorbed share over the root.

use std::collections::BTreeMap;
use std::error::Error;
use translume_reference::half_space::decay_rate;
use translume_reference::profile::{Entry, half_space_albedo};

/// Rings noisier than this are given up, nearer and farther than the surest one: there the ratio to the source keeps its last value.
const NOISIEST: [f64; 2] = [0.15, 0.04];

struct Ring {
    outer: f64,
    single: f64,
    multiple: f64,
    error: f64,
}

/// Rings of one entry, index and root.
#[derive(Default)]
struct Run {
    ior: f64,
    root: f64,
    rings: Vec<Ring>,
    reflected: f64,
    absorbed: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let usage = "give the rings to read and the table to write";
    let (input, output) = (arguments.next().ok_or(usage)?, arguments.next().ok_or(usage)?);
    let [normal, diffuse] = read(&std::fs::read_to_string(input)?)?;
    let iors: Vec<f64> = normal.keys().map(|key| f64::from_bits(key.0)).collect();
    let mut iors = iors;
    iors.dedup();
    let first: Vec<&Run> = normal.values().filter(|run| run.ior == iors[0]).collect();
    let middles = middles(first[0]);
    let mut table: Vec<f64> = vec![iors.len() as f64, first.len() as f64, middles.len() as f64];
    table.extend(&iors);
    table.extend(first.iter().map(|run| run.root));
    table.extend(&middles);
    for (entry, runs) in [(Entry::Normal, normal), (Entry::Diffuse, diffuse)] {
        for ior in &iors {
            let runs: Vec<&Run> = runs.values().filter(|run| run.ior == *ior).collect();
            table.extend(single(runs[runs.len() / 2]));
            let absorbed: Vec<f64> = runs.iter().map(|run| absorbed_over_root(entry, run)).collect();
            for (k, run) in runs.iter().enumerate() {
                table.extend(multiple(run));
                table.push(if run.root == 0.0 { at_no_root(entry, &runs, &absorbed) } else { absorbed[k] });
            }
        }
    }
    let bytes: Vec<u8> = table.iter().flat_map(|x| (*x as f32).to_le_bytes()).collect();
    Ok(std::fs::write(output, bytes)?)
}

type Runs = BTreeMap<(u64, u64), Run>;

/// By entry; sorted by index and root, whose bits sort as they do.
fn read(text: &str) -> Result<[Runs; 2], Box<dyn Error>> {
    let mut all = [Runs::new(), Runs::new()];
    for line in text.lines().skip(1) {
        let mut fields = line.split(',');
        let entry = usize::from(fields.next() == Some("Diffuse"));
        let numbers = fields.map(str::parse).collect::<Result<Vec<f64>, _>>()?;
        let [ior, root, _, outer, single, multiple, error, reflected, absorbed, _] = numbers[..] else {
            return Err(format!("{line}: ten numbers expected").into());
        };
        let run = all[entry].entry((ior.to_bits(), root.to_bits())).or_default();
        (run.ior, run.root, run.reflected, run.absorbed) = (ior, root, reflected, absorbed);
        run.rings.push(Ring { outer, single, multiple, error });
    }
    Ok(all)
}

/// Without the disc in the middle and what is beyond all edges.
fn bounded(run: &Run) -> impl Iterator<Item = (f64, &Ring)> {
    run.rings.windows(2).map(|pair| (pair[0].outer, &pair[1])).filter(|(_, ring)| ring.outer.is_finite())
}

fn middles(run: &Run) -> Vec<f64> {
    bounded(run).map(|(inner, ring)| (inner * ring.outer).sqrt()).collect()
}

fn single(run: &Run) -> Vec<f64> {
    let albedo = 1.0 - run.root * run.root;
    let points = bounded(run).map(|(inner, ring)| {
        let all = std::f64::consts::TAU * ((-inner).exp() - (-ring.outer).exp());
        // As noisy as light scattered more often.
        ((ring.single / albedo / all).ln(), ring.error / ring.multiple)
    });
    smooth(&points.collect::<Vec<_>>())
}

fn multiple(run: &Run) -> Vec<f64> {
    let albedo = 1.0 - run.root * run.root;
    let rate = decay_rate(albedo);
    // ∫ (1 + κd) e^(−κd)/d³ r dr, d² = r² + 1.
    let beyond = |r: f64| (-rate * r.hypot(1.0)).exp() / r.hypot(1.0);
    let points = bounded(run).map(|(inner, ring)| {
        let source = beyond(inner) - beyond(ring.outer);
        ((ring.multiple / (albedo * albedo) / source).ln(), ring.error / ring.multiple)
    });
    smooth(&points.collect::<Vec<_>>())
}

/// A parabola through the neighbours of each ring, near ones and sure ones first. Values with their errors.
fn smooth(points: &[(f64, f64)]) -> Vec<f64> {
    // Up to five mean free paths: what little is left far away may have too few digits to have an error.
    let surest = (0..24).min_by(|&a, &b| points[a].1.total_cmp(&points[b].1)).unwrap_or(0);
    let usable = |k: usize, noisiest: f64| points[k].0.is_finite() && points[k].1 < noisiest;
    let start = (0..surest).rev().find(|&k| !usable(k, NOISIEST[0])).map_or(0, |k| k + 1);
    let end = (surest..points.len()).find(|&k| !usable(k, NOISIEST[1])).unwrap_or(points.len());
    let fit = |at: usize| {
        let mut sums = [0.0; 5];
        let mut right = [0.0; 3];
        for (k, (value, error)) in points.iter().enumerate().take(end).skip(start) {
            let x = k as f64 - at as f64;
            let near = (1.0 - (x / 4.0).powi(2)).max(0.0).powi(2);
            let weight = near / (error * error + 1e-7);
            (0..5).for_each(|n| sums[n] += weight * x.powi(n as i32));
            (0..3).for_each(|n| right[n] += weight * value * x.powi(n as i32));
        }
        constant_of_parabola(&sums, &right)
    };
    (0..points.len()).map(|k| fit(k.clamp(start, end - 1))).collect()
}

/// Cramer's rule.
fn constant_of_parabola(s: &[f64; 5], b: &[f64; 3]) -> f64 {
    let minor = [s[2] * s[4] - s[3] * s[3], s[1] * s[4] - s[2] * s[3], s[1] * s[3] - s[2] * s[2]];
    let whole = s[0] * minor[0] - s[1] * minor[1] + s[2] * minor[2];
    (b[0] * minor[0] - b[1] * minor[1] + b[2] * minor[2]) / whole
}

/// Exact at an index of 1.
fn absorbed_over_root(entry: Entry, run: &Run) -> f64 {
    if run.ior == 1.0 && run.root > 0.0 {
        return (1.0 - half_space_albedo(1.0 - run.root * run.root, entry)) / run.root;
    }
    // Counted where it is little, else what does not come back.
    if run.root < 0.6 { run.absorbed / run.root } else { (1.0 - run.reflected) / run.root }
}

/// Where nothing is absorbed: H at an index of 1, else the parabola through the next three.
fn at_no_root(entry: Entry, runs: &[&Run], absorbed: &[f64]) -> f64 {
    if runs[0].ior == 1.0 {
        return (1.0 - half_space_albedo(1.0 - 1e-10, entry)) / 1e-5;
    }
    let [x, y, z] = [1, 2, 3].map(|k| runs[k].root);
    absorbed[1] * y * z / ((x - y) * (x - z))
        + absorbed[2] * x * z / ((y - x) * (y - z))
        + absorbed[3] * x * y / ((z - x) * (z - y))
}
