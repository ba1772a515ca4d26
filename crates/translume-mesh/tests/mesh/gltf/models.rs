use std::path::PathBuf;

use translume_mesh::load::{Loaded, load};

use super::reference::Reference;
use super::{TOLERANCE, VISIBLE, difference, greatest_difference};

fn model(name: &str) -> Option<(Loaded, Reference)> {
    let path = PathBuf::from(std::env::var_os("TRANSLUME_MODELS")?).join(name);
    Some((load(&path).unwrap(), Reference::from_file(&path)))
}

/// Every animation at 11 times and some keys; then again, with the reference a fifth of a second ahead.
fn check(name: &str, animations: usize) {
    let Some((loaded, reference)) = model(name) else { return };
    let rig = loaded.rig.as_ref().unwrap();
    assert_eq!(rig.animations.len(), animations);
    let greatest = greatest_difference(&loaded, &reference);
    println!("{name}: {greatest:.1e} of the diagonal");
    assert!(greatest < TOLERANCE, "{name}: {greatest:e}");

    for (a, animation) in rig.animations.iter().enumerate() {
        let ahead = (0..5).map(|k| {
            let seconds = (k as f32 + 0.5) / 5.0 * animation.duration;
            let later = rig.pose(Some(animation), seconds + 0.2);
            let posed = translume_mesh::rig::posed(&loaded.mesh, &later).unwrap();
            let expected = reference.vertices(Some(a), f64::from(seconds));
            let far = posed.iter().zip(&expected).flat_map(|(p, e)| (0..3).map(|k| f64::from(p[k]) - e[k]));
            far.fold(0.0, |far: f64, x| far.max(x.abs())) / f64::from(loaded.mesh.diagonal())
        });
        let ahead = ahead.fold(0.0, f64::max);
        assert!(ahead > VISIBLE, "{name}, animation {a}: {ahead:e}");
    }
}

#[test]
fn the_fox_surveys_walks_and_runs() {
    check("Fox.glb", 3);
}

#[test]
fn eight_targets_pulse() {
    check("MorphStressTest.gltf", 3);
}

#[test]
fn the_smallest_skin_bends() {
    check("SimpleSkin.gltf", 1);
}

#[test]
fn real_models_keep_names_coordinates_and_size() {
    let Some((fox, reference)) = model("Fox.glb") else { return };
    let rig = fox.rig.as_ref().unwrap();
    let names: Vec<_> = rig.animations.iter().map(|animation| animation.name.as_str()).collect();
    assert_eq!(names, ["Survey", "Walk", "Run"]);
    assert_eq!((rig.joints.len(), fox.mesh.skin.as_ref().unwrap().joints), (24, 24));
    assert_eq!(fox.mesh.uvs.len(), fox.mesh.triangles.len());
    assert_eq!(fox.material.as_ref().unwrap().name, "fox_material");
    // The fox was bound as it stands.
    assert!(difference(&fox, &reference, None, 0.0) < TOLERANCE);

    let Some((stress, _)) = model("MorphStressTest.gltf") else { return };
    let names: Vec<_> = stress.mesh.targets.iter().map(|target| target.name.as_str()).collect();
    assert_eq!(names, ["Key 1", "Key 2", "Key 3", "Key 4", "Key 5", "Key 6", "Key 7", "Key 8"]);
    assert_eq!(stress.material.unwrap().name, "Base");
}
