//! The walks that `Profile::HalfSpace` of `translume` is made of: rings for both entries and all nodes of its table, as CSV on standard output.
//!
//! `cargo run --release -p translume-reference --example half_space_rings [-- PHOTONS [IOR…]] > rings.csv`, 3,000,000 by default along the
//! normal, a third of them from all sides: some 15 minutes on two cores. The seed of each run is its number.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a command")]

use std::error::Error;
use translume_reference::half_space::{Entry, Setup};

/// Nodes of √(1 − α); the last is as good as no scattering.
const ROOTS: [f64; 14] = [0.0, 0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.9995];
const IORS: [f64; 13] = [0.6, 0.8, 0.9, 1.0, 1.05, 1.1, 1.2, 1.3, 1.4, 1.5, 1.75, 2.0, 2.5];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let photons = arguments.next().map_or(Ok(3_000_000), |text| text.parse())?;
    let chosen = arguments.map(|text| text.parse()).collect::<Result<Vec<f64>, _>>()?;
    let iors = if chosen.is_empty() { &IORS[..] } else { &chosen };
    println!("entry,ior,root,ring,r_out,single,multiple,error,reflected,absorbed,absorbed_error");
    let mut seed = 0;
    for (entry, photons) in [(Entry::Normal, photons), (Entry::Diffuse, photons / 3)] {
        for &ior in iors {
            seed += 1;
            let albedos = ROOTS.map(|root| 1.0 - root * root).to_vec();
            let light = Setup { entry, ior, photons, seed, albedos, ..Setup::default() }.finish();
            for (k, root) in ROOTS.iter().enumerate() {
                let (face, absorbed) = (&light.reflected[k], light.absorbed[k]);
                for (ring, multiple) in face.multiple.rings.iter().enumerate() {
                    let (outer, single) =
                        (light.edges.get(ring).unwrap_or(&f64::INFINITY), face.single.rings[ring]);
                    println!(
                        "{entry:?},{ior},{root},{ring},{outer:.6},{:e},{:e},{:e},{:.6},{:.6},{:.6}",
                        single.value,
                        multiple.value,
                        multiple.error,
                        face.all.total.value,
                        absorbed.value,
                        absorbed.error
                    );
                }
            }
            eprintln!("{entry:?}, η {ior}");
        }
    }
    Ok(())
}
