//! Tables of random walks, from `translume profile` to `translume render --profile`.

use crate::desk::{Desk, read_exr, refused, translume};

/// Mean of the picture with a profile.
fn brightness(desk: &Desk, profile: &str) -> f64 {
    let out = desk.path("sphere.exr");
    let name = out.to_str().unwrap();
    let done = translume(&[
        "render",
        "sphere",
        "--medium",
        "marble",
        "--size",
        "48",
        "--atlas",
        "64",
        "--gloss",
        "0",
        "--profile",
        profile,
        "-o",
        name,
    ]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let (_, pixels) = read_exr(&out);
    pixels.iter().flatten().map(|x| f64::from(*x)).sum::<f64>() / pixels.len() as f64
}

#[test]
fn a_table_of_walks_is_made_once_and_renders_as_the_half_space() {
    let desk = Desk::new();
    let folder = desk.path("");
    let make = || {
        translume(&["profile", "--medium", "marble", "--photons", "20000", "-o", folder.to_str().unwrap()])
    };
    let made = make();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let [file] = &desk.files("s2.19")[..] else { panic!("one file: {:?}", desk.files("")) };
    let table = desk.path(file);
    let before = std::fs::read(&table).unwrap();
    let again = make();
    assert!(String::from_utf8_lossy(&again.stderr).contains("is there already"));
    assert_eq!(std::fs::read(&table).unwrap(), before);

    let from_table = brightness(&desk, table.to_str().unwrap());
    let shipped = brightness(&desk, "half-space-diffuse");
    // 20,000 walks know their total to 0.3 %.
    assert!((from_table / shipped - 1.0).abs() < 0.01, "{from_table} {shipped}");
    let dipole = brightness(&desk, "dipole-normalised");
    assert!((dipole / shipped - 1.0).abs() > 0.01, "another profile must be noticed: {dipole} {shipped}");
}

#[test]
fn files_that_are_no_tables_are_named() {
    let desk = Desk::new();
    refused(&desk, &["sphere", "--profile", "/absent/walks.json"], &["walks.json", "cannot be read"]);
    refused(&desk, &["sphere", "--profile", &desk.file("a.json", "{}")], &["a.json", "radii_mm"]);
    let rising = r#"{"radii_mm": [1, 2], "reflectance_per_mm2": [[0.01, 0.01, 0.01], [0.02, 0.02, 0.02]]}"#;
    refused(&desk, &["sphere", "--profile", &desk.file("b.json", rising)], &["b.json", "does not fall"]);
}
