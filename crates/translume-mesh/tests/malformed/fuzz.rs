//! Sound files with bytes changed, cut out and cut off: the loader may read or refuse them, and does not panic.

use proptest::prelude::*;
use translume_mesh::load::load;

use crate::harness::with_file;
use crate::{gltf, obj, ply};

fn sound() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("a.obj", format!("vt 0 1\nvn 0 0 1\n{}f 1/1/1 2/-1/-1 3/1 4//1\n", obj::TETRAHEDRON).into_bytes()),
        ("a.ply", ply::TETRAHEDRON.into()),
        ("b.ply", ply::binary("binary_little_endian")),
        ("c.ply", ply::binary("binary_big_endian")),
        ("a.glb", gltf::glb(&gltf::document().to_string(), &gltf::buffer())),
    ]
}

/// A change to bytes; places are shares of their length.
#[derive(Clone, Debug)]
enum Change {
    Flip(f64, u8),
    Set(f64, u8),
    CutOut(f64, usize),
    CutOff(f64),
    Repeat(f64, usize),
}

impl Change {
    fn apply(&self, bytes: &mut Vec<u8>) {
        let length = bytes.len();
        let place = |share: f64| (share * length as f64) as usize;
        let range = |share: f64, count: usize| place(share)..(place(share) + count).min(length);
        let mut change = |share: f64, change: &dyn Fn(u8) -> u8| {
            if let Some(byte) = bytes.get_mut(place(share)) {
                *byte = change(*byte);
            }
        };
        match *self {
            Self::Flip(share, bits) => change(share, &|byte| byte ^ bits),
            Self::Set(share, value) => change(share, &|_| value),
            Self::CutOut(share, count) => drop(bytes.drain(range(share, count))),
            Self::CutOff(share) => bytes.truncate(place(share)),
            Self::Repeat(share, count) => bytes.extend_from_within(range(share, count)),
        }
    }
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let place = || 0.0..1.0;
    let digits = prop::sample::select(b"0123456789-+.e/ \n\"[]{},:\0\xff".to_vec());
    let change = prop_oneof![
        4 => (place(), 1..=u8::MAX).prop_map(|(at, bits)| Change::Flip(at, bits)),
        4 => (place(), digits).prop_map(|(at, value)| Change::Set(at, value)),
        1 => (place(), 1..20_usize).prop_map(|(at, length)| Change::CutOut(at, length)),
        1 => place().prop_map(Change::CutOff),
        1 => (place(), 1..200_usize).prop_map(|(at, length)| Change::Repeat(at, length)),
    ];
    prop::collection::vec(change, 1..4)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(256) })]

    #[test]
    fn no_change_makes_the_loader_panic(changes in changes()) {
        for (name, mut bytes) in sound() {
            changes.iter().for_each(|change| change.apply(&mut bytes));
            with_file(name, &bytes, |path| if let Err(error) = load(path) {
                prop_assert!(error.to_string().contains(name), "{error}");
                Ok(())
            } else {
                Ok(())
            })?;
        }
    }
}

/// The files must be sound, or changes to them would all be refused at the first byte.
#[test]
fn the_files_are_sound_before() {
    for (name, bytes) in sound() {
        with_file(name, &bytes, load).unwrap();
    }
}
