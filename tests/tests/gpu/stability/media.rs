//! Hard cases of the medium.

use super::demand::Demand::{Alike, Dark, Falling, Like, Limit, Rising, Vanishing};
use super::scene::{CELLS, Scene, USUAL};
use super::{CORNERS, Row, SEAMS, row};
use translume::Medium;
use translume_tests::dipoles;

/// Coefficients times a factor.
pub fn scaled(medium: Medium, factor: f32) -> Medium {
    let by = |x: [f32; 3]| x.map(|x| x * factor);
    Medium { sigma_s_prime: by(medium.sigma_s_prime), sigma_a: by(medium.sigma_a), ..medium }
}

fn absorbing(sigma_a: [f32; 3]) -> Medium {
    Medium { sigma_s_prime: [1.0; 3], sigma_a, ior: 1.3, g: 0.0 }
}

/// These albedos, with a mean free path of 1 mm.
fn white(albedo: [f32; 3], ior: f32) -> Medium {
    Medium { sigma_s_prime: albedo, sigma_a: albedo.map(|a| 1.0 - a), ior, g: 0.0 }
}

fn index(ior: f32) -> Medium {
    Medium { ior, ..USUAL }
}

/// Every source is as good as at the receiver itself: B → power · R_d(0).
fn all_at_once(scene: &Scene, _: [f64; 3]) -> [f64; 3] {
    let area: f64 = scene.model.atlas.texels.iter().map(|texel| f64::from(texel.area)).sum();
    let area = area * f64::from(scene.mm_per_unit).powi(2);
    dipoles(&scene.medium).map(|dipole| dipole.reflectance(0.0) * area)
}

/// Light leaves where it came in: B → E · total reflectance.
fn on_the_spot(_: &Scene, totals: [f64; 3]) -> [f64; 3] {
    totals
}

/// Profiles without bound at r = 0, whose constant for large mean free paths is another.
const PEAKED: &[&str] = &[
    "half-space",
    "half-space-diffuse",
    "dipole-single",
    "better-dipole",
    "better-dipole-single",
    "photon-beam",
    "photon-beam-single",
    "normalised-diffusion",
    "normalised-diffusion-searchlight",
    "pattern",
];

pub fn rows() -> Vec<Row> {
    // The oriented dipole's depths of 1/1000 texel or 1000 texels lie outside of its table: it is black or too bright there. On bodies that
    // are not many mean free paths thick, what it mirrors lands on the other side.
    // Points are right only where light wanders further than a texel is wide.
    let matched = |medium: Medium| Medium { ior: 1.0, ..medium };
    let like = |words, ior| Like(words, Box::new(Scene::ball(index(ior))), 0.01);
    let middle = 0.1 * f64::from(CELLS);
    vec![
        row("as usual", Scene::ball(USUAL), vec![Falling]).excess(SEAMS),
        row("σ_a = 0, 10⁻¹², 10⁻⁹ σ_s'", Scene::ball(absorbing([0.0, 1e-12, 1e-9])), vec![Alike(1e-3)])
            .excess(SEAMS),
        row("σ_a = 0, 0.1, 1 σ_s'", Scene::ball(absorbing([0.0, 0.1, 1.0])), vec![Falling])
            .excess(0.35)
            .unbounded(&["dipole-oriented"]),
        row("σ_s' = 0", Scene::ball(Medium { sigma_s_prime: [0.0; 3], ..USUAL }), vec![Dark]),
        row(
            "σ_s' = σ_a = 0",
            Scene::ball(Medium { sigma_s_prime: [0.0; 3], sigma_a: [0.0; 3], ior: 1.3, g: 0.0 }),
            vec![Dark],
        ),
        row("α' = 0.1, 0.5, 0.9", Scene::ball(white([0.1, 0.5, 0.9], 1.3)), vec![Rising]).excess(SEAMS),
        row("α' = 0.99, 0.9999, 1", Scene::ball(white([0.99, 0.9999, 1.0], 1.3)), vec![Rising]).excess(SEAMS),
        row("σ_a = 0, η = 1", Scene::ball(matched(absorbing([0.0; 3]))), vec![Alike(1e-6), Vanishing])
            .excess(SEAMS),
        // The dipole's fitted F_dr misses 0 at 1 by 0.0016.
        row(
            "η = 1",
            Scene::ball(index(1.0)),
            vec![Falling, like("as η = 1 + 10⁻⁴", 1.0001), like("as η = 1 − 10⁻⁴", 0.9999)],
        )
        .excess(SEAMS),
        row("η = 0.8", Scene::ball(index(0.8)), vec![Falling]).excess(SEAMS),
        row("η = 0.5", Scene::ball(index(0.5)), vec![Falling]).excess(SEAMS),
        row("η = 2.4", Scene::ball(index(2.4)), vec![Falling]).excess(SEAMS),
        row(
            "mean free path 1/1000 texel, flat",
            Scene::plane(matched(scaled(USUAL, 1e3))),
            vec![Limit(on_the_spot, 0.01, middle)],
        )
        .unbounded(&["dipole-oriented", "per vertex", "per fragment"]),
        row(
            "mean free path 1000 texels, flat",
            Scene::plane(matched(scaled(USUAL, 1e-3))),
            vec![Limit(all_at_once, 0.01, middle)],
        )
        .without(PEAKED)
        .unbounded(&["dipole-oriented"]),
        row("mean free path 1/1000 texel", Scene::ball(scaled(USUAL, 1e3)), vec![Falling])
            .excess(CORNERS)
            .unbounded(&["dipole-oriented"]),
        row("mean free path 1000 texels", Scene::ball(scaled(USUAL, 1e-3)), vec![Falling])
            .unbounded(&["dipole-oriented"]),
    ]
}
