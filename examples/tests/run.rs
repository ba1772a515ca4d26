//! Every example runs, and its picture is what somebody looked at. `TRANSLUME_BLESS=1` writes new pictures; then look at them.

#![allow(clippy::panic, clippy::unwrap_used, reason = "a failure here is a failed test")]
#![allow(clippy::print_stdout, reason = "measured figures, for `--nocapture`")]

use image::{RgbImage, imageops};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Golden pictures are so many times smaller than those of the examples.
const REDUCTION: u32 = 4;
/// Mean absolute difference, of 255: as for the pictures of the GPU tests, where 0.4 is what another rasteriser may do to silhouettes.
const MEAN: f64 = 0.5;

/// What an example says and draws, run in an empty folder.
fn run(name: &str) -> (String, RgbImage) {
    let folder = tempfile::tempdir().unwrap();
    // Tests lie in `deps`, examples beside it.
    let program = std::env::current_exe().unwrap();
    let program = program.ancestors().nth(2).unwrap().join("examples").join(name);
    assert!(
        program.exists(),
        "{} is missing; `cargo build -p translume-examples --examples` makes it",
        program.display()
    );
    let output = Command::new(&program).current_dir(folder.path()).output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(output.status.success(), "{name}: {out}\n{err}");
    let picture = std::fs::read_dir(folder.path().join("out")).unwrap().next().unwrap().unwrap().path();
    (out, image::open(picture).unwrap().to_rgb8())
}

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("golden").join(name).with_extension("png")
}

/// The difference from the golden picture, of 255.
fn difference(name: &str, picture: &RgbImage, bless: bool) -> Result<f64, String> {
    let (width, height) = picture.dimensions();
    let small = imageops::thumbnail(picture, width / REDUCTION, height / REDUCTION);
    let path = golden(name);
    if bless {
        small.save(&path).map_err(|error| error.to_string())?;
    }
    let golden = image::open(&path)
        .map_err(|error| format!("{}: {error}; TRANSLUME_BLESS=1 makes it, then look at it", path.display()))?
        .to_rgb8();
    if golden.dimensions() != small.dimensions() {
        return Err(format!("{} is {:?}", path.display(), golden.dimensions()));
    }
    let total: f64 = small.iter().zip(golden.iter()).map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
    Ok(total / small.len() as f64)
}

#[track_caller]
fn looks_as_before(name: &str, picture: &RgbImage) {
    let bless = std::env::var("TRANSLUME_BLESS").is_ok_and(|value| value == "1");
    let difference = difference(name, picture, bless).unwrap();
    println!("{name}: {difference:.3} of 255");
    assert!(difference <= MEAN, "{name} differs from its golden picture by {difference} of 255");
}

#[test]
fn minimal() {
    looks_as_before("minimal", &run("minimal").1);
}

#[test]
fn own_material() {
    let (said, picture) = run("own_material");
    looks_as_before("own_material", &picture);
    let figure =
        said.rsplit_once("composite: ").unwrap().1.trim().trim_end_matches(" %").parse::<f64>().unwrap();
    println!("{said}");
    // The same sum in the same order, but in another shader.
    assert!(figure <= 0.5, "{said}");
}

#[test]
fn skinned() {
    looks_as_before("skinned", &run("skinned").1);
}

#[test]
fn many_bodies() {
    let (said, picture) = run("many_bodies");
    println!("{said}");
    looks_as_before("many_bodies", &picture);
}

#[test]
fn host_irradiance() {
    looks_as_before("host_irradiance", &run("host_irradiance").1);
}

#[test]
fn a_tenth_more_light_and_a_missing_picture_are_noticed() {
    let path = golden("own_material");
    let small = image::open(&path).unwrap().to_rgb8();
    let (width, height) = small.dimensions();
    let mut large =
        imageops::resize(&small, REDUCTION * width, REDUCTION * height, imageops::FilterType::Nearest);
    assert!(difference("own_material", &large, false).unwrap() <= MEAN);
    // Under the tone curve √L.
    large.iter_mut().for_each(|x| *x = (f64::from(*x) * 1.1_f64.sqrt()).min(255.0) as u8);
    assert!(difference("own_material", &large, false).unwrap() > MEAN);
    assert!(difference("no_such_picture", &large, false).is_err());
}
