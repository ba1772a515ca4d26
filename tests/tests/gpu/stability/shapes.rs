//! Hard cases of size, place and deformation.

use super::demand::Demand::{Dark, Dimmer, Falling, Like, Limit};
use super::media::scaled;
use super::scene::{SHEET, Scene, USUAL, sun};
use super::{CORNERS, Row, SEAMS, row};
use glam::{Mat4, Vec3};
use translume::{Light, Medium};
use translume_mesh::{MorphTarget, builtin};
use translume_tests::{Model, Pose, sphere_with};

/// The ball with targets that gather it in a point, press it flat and pull it to four times its width.
fn collapsing(weights: [f32; 3]) -> Scene {
    let mut mesh = builtin::sphere([0.0; 3], 50.0, 3);
    let deltas = |f: fn(&[f32; 3]) -> [f32; 3]| mesh.positions.iter().map(f).collect();
    let targets: [(&str, Vec<[f32; 3]>); 3] = [
        ("point", deltas(|p| p.map(|x| -x))),
        ("flat", deltas(|p| [0.0, -p[1], 0.0])),
        ("wide", deltas(|p| [3.0 * p[0], 0.0, 0.0])),
    ];
    mesh.targets = targets
        .map(|(name, position_deltas)| MorphTarget { name: name.to_owned(), position_deltas })
        .to_vec();
    let pose = Pose { weights: weights.to_vec(), ..Pose::rest(3) };
    Scene { model: Model::new(mesh, 32), pose, ..Scene::ball(USUAL).lit(&[sun()]) }
}

/// The same body in another unit: all lengths grow by `factor`, mean free paths too.
fn resized(factor: f32) -> Scene {
    Scene::ball(scaled(USUAL, 1.0 / factor)).lit(&[sun()]).with(|scene| scene.mm_per_unit *= factor)
}

/// Both sheets see the light that entered one of them as if they were it.
fn one(_: &Scene, totals: [f64; 3]) -> [f64; 3] {
    totals
}

/// Both are lit.
fn both(_: &Scene, totals: [f64; 3]) -> [f64; 3] {
    totals.map(|total| 2.0 * total)
}

/// What a convex body has within a ball is no more than that ball's surface 4πr², four times a disc: surfaces of convex bodies grow with
/// inclusion.
const CONVEX: f64 = 4.0;

pub fn rows() -> Vec<Row> {
    // The oriented dipole's sources stand off the surface, so that those of a thin or strongly bent body lie on its other side or beyond.
    let ball = || Scene::ball(USUAL).lit(&[sun()]);
    let unscaled = |factor: f32| ball().with(|scene| scene.mm_per_unit *= factor);
    let stretched = |scale: [f32; 3]| ball().moved(Mat4::from_scale(Vec3::from(scale)));
    // A mean free path of 2 texels; slabs of half of one to eight.
    let thick = Medium { ior: 1.0, ..scaled(USUAL, 0.5) };
    let slab = |mm: f32| Scene::sheets(thick, mm, false);
    // A texel, and absorbing: from the middle the edges are out of sight.
    let short = Medium { sigma_s_prime: [0.8, 0.7, 0.5], sigma_a: [0.2, 0.3, 0.5], ior: 1.0, g: 0.0 };
    let middle = 0.2 * f64::from(SHEET);
    let like = |words, factor| Like(words, Box::new(resized(factor)), 1e-3);
    let small = |lights: &[Light]| {
        let lights = lights.to_vec();
        ball().with(|scene| (scene.model, scene.lights) = (sphere_with(16), lights))
    };
    vec![
        row(
            "10 mm across, and 1 mm or 100 m with the mean free path to scale",
            resized(1.0),
            vec![Falling, like("as 1 mm across", 0.1), like("as 100 m across", 1e4)],
        )
        .excess(SEAMS),
        row("1 mm across", unscaled(0.1), vec![Falling]).unbounded(&["dipole-oriented"]),
        row("100 m across", unscaled(1e4), vec![Falling]).excess(CORNERS).unbounded(&["dipole-oriented"]),
        row("stretched fourfold", stretched([4.0, 1.0, 1.0]).with(|s| s.faces = CONVEX), vec![Falling])
            .unbounded(&["dipole-oriented"]),
        row(
            "stretched fourfold by a target",
            collapsing([0.0, 0.0, 1.0]).with(|s| s.faces = CONVEX),
            vec![Falling],
        )
        .unbounded(&["dipole-oriented"]),
        row("mirrored", stretched([-1.0, 1.0, 1.0]), vec![Falling]).excess(SEAMS),
        row("crushed to 10⁻⁶ of its height", stretched([1.0, 1e-6, 1.0]).with(|s| s.faces = 2.0), vec![]),
        row("crushed flat by a target", collapsing([0.0, 1.0, 0.0]).with(|s| s.faces = 2.0), vec![]),
        row("crushed to a point by a target", collapsing([1.0, 0.0, 0.0]), vec![Dark])
            .without(&["per fragment"]),
        // Few and wide texels, of which most lie on a seam.
        row("atlas of 16²", small(&[sun()]), vec![Falling]).excess(CORNERS).unbounded(&["dipole-oriented"]),
        row("atlas of 16², no light", small(&[]), vec![Dark]),
        row(
            "receivers on top of sources: two lit sheets in one place, twice as bright as one",
            Scene::sheets(short, 0.0, true),
            vec![Limit(both, 0.02, middle)],
        ),
        row(
            "two sheets 0.01 mm apart: each as bright as one alone",
            Scene::sheets(short, 0.01, false),
            vec![Limit(one, 0.02, middle)],
        )
        .unbounded(&["dipole-oriented"]),
        row(
            "slabs of 1, 2, 4, 8, 16 mm: a thicker one transmits less",
            slab(1.0),
            vec![Dimmer([2.0, 4.0, 8.0, 16.0].map(slab).to_vec())],
        )
        .unbounded(&["dipole-oriented"]),
    ]
}
