//! Files that are no mesh, or no sane one: each is refused with an error, soon, and without taking memory that its own length
//! does not justify. Every table has a row per file; the name of a row is the name of the file.
#![cfg(feature = "load")]

#[cfg(test)]
mod fuzz;
#[cfg(test)]
mod gltf;
#[cfg(test)]
mod harness;
#[cfg(test)]
mod obj;
#[cfg(test)]
mod odd;
#[cfg(test)]
mod ply;

#[cfg(test)]
use harness::{Row, alone, refuse_all, the_harness_notices_hunger};

#[test]
fn every_file_is_refused() {
    let rows: Vec<Row> = [obj::rows(), ply::rows(), gltf::rows()].into_iter().flatten().collect();
    let _alone = alone();
    refuse_all(&rows);
    the_harness_notices_hunger();
}
