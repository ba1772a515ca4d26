//! Every profile against random walks in a half-space: Σ |ring − walk| over what returns.

#![allow(clippy::print_stderr, reason = "measured figures, for `--nocapture`")]

use super::*;
use translume_reference::half_space::{Entry as Way, Setup};

const ALBEDOS: [f64; 5] = [0.5, 0.8, 0.95, 0.99, 0.998];

/// Rings of one medium: inner and outer radius in mean free paths, and the share of light that returns in each.
struct Walks {
    ior: f64,
    albedo: f64,
    rings: Vec<[f64; 3]>,
    /// Of all rings and beyond.
    total: f64,
}

impl Walks {
    fn radial(&self, profile: &Profile) -> Arc<dyn Radial> {
        let medium = Medium {
            sigma_s_prime: [self.albedo as f32; 3],
            sigma_a: [(1.0 - self.albedo) as f32; 3],
            ior: self.ior as f32,
        };
        Arc::clone(&profile.channels(&medium)[0])
    }

    /// Of shape and level, as Christensen and Burley 2015 count it; and of the total.
    fn errors(&self, profile: &Profile) -> [f64; 2] {
        let radial = self.radial(profile);
        let off = self.rings.iter().map(|&[inner, outer, walks]| {
            (radial.scaled_ring(inner, outer) * (-radial.decay() * inner).exp() - walks).abs()
        });
        let all: f64 = self.rings.iter().map(|ring| ring[2]).sum();
        [off.sum::<f64>() / all, radial.total() / self.total - 1.0]
    }
}

/// Our own walks.
fn walks(entry: Way, ior: f64, photons: u64) -> Vec<Walks> {
    let edges = (0..30).map(|k| 0.05 * (f64::from(k) / 3.0).exp2()).collect();
    // No seed of the shipped table.
    let setup = Setup { entry, ior, photons, seed: 4711, albedos: ALBEDOS.to_vec(), edges, ..Setup::default() };
    let light = setup.finish();
    let of = |k: usize| {
        let face = &light.reflected[k].all;
        let inner = |ring: usize| if ring == 0 { 0.0 } else { light.edges[ring - 1] };
        let rings = light.edges.iter().enumerate();
        Walks {
            ior,
            albedo: ALBEDOS[k],
            rings: rings.map(|(ring, &outer)| [inner(ring), outer, face.rings[ring].value]).collect(),
            total: face.total.value,
        }
    };
    (0..ALBEDOS.len()).map(of).collect()
}

/// Somebody else's, where the environment has a folder of them: columns η, α', 0 for the normal or 1 for the cosine inside, radii, 1/mm².
fn published(entry: u32) -> Vec<Walks> {
    let Some(folder) = std::env::var_os("TRANSLUME_REFERENCES") else { return Vec::new() };
    let read = |name: &str| {
        let text = std::fs::read_to_string(std::path::Path::new(&folder).join(name)).unwrap();
        let row = |line: &str| line.split(',').map(|x| x.parse().unwrap()).collect::<Vec<f64>>();
        text.lines().skip(1).map(row).filter(|row| row[2] == f64::from(entry)).collect::<Vec<_>>()
    };
    let profiles = read("halfspace_profiles.csv");
    let of = |total: &Vec<f64>| {
        let same = |row: &&Vec<f64>| row[..2] == total[..2];
        let area = |row: &Vec<f64>| std::f64::consts::PI * (row[4] - row[3]) * (row[4] + row[3]);
        let rings = profiles.iter().filter(same).map(|row| [row[3], row[4], row[5] * area(row)]).collect();
        Walks { ior: total[0], albedo: total[1], rings, total: total[3] }
    };
    read("halfspace_totals.csv").iter().map(of).collect()
}

/// For docs/accuracy.md: every profile against the published walks of both entries, else against our own.
#[test]
#[ignore = "prints a table"]
fn table_of_errors() {
    for (entry, way) in [(0, Way::Normal), (1, Way::Cosine), (2, Way::Diffuse)] {
        let mut all = if entry < 2 { published(entry) } else { Vec::new() };
        if all.is_empty() {
            all = [1.0, 1.3, 1.5].into_iter().flat_map(|ior| walks(way, ior, 1_000_000)).collect();
        }
        for half in [0, 1] {
            eprintln!("\n{way:?}: {} in %, η/α'", ["Σ |ring − walk|", "total"][half]);
            let names = all.iter().map(|walks| format!(" {}/{} |", walks.ior, walks.albedo));
            eprintln!("| profile |{}", names.collect::<String>());
            for (name, profile) in Profile::NAMES.iter().filter(|(_, profile)| !profile.is_oriented()) {
                let cells = all.iter().map(|walks| format!(" {:.1} |", 100.0 * walks.errors(profile)[half]));
                eprintln!("| {name} |{}", cells.collect::<String>());
            }
        }
    }
}
