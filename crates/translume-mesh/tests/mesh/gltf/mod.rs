//! Rigged glTF against an evaluation that was written from the specification alone.

mod algebra;
mod animation;
mod asset;
mod hierarchy;
mod material;
mod models;
mod morph;
mod reference;
mod refused;
mod skin;
mod uv;

use translume_mesh::load::Loaded;
use translume_mesh::rig;

use asset::Asset;
use reference::Reference;

/// Of the diagonal. Positions, deltas and matrices are stored in `f32`, 6e-8 each, and several are multiplied and added.
const TOLERANCE: f64 = 1e-5;

/// What a difference that someone could see comes to at least, of the diagonal.
const VISIBLE: f64 = 1e-2;

/// The greatest distance between where the rig and the reference put a vertex, of the diagonal at rest.
fn difference(loaded: &Loaded, reference: &Reference, animation: Option<usize>, seconds: f32) -> f64 {
    let rig = loaded.rig.as_ref().expect("a rig");
    let pose = rig.pose(animation.map(|a| &rig.animations[a]), seconds);
    let posed = rig::posed(&loaded.mesh, &pose).unwrap();
    let expected = reference.vertices(animation, f64::from(seconds));
    assert_eq!(posed.len(), expected.len(), "repair must drop nothing here: {}", loaded.repairs);
    let distance =
        |(a, b): (&[f32; 3], &[f64; 3])| (0..3).map(|k| (f64::from(a[k]) - b[k]).powi(2)).sum::<f64>().sqrt();
    let greatest = posed.iter().zip(&expected).map(distance).fold(0.0, f64::max);
    greatest / f64::from(loaded.mesh.diagonal())
}

/// The greatest difference over every animation, from before its first key to after its last, and without one.
fn greatest_difference(loaded: &Loaded, reference: &Reference) -> f64 {
    let rig = loaded.rig.as_ref().expect("a rig");
    assert_eq!(rig.animations.len(), reference.animations());
    let mut greatest = difference(loaded, reference, None, 0.0);
    for (a, animation) in rig.animations.iter().enumerate() {
        let keys = animation.channels.iter().flat_map(|channel| channel.times.iter().copied());
        let between = (-1..=9).map(|k| k as f32 / 8.0 * animation.duration);
        for seconds in between.chain(keys.take(5)) {
            greatest = greatest.max(difference(loaded, reference, Some(a), seconds));
        }
    }
    greatest
}

fn agree(asset: &Asset) -> Loaded {
    let loaded = asset.load().unwrap();
    let difference = greatest_difference(&loaded, &asset.reference());
    assert!(difference < TOLERANCE, "{difference:e}");
    loaded
}

/// The same comparison must notice that the reference was given another file.
fn differ(asset: &Asset, broken: &Asset) {
    let difference = greatest_difference(&asset.load().unwrap(), &broken.reference());
    assert!(difference > VISIBLE, "{difference:e}");
}
