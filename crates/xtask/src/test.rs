//! `cargo xtask test` and `bench`: cargo's own, once there is a driver to run on.

use std::time::Instant;

use crate::driver;
use crate::process::{Outcome, cargo, run};

pub fn test(arguments: &[String]) -> Outcome {
    driver::ensure()?;
    let start = Instant::now();
    let outcome = run(cargo(&["test", "--workspace"]).args(arguments));
    println!("Tests took {:.0} s in all, building included.", start.elapsed().as_secs_f64());
    outcome
}

pub fn bench(arguments: &[String]) -> Outcome {
    driver::ensure()?;
    run(cargo(&["bench", "-p", "translume-benches"]).args(arguments))
}
