//! `translume report`: what it writes can be read, and says that the library is right.

use crate::desk::{Desk, check_refusal, translume};
use std::path::Path;

const HEADER: &str = "scene,light,shadow,atlas,rel_rmse,bias,time_ms,adapter";

/// Least and greatest relative error of a light on a ball of 50 mm with texels of 3 mm, and the greatest bias. `None` where only the
/// time counts.
///
/// Lamps: the gather lights the middle of a texel, the reference all of it; measured 0.7 to 7 %, most where a near lamp's light grazes the
/// ball, bias 0.4 % at most. Skies: nothing occludes a ball, so what is left is light above order 2; measured 0.35 %. A sun of 1° that
/// brings a sixth of the light: 3.4 % while nine harmonics hold it, 0.35 % once it is split off. All with room for another adapter.
fn bounds(light: &str) -> Option<[f64; 3]> {
    match light {
        "no light" | "one directional" | "one ambient" | "one sphere" => None,
        "constant sky" | "smooth sky" | "smooth sky, not occluded" | "sun in sky, split" => {
            Some([0.0, 0.007, 0.002])
        }
        "sun in sky, harmonics alone" => Some([0.02, 0.05, 0.006]),
        _ => Some([0.0, 0.12, 0.012]),
    }
}

/// Fields of a line; commas between quotes part nothing.
pub fn fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    for letter in line.chars() {
        match letter {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            _ => fields.last_mut().unwrap().push(letter),
        }
    }
    fields
}

fn check(csv: &str) -> Result<Vec<String>, String> {
    let mut lines = csv.lines();
    if lines.next() != Some(HEADER) {
        return Err(format!("not the header: {csv}"));
    }
    lines.map(|line| check_line(line).ok_or_else(|| format!("out of bounds: {line}"))).collect()
}

/// The light of a line that is as it should be.
fn check_line(line: &str) -> Option<String> {
    let fields = fields(line);
    let [scene, light, shadow, atlas, error, bias, time, adapter] = fields.as_slice() else { return None };
    let time: f64 = time.parse().ok()?;
    let fine = match bounds(light) {
        None => error.is_empty() && bias.is_empty(),
        Some([least, most, bound]) => {
            let (error, bias): (f64, f64) = (error.parse().ok()?, bias.parse().ok()?);
            (least..=most).contains(&error) && bias.abs() <= bound
        }
    };
    // The cost of a light is a difference of two times and may drown in their noise; a frame takes time.
    let fine = fine && time.is_finite() && (light != "no light" || time > 0.0);
    (fine && scene == "sphere" && !shadow.is_empty() && atlas == "64" && !adapter.is_empty())
        .then(|| light.clone())
}

/// A suite as quick as it gets, on a ball with an atlas of 64².
pub fn run_suite(suite: &str, folder: &Path) {
    let folder = folder.to_str().unwrap();
    let output = translume(&["report", "sphere", "--suite", suite, "--quick", "--atlas", "64", "-o", folder]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn gather_agrees_with_rays_on_a_sphere() {
    let desk = Desk::new();
    let folder = desk.path("new/report");
    run_suite("gather", &folder);
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let csv = read("gather.csv");
    let lights = check(&csv).unwrap();
    for light in
        ["no light", "directional", "near point", "spot", "rectangle", "sphere", "constant sky", "16 mixed"]
    {
        assert!(lights.iter().any(|found| found == light), "{light} is missing: {lights:?}");
    }
    let table = read("gather.md");
    let rows = table.lines().filter(|line| line.starts_with("| ") && !line.contains("---")).count();
    assert_eq!(rows, lights.len() + 1, "a line for each row, and a head: {table}");
    let plot = read("gather.svg");
    assert!(plot.starts_with("<svg") && plot.contains("sphere: filter"), "{plot}");

    let line = |light: &str| csv.lines().find(|line| fields(line)[1] == light).unwrap();
    let swapped = csv.replace("sun in sky, split", "sun in sky, harmonics alone");
    assert!(check(&swapped).is_err(), "harmonics that hold a sun would be noticed");
    assert!(check(&csv.replace("bias", "offset")).is_err(), "another header would be noticed");
    let shorter = csv.replace(line("spot"), "sphere,spot,none,64,0.01,0,1.0");
    assert!(check(&shorter).is_err(), "a missing field would be noticed");
    let wrong = csv.replace(line("spot"), "sphere,spot,none,64,0.13,0,1.0,adapter");
    assert!(check(&wrong).is_err(), "a wrong irradiance would be noticed");
}

#[test]
fn reports_that_cannot_be_are_refused_before_the_work() {
    let desk = Desk::new();
    let report = |suite: &str, folder: &str, more: &[&str]| {
        let mut arguments = vec!["report", "-o", folder];
        arguments.extend_from_slice(more);
        arguments.extend(["--suite", suite]);
        translume(&arguments)
    };
    let folder = desk.path("report");
    let folder = folder.to_str().unwrap();
    let blocked = format!("{}/inside", desk.file("letter.txt", "dear report"));
    let cases = [
        (report("scattering", folder, &[]), ["--suite", "scattering", "known are methods, gather, scatter"]),
        (report("gather", &blocked, &[]), ["letter.txt", "cannot hold a report", "directory"]),
        (report("gather", folder, &["absent.obj"]), ["absent.obj", "", ""]),
        (report("gather", folder, &["--atlas", "100000"]), ["--atlas", "100000", "choose at most"]),
    ];
    for (output, words) in cases {
        check_refusal(&desk, &output, &words).unwrap_or_else(|problem| panic!("{words:?}: {problem}"));
    }
    assert!(desk.files("report").len() <= 1 && std::fs::read_dir(folder).unwrap().next().is_none());
}
