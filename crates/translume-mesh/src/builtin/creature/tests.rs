use std::sync::OnceLock;

use glam::DVec3;

use super::*;
use crate::builtin::topology::{Topology, areas, check_clean, normal_agreement, signed_volume};

/// A small one serves most tests.
fn small() -> &'static Mesh {
    static SMALL: OnceLock<Mesh> = OnceLock::new();
    SMALL.get_or_init(|| creature_with(5_000))
}

fn morphed(mesh: &Mesh, weight: f32) -> Mesh {
    let mut moved = mesh.clone();
    for (p, d) in moved.positions.iter_mut().zip(&mesh.targets[0].position_deltas) {
        *p = std::array::from_fn(|k| p[k] + weight * d[k]);
    }
    moved
}

fn check_body(mesh: &Mesh) {
    check_clean(mesh);
    let topology = Topology::of(mesh);
    assert_eq!((topology.euler(), topology.components, topology.bad_edges), (2, 1, 0));
    assert!(signed_volume(mesh) > 1e5, "outside is outside, and it is plump: mm³");
    let (low, high) = mesh.bounds().unwrap();
    assert!(low[1].abs() < 0.1 && (90.0..100.0).contains(&high[1]), "{low:?} {high:?}");
}

#[test]
fn is_one_closed_body_on_the_floor() {
    let mesh = small();
    assert!((4_750..5_250).contains(&mesh.triangles.len()), "{}", mesh.triangles.len());
    check_body(mesh);
    check_body(&creature_with(2_500));
}

#[test]
fn is_deterministic() {
    assert_eq!(creature_with(2_000), creature_with(0));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "seconds without optimisation")]
fn full_size_is_even_and_folds_nowhere() {
    let mesh = creature();
    assert!((45_000..55_000).contains(&mesh.triangles.len()), "{}", mesh.triangles.len());
    check_body(&mesh);
    // The ears' rims turn through 180° within 4 mm, four to five triangles.
    assert!(normal_agreement(&mesh) > 65f64.to_radians().cos());
    assert_eq!(folded(&mesh), 0);
    let ratios = area_ratios(&mesh);
    assert!(
        ratios[0] > 0.15 && ratios[ratios.len() / 20] > 0.4,
        "{} {}",
        ratios[0],
        ratios[ratios.len() / 20]
    );
}

/// Through the middle of an ear, from its back to its front.
fn ear_thickness(mesh: &Mesh) -> Vec<f64> {
    let at = |v: usize| DVec3::from(mesh.positions[v].map(f64::from));
    let inside_ear = |p: DVec3| (p - DVec3::new(25.5, 81.0, p.z)).length() < 8.0;
    let back = (0..mesh.positions.len()).filter(|&v| inside_ear(at(v)) && mesh.normals[v][2] < 0.0);
    let through = |v: usize| {
        let (origin, ray) = (at(v), -DVec3::from(mesh.normals[v].map(f64::from)));
        let hits = (0..mesh.triangles.len()).filter_map(|t| {
            let [a, b, c] = mesh.corners(t).map(|p| DVec3::from(p.map(f64::from)) - origin);
            let [u, v, w] = [(b, c), (c, a), (a, b)].map(|(p, q)| ray.dot(p.cross(q)));
            let hit = u.min(v).min(w) >= 0.0 || u.max(v).max(w) <= 0.0;
            let point = (u * a + v * b + w * c) / (u + v + w);
            (hit && point.dot(ray) > 0.01).then(|| point.dot(ray))
        });
        hits.fold(f64::MAX, f64::min)
    };
    back.map(through).collect()
}

#[test]
fn ears_are_thin_sheets() {
    let thickness = ear_thickness(small());
    assert!(thickness.len() > 10, "{} samples", thickness.len());
    assert!(thickness.iter().all(|t| (1.5..3.0).contains(t)), "{thickness:?}");
}

#[test]
fn a_thick_ear_is_noticed() {
    let mut mesh = small().clone();
    for (p, n) in mesh.positions.iter_mut().zip(&mesh.normals) {
        *p = std::array::from_fn(|k| p[k] + 0.5 * n[k]);
    }
    assert!(ear_thickness(&mesh).iter().any(|t| *t > 3.0));
}

/// The egg as a level set: 1 on it.
fn egg_level(p: DVec3) -> f64 {
    let y = p.y / egg::RADII[1] - 1.0;
    let radius = egg::RADII[0] * (-egg::TAPER * y).exp();
    (p.x * p.x + p.z * p.z) / (radius * radius) + y * y
}

fn egg_normal(p: DVec3) -> DVec3 {
    let slope = |axis: DVec3| egg_level(p + 1e-4 * axis) - egg_level(p - 1e-4 * axis);
    DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z)).normalize()
}

/// Triangles of the egg that any of their corners' normals sees from behind.
fn folded(mesh: &Mesh) -> usize {
    let egg = morphed(mesh, 1.0);
    let turned = |t: &usize| {
        let corners = egg.corners(*t).map(|p| DVec3::from(p.map(f64::from)));
        let face = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        corners.iter().any(|&p| face.dot(egg_normal(p)) <= 0.0)
    };
    (0..egg.triangles.len()).filter(turned).count()
}

#[test]
fn the_egg_is_an_egg_without_a_fold() {
    let mesh = small();
    let egg = morphed(mesh, 1.0);
    for &p in &egg.positions {
        let level = egg_level(DVec3::from(p.map(f64::from)));
        // f32 deltas of up to 100 mm round by 4·10⁻⁶ mm; the level changes by some 0.07 per mm.
        assert!((level - 1.0).abs() < 1e-5, "{level} at {p:?}");
    }
    assert_eq!(folded(mesh), 0);
    let topology = Topology::of(&egg);
    assert_eq!((topology.euler(), topology.components, topology.bad_edges), (2, 1, 0));
    let (low, high) = egg.bounds().unwrap();
    assert!(low[1].abs() < 0.5 && (high[1] - 82.0).abs() < 0.5, "{low:?} {high:?}: sits on the floor");
}

#[test]
fn two_swapped_vertices_are_noticed() {
    let mut mesh = small().clone();
    let [a, b, _] = mesh.triangles[100].map(|v| v as usize);
    let egg = morphed(&mesh, 1.0);
    for (v, w) in [(a, b), (b, a)] {
        mesh.targets[0].position_deltas[v] =
            std::array::from_fn(|k| egg.positions[w][k] - mesh.positions[v][k]);
    }
    assert_ne!(folded(&mesh), 0);
}

/// Area on the egg over area on the creature, ascending, median 1.
fn area_ratios(mesh: &Mesh) -> Vec<f64> {
    let (rest, egg) = (areas(mesh), areas(&morphed(mesh, 1.0)));
    let mut ratios = rest.iter().zip(&egg).map(|(rest, egg)| egg / rest).collect::<Vec<_>>();
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    ratios.iter().map(|ratio| ratio / median).collect()
}

#[test]
fn the_egg_keeps_areas_even() {
    let ratios = area_ratios(small());
    // A conformal map would shrink the ears' tips a thousandfold.
    assert!(ratios[0] > 0.15 && ratios[ratios.len() - 1] < 3.0, "{} {}", ratios[0], ratios[ratios.len() - 1]);
}

/// On the way nothing turns inside out: the mesh keeps an outward volume and agrees with its own normals.
#[test]
fn melts_without_turning_inside_out() {
    for weight in [0.25, 0.5, 0.75] {
        let mut mesh = morphed(small(), weight);
        let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = mesh.corners(t).map(|p| DVec3::from(p.map(f64::from)));
            triangle.iter().for_each(|&v| sums[v as usize] += (b - a).cross(c - a));
        }
        mesh.normals = sums.iter().map(|n| n.normalize().as_vec3().into()).collect();
        assert!(signed_volume(&mesh) > 1e5);
        assert!(normal_agreement(&mesh) > 0.0, "weight {weight}: {}", normal_agreement(&mesh));
    }
}

#[test]
fn removals_undo_exactly() {
    let mesh = crate::builtin::sphere([0.0; 3], 1.0, 3);
    let positions = mesh.positions.iter().map(|&p| p.into()).collect::<Vec<Vec3>>();
    let mut rings = Rings::new(positions.len(), &mesh.triangles);
    let sorted = |rings: &Rings| {
        let mut triangles = rings.triangles();
        triangles.sort_unstable();
        triangles
    };
    let before = sorted(&rings);
    let rounds = rings.coarsen(&positions, 4);
    assert_eq!((before.len(), rings.triangles().len()), (1280, 4));
    rounds.into_iter().flatten().rev().for_each(|removal| rings.restore(removal));
    assert_eq!(sorted(&rings), before);
}
