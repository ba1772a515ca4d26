//! Sums of texels up the tree.

use glam::DVec3;
use translume::{Cluster, DirectionalLight, Light};
use translume_reference::cluster::{self, Cluster as Twin};
use translume_tests::{
    Check, Fixture, Pose, at_least, at_most, creature, holds, luminous, notices, sphere, sum,
};

fn lit(fixture: &mut Fixture) {
    let sun = Light::Directional(DirectionalLight { to_light: [0.3, 0.7, 0.6], ..Default::default() });
    let pose = Pose { weights: vec![0.2; fixture.model.mesh.targets.len()], ..Pose::rest(0) };
    fixture.run(&pose.frame(&[sun]));
}

fn bodies() -> [Fixture; 2] {
    [creature(), sphere()].map(|model| {
        let mut fixture = Fixture::new(&model, |_| ());
        lit(&mut fixture);
        fixture
    })
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}

/// Length of the weighted mean of the children's normals: below a tenth the direction is mostly cancellation.
fn unanimity(children: &[Twin]) -> f64 {
    let power = |c: &Twin| c.power.iter().sum::<f64>();
    let total: f64 = children.iter().map(power).sum();
    let area: f64 = children.iter().map(|c| c.area).sum();
    let weight = |c: &Twin| match (total > 0.0, area > 0.0) {
        (true, _) => power(c) / total,
        (false, true) => c.area / area,
        _ => 1.0 / children.len() as f64,
    };
    children.iter().map(|c| DVec3::from(c.normal) * weight(c)).sum::<DVec3>().length()
}

/// One level against the twin's, which has the same children. Lengths relative to the body, sums to the level's largest.
fn level(gpu: &[Cluster], twin: &[Twin], below: &[Twin], size: f64) -> Check {
    let strongest = twin.iter().map(|c| c.power[0]).fold(0.0, f64::max);
    let largest = twin.iter().map(|c| c.area).fold(0.0, f64::max);
    let mut worst = [0.0_f64; 6];
    for ((a, b), children) in gpu.iter().zip(twin).zip(below.chunks(4)) {
        let errors = [
            vector(a.centroid).distance(b.centroid.into()) / size,
            (f64::from(a.spread) - b.spread).abs() / size,
            (f64::from(a.radius) - b.radius).abs() / size,
            vector(a.power).distance(b.power.into()) / strongest,
            (f64::from(a.area) - b.area).abs() / largest,
            if unanimity(children) > 0.1 { vector(a.normal).distance(b.normal.into()) } else { 0.0 },
        ];
        for (worst, error) in worst.iter_mut().zip(errors) {
            *worst = worst.max(error);
        }
    }
    let names = ["centroid", "spread", "radius", "power", "area", "normal"];
    // Sums of up to 2,500 f32 in steps of four: six levels of a few roundings each; measured 1.2e-7, normals 1.4e-7.
    names.iter().zip(worst).try_for_each(|(name, error)| at_most(&format!("cluster: {name}"), error, 1e-4))
}

fn tree(fixture: &Fixture, change: impl Fn(&mut Cluster)) -> Check {
    let levels = cluster::levels(&fixture.sources());
    let size = f64::from(fixture.model.mesh.diagonal());
    let mut clusters = fixture.clusters();
    clusters.iter_mut().for_each(change);
    let mut rest = &clusters[..];
    for pair in levels.windows(2) {
        let (here, above) = rest.split_at_checked(pair[1].len()).ok_or("clusters are missing")?;
        level(here, &pair[1], &pair[0], size)?;
        rest = above;
    }
    at_most("cluster: entries too many", rest.len() as f64, 0.0)
}

#[test]
fn every_level_follows_the_twin() {
    for fixture in bodies() {
        holds(tree(&fixture, |_| ()));
        notices(tree(&fixture, |cluster| cluster.power[1] *= 1.001));
        notices(tree(&fixture, |cluster| cluster.spread *= 1.01));
        notices(tree(&fixture, |cluster| cluster.normal[2] += 0.001));
    }
}

fn root_power(fixture: &Fixture, gain: f64) -> Check {
    let sources = fixture.sources();
    let expected = DVec3::from(sum(&luminous(&sources), &sources));
    let root = fixture.clusters().last().copied().ok_or("no cluster")?;
    at_least("cluster: power", expected.length(), 1.0)?;
    // Roundings of f32; measured 3e-8.
    at_most(
        "cluster: power at the root",
        (vector(root.power) * gain).distance(expected) / expected.length(),
        1e-5,
    )
}

#[test]
fn the_root_holds_all_power() {
    for fixture in bodies() {
        holds(root_power(&fixture, 1.0));
        notices(root_power(&fixture, 1.001));
    }
}
