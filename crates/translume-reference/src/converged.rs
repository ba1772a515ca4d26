//! Exitance from the triangles themselves: the profile's integral over the surface, which `scatter` only samples.
//!
//! B(x) = ∫ E(y) R_d(|x − y|) dA(y). Triangles are cut into patches no longer than a target edge, whose irradiance, with
//! shadows cast from every quadrature point, is computed once. For each receiver, patches that are long against their
//! distance are cut further, down to a fraction of z_r, so that the smooth core of the profile is resolved and no
//! singularity is left.

use glam::DVec3;
use rayon::prelude::*;

use crate::lights::{Lighting, Place};
use crate::profile::Profile;
use crate::rgb::accumulate;
use crate::surface::{interpolate, triangle_area};
use crate::{Boundary, Dipole, Light, Medium, Surface};

/// Longest edge of a patch over its distance from the receiver, or over z_r if that is more. The rule below has degree 5;
/// at 1/2 the plane and the sphere come out within 3e-5 (see the tests).
const EDGE_PER_DISTANCE: f64 = 0.5;

/// Longest edge of a patch in units of 1/σ_tr, likewise.
const EDGE_PER_DECAY: f64 = 1.0;

/// Directions squared towards each light that has an extent and a shadow; the seven points of a patch share the noise.
const RAYS: u32 = 8;

/// Patches shared by all receivers, at most: 400 bytes each.
const MAX_PATCHES: f64 = 1e6;

/// Radon's rule of degree 5 on the triangle: weights of the second and third corner, and share of the area.
/// Source: Radon 1948; Stroud 1971, T2:5-1.
fn rule() -> [([f64; 2], f64); 7] {
    let root = 15.0f64.sqrt();
    let (p, q) = ((6.0 - root) / 21.0, (6.0 + root) / 21.0);
    let (wp, wq) = ((155.0 - root) / 1200.0, (155.0 + root) / 1200.0);
    [
        ([1.0 / 3.0, 1.0 / 3.0], 9.0 / 40.0),
        ([p, p], wp),
        ([1.0 - 2.0 * p, p], wp),
        ([p, 1.0 - 2.0 * p], wp),
        ([q, q], wq),
        ([1.0 - 2.0 * q, q], wq),
        ([q, 1.0 - 2.0 * q], wq),
    ]
}

/// A lit surface ready to be asked for its exitance anywhere.
pub struct Converged<'a, P = Dipole> {
    surface: &'a Surface,
    lighting: Lighting<'a>,
    profiles: [P; 3],
    patches: Vec<Patch>,
    edge: f64,
    /// Whether parts of patches take their light from the whole: rays to a sky or an area light at every part would take minutes, and such light
    /// varies slowly.
    is_soft: bool,
}

/// A triangle inside a triangle of the surface.
struct Patch {
    triangle: u32,
    /// Corners as weights of the second and third corner of the surface's triangle.
    corners: [[f64; 2]; 3],
    centre: DVec3,
    radius: f64,
    edge: f64,
    /// Quadrature points with E·A of each, W/m² · mm².
    points: [(DVec3, [f64; 3]); 7],
    light: Linear,
}

/// Irradiance of a patch as a linear function over it, fitted to its quadrature points.
#[derive(Clone, Copy)]
struct Linear {
    /// Corners as weights of the second and third corner of the surface's triangle.
    corners: [[f64; 2]; 3],
    mean: [f64; 3],
    /// By the weights of the patch's first, second and third corner less a third.
    slopes: [[f64; 3]; 3],
}

impl<'a> Converged<'a> {
    /// As [`with_profiles`](Self::with_profiles) for the medium's classical dipoles.
    #[must_use]
    pub fn new(surface: &'a Surface, lights: &'a [Light], medium: &Medium, target_edge: f64) -> Self {
        Self::with_profiles(surface, lights, medium.ior, medium.dipoles(), target_edge)
    }
}

impl<'a, P: Profile> Converged<'a, P> {
    /// Casts light onto `surface` at steps of `target_edge` mm or less; shadow edges are as sharp as that, and light from an extent is linear in between. If the steps
    /// would need more than a million patches they grow until they do not; [`edge`](Self::edge) tells. A profile of each channel; `boundary`,
    /// or an index of refraction alone, says how light enters. Where a profile has no bound at r = 0, patches are cut to a hundredth of its decay length, or a tenth of their own, and no
    /// further, and what is nearer is as good as seven points.
    #[must_use]
    pub fn with_profiles(
        surface: &'a Surface,
        lights: &'a [Light],
        boundary: impl Into<Boundary>,
        profiles: [P; 3],
        target_edge: f64,
    ) -> Self {
        let area: f64 = (0..surface.triangles.len() as u32).map(|t| surface.area(t)).sum();
        // Halving edges leaves them between the target and half of it, so a patch holds at least ~1/8 of its square.
        let spare = (MAX_PATCHES - surface.triangles.len() as f64).max(1.0);
        let edge = target_edge.max((8.0 * area / spare).sqrt());
        let lighting = Lighting::new(surface, lights, boundary.into(), RAYS);
        let is_soft = lights.iter().any(Light::is_soft);
        let patches = (0..surface.triangles.len() as u32)
            .into_par_iter()
            .filter(|&triangle| surface.area(triangle) > 0.0)
            .flat_map_iter(|triangle| {
                let mut pieces = Vec::new();
                let whole = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
                cut(surface, triangle, whole, edge, &mut pieces);
                pieces.into_iter().map(move |corners| (triangle, corners))
            })
            .map(|(triangle, corners)| Patch::lit(surface, &lighting, triangle, corners))
            .collect();
        Self { surface, lighting, profiles, patches, edge, is_soft }
    }

    /// The same light by other profiles, without casting it again.
    pub fn set_profiles(&mut self, profiles: [P; 3]) {
        self.profiles = profiles;
    }

    /// The longest edge of the patches that light was cast on, mm.
    #[must_use]
    pub fn edge(&self) -> f64 {
        self.edge
    }

    /// Exitance, W/m², at points of the surface in mm.
    #[must_use]
    pub fn exitance(&self, receivers: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let from_all = |&receiver: &[f64; 3]| {
            let mut sum = [0.0; 3];
            for patch in &self.patches {
                self.add(patch, receiver.into(), &mut sum);
            }
            sum
        };
        receivers.par_iter().map(from_all).collect()
    }

    fn add(&self, patch: &Patch, receiver: DVec3, sum: &mut [f64; 3]) {
        let distance = (receiver.distance(patch.centre) - patch.radius).max(0.0);
        if patch.edge > self.longest_edge(distance) {
            for corners in quarters(patch.corners) {
                let part = if self.is_soft {
                    let light = |weights, _| patch.light.at(weights);
                    Patch { light: patch.light, ..Patch::new(self.surface, patch.triangle, corners, light) }
                } else {
                    Patch::lit(self.surface, &self.lighting, patch.triangle, corners)
                };
                self.add(&part, receiver, sum);
            }
            return;
        }
        for (position, power) in &patch.points {
            if *power == [0.0; 3] {
                continue;
            }
            let r = receiver.distance(*position);
            let nearest =
                |profile: &P| if profile.core() > 0.0 { r } else { r.max(0.1 * self.core(profile)) };
            let reflectance = |profile: &P| profile.reflectance(nearest(profile));
            accumulate(sum, std::array::from_fn(|k| reflectance(&self.profiles[k]) * power[k]), 1.0);
        }
    }

    /// Length below which patches are cut no further, mm. For a profile without a bound at r = 0 a hundredth of its decay length, and, as that
    /// may be long where hardly anything absorbs, a tenth of a patch.
    fn core(&self, profile: &P) -> f64 {
        if profile.core() > 0.0 { profile.core() } else { (0.01 / profile.decay()).min(0.1 * self.edge) }
    }

    /// The longest edge a patch may have at a distance from the receiver.
    fn longest_edge(&self, distance: f64) -> f64 {
        let limit = |profile: &P| {
            let scale = EDGE_PER_DISTANCE * distance.max(self.core(profile));
            // Farther than 8 decay lengths, what is left is small enough for a coarser step.
            let decay = (1.0 / profile.decay()).max(distance / 8.0);
            scale.min(EDGE_PER_DECAY * decay)
        };
        let scattering = self.profiles.iter().filter(|profile| profile.total() > 0.0);
        scattering.map(limit).fold(f64::INFINITY, f64::min)
    }
}

impl Patch {
    /// Under the lights of the scene.
    fn lit(surface: &Surface, lighting: &Lighting<'_>, triangle: u32, corners: [[f64; 2]; 3]) -> Self {
        Self::new(surface, triangle, corners, |barycentric, position| {
            let normal = surface.normal(triangle, barycentric).into();
            lighting.irradiance(Place { position, normal, triangle })
        })
    }

    fn new(
        surface: &Surface,
        triangle: u32,
        corners: [[f64; 2]; 3],
        light: impl Fn([f64; 2], DVec3) -> [f64; 3],
    ) -> Self {
        let whole = surface.corners(triangle);
        let positions = corners.map(|weights| interpolate(whole, weights));
        let area = triangle_area(positions);
        let centre = interpolate(positions, [1.0 / 3.0; 2]);
        let rule = rule();
        let lit = rule.map(|(weights, _)| {
            let barycentric = between(corners, weights);
            let position = interpolate(whole, barycentric);
            (position, light(barycentric, position))
        });
        let points = std::array::from_fn(|k| (lit[k].0, crate::rgb::scale(lit[k].1, area * rule[k].1)));
        let radius = positions.map(|p| p.distance(centre)).into_iter().fold(0.0, f64::max);
        let light = Linear::new(corners, lit.map(|(_, light)| light));
        Self { triangle, corners, centre, radius, edge: longest(positions), points, light }
    }
}

impl Linear {
    /// The least squares fit with the weights of the rule. Its points lie as regularly as the triangle, so Σ w d dᵀ of their offsets d from
    /// the middle, in weights of the corners, is a multiple of the identity on Σ d = 0.
    fn new(corners: [[f64; 2]; 3], light: [[f64; 3]; 7]) -> Self {
        let offsets = rule().map(|([u, v], share)| ([1.0 - u - v, u, v].map(|w| w - 1.0 / 3.0), share));
        let moment: f64 =
            offsets.iter().map(|(d, share)| share * d.iter().map(|d| d * d).sum::<f64>()).sum::<f64>() / 2.0;
        let (mut mean, mut slopes) = ([0.0; 3], [[0.0; 3]; 3]);
        for ((offset, share), light) in offsets.iter().zip(light) {
            accumulate(&mut mean, light, *share);
            for (slope, d) in slopes.iter_mut().zip(offset) {
                accumulate(slope, light, share * d / moment);
            }
        }
        Self { corners, mean, slopes }
    }

    /// Where the surface's triangle has these weights; not below 0.
    fn at(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let [a, b, c] = self.corners;
        let [(bu, bv), (cu, cv)] = [(b[0] - a[0], b[1] - a[1]), (c[0] - a[0], c[1] - a[1])];
        let (du, dv, determinant) = (u - a[0], v - a[1], bu * cv - bv * cu);
        let [s, t] = [(du * cv - dv * cu) / determinant, (bu * dv - bv * du) / determinant];
        let mut sum = self.mean;
        for (slope, weight) in self.slopes.iter().zip([1.0 - s - t, s, t]) {
            accumulate(&mut sum, *slope, weight - 1.0 / 3.0);
        }
        sum.map(|light| light.max(0.0))
    }
}

/// Quarters a triangle until no edge is longer than `edge`.
fn cut(surface: &Surface, triangle: u32, corners: [[f64; 2]; 3], edge: f64, pieces: &mut Vec<[[f64; 2]; 3]>) {
    let whole = surface.corners(triangle);
    if longest(corners.map(|weights| interpolate(whole, weights))) <= edge {
        pieces.push(corners);
        return;
    }
    for quarter in quarters(corners) {
        cut(surface, triangle, quarter, edge, pieces);
    }
}

fn quarters([a, b, c]: [[f64; 2]; 3]) -> [[[f64; 2]; 3]; 4] {
    let middle = |p: [f64; 2], q: [f64; 2]| [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
    let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

fn between(corners: [[f64; 2]; 3], weights: [f64; 2]) -> [f64; 2] {
    let point = interpolate(corners.map(|[u, v]| DVec3::new(u, v, 0.0)), weights);
    [point.x, point.y]
}

fn longest([a, b, c]: [DVec3; 3]) -> f64 {
    a.distance(b).max(b.distance(c)).max(c.distance(a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_rel, octasphere, sphere_exitance, square};
    use std::f64::consts::{FRAC_1_PI, PI};

    const MEDIUM: Medium =
        Medium { sigma_s_prime: [2.19, 0.88, 0.03], sigma_a: [0.0021, 0.17, 1.45], ior: 1.0 };

    /// Irradiance 1 everywhere at eta = 1.
    fn uniform() -> Light {
        Light::Ambient { radiance: [FRAC_1_PI; 3], axis: [0.0, 1.0, 0.0], half_angle: PI, shadow: false }
    }

    #[test]
    fn rule_has_degree_five() {
        // ∫ b^i c^j over the triangle, in units of its area: 2 i! j! / (i + j + 2)!
        let factorial = |n: i32| f64::from((1..=n).product::<i32>());
        let moment = |i: i32, j: i32| rule().iter().map(|([b, c], w)| w * b.powi(i) * c.powi(j)).sum::<f64>();
        let exact = |i: i32, j: i32| 2.0 * factorial(i) * factorial(j) / factorial(i + j + 2);
        for (i, j) in (0..=5).flat_map(|i| (0..=5 - i).map(move |j| (i, j))) {
            assert_rel(moment(i, j), exact(i, j), 1e-14, "moment");
        }
        assert!((moment(6, 0) / exact(6, 0) - 1.0).abs() > 1e-4, "degree 6 must not come out");
    }

    #[test]
    fn evenly_lit_plane_is_the_total() {
        let half = 1000.0;
        let (positions, triangles) = square(half, 0.0);
        let surface = Surface::flat(positions, triangles);
        let lights = [uniform()];
        let plane = Converged::new(&surface, &lights, &MEDIUM, 500.0);
        let dipoles = MEDIUM.dipoles();
        for b in plane.exitance(&[[0.0; 3], [0.37, 0.0, -0.11], [12.0, 0.0, 30.0]]) {
            for k in 0..3 {
                // Quadrature at half a distance per edge; beyond the square less than e^-100 is missing.
                assert_rel(b[k], dipoles[k].total(), 3e-5, "plane");
                assert!((b[k] / Dipole::new(2.2, 0.01, 1.0).total() - 1.0).abs() > 1e-3, "another medium");
            }
        }
    }

    /// A profile like 1/r, and one that is smooth, of another kind than the dipole.
    #[test]
    fn evenly_lit_plane_is_the_total_of_any_profile() {
        use crate::profile::{Channel, Entry, better_dipole, normalised_diffusion};
        let channel = Channel { sigma_s_prime: 0.88, sigma_a: 0.17, ior: 1.0 };
        let (positions, triangles) = square(200.0, 0.0);
        let surface = Surface::flat(positions, triangles);
        let lights = [uniform()];
        let sharp = normalised_diffusion(&channel, Entry::Normal, None);
        for (profile, tolerance) in [(better_dipole(&channel), 1e-4), (sharp, 0.02)] {
            let total = profile.total();
            let profiles = [(); 3].map(|()| profile.clone());
            let plane = Converged::with_profiles(&surface, &lights, 1.0, profiles, 100.0);
            let b = plane.exitance(&[[0.37, 0.0, -0.11]])[0];
            // Within a hundredth of 1/decay of the receiver seven points stand for 1/r; the smooth one as above.
            assert_rel(b[1], total, tolerance, "plane");
            assert!((b[1] / (1.05 * total) - 1.0).abs() > tolerance, "5 % must be noticed");
        }
    }

    /// Without absorption the exponential that says how far to cut is none.
    #[test]
    fn white_and_unbounded_is_finite() {
        let (positions, triangles) = square(20.0, 0.0);
        let surface = Surface::flat(positions, triangles);
        let lights = [uniform()];
        let exitance = |decay: f64| {
            // R_d = (2 + r) e^(−decay r) / (2πr (1 + r)³), of total 3/2 without a decay.
            let white = |r: f64| (2.0 + r) / (2.0 * PI * r * (1.0 + r).powi(3)) * (-decay * r).exp();
            let profiles = [(); 3].map(|()| crate::profile::Numeric::new(white, decay, 0.0, [1e-4, 1e3]));
            Converged::with_profiles(&surface, &lights, 1.0, profiles, 5.0).exitance(&[[0.37, 0.0, -0.11]])[0]
                [0]
        };
        let (white, nearly) = (exitance(0.0), exitance(1e-4));
        // 20 mm lose 1/20 of it, and what is nearer than a tenth of an edge is as good as seven points.
        assert!((white / nearly - 1.0).abs() < 0.02 && (1.2..1.5).contains(&white), "{white} {nearly}");
        assert!((white / exitance(0.3) - 1.0).abs() > 0.02, "a decay that counts must be noticed");
    }

    /// The sphere's closed form, approached with the square of the facets' edge.
    #[test]
    fn evenly_lit_sphere_is_the_closed_form() {
        let lights = [uniform()];
        let dipoles = MEDIUM.dipoles();
        let error = |levels: u32| {
            let (positions, triangles) = octasphere(10.0, levels);
            let surface = Surface::smooth(positions, triangles);
            let sphere = Converged::new(&surface, &lights, &MEDIUM, 5.0);
            let receivers = [[10.0, 0.0, 0.0], [0.0, 10.0, 0.0]];
            let b = sphere.exitance(&receivers);
            std::array::from_fn(|k| b[0][k] / sphere_exitance(&dipoles[k], 10.0) - 1.0)
        };
        let (coarse, fine): ([f64; 3], [f64; 3]) = (error(5), error(6));
        for k in 0..3 {
            let extrapolated = fine[k] + (fine[k] - coarse[k]) / 3.0;
            // Inscribed facets of edge h lose about (h/R)²/8 of the area: 0.008 % at level 6, h = 0.025 R. Extrapolated
            // to h = 0, what the quadrature promises is left.
            assert!(fine[k].abs() < 2e-4, "{fine:?}");
            assert!(extrapolated.abs() < 3e-5, "{coarse:?} {fine:?}");
        }
        let wrong_radius = sphere_exitance(&dipoles[0], 10.1) / sphere_exitance(&dipoles[0], 10.0) - 1.0;
        assert!(wrong_radius.abs() > 1e-4, "1 % of radius must be noticed: {wrong_radius}");
    }

    #[test]
    fn shadow_darkens_what_lies_in_it() {
        let (mut positions, mut triangles) = square(20.0, 0.0);
        let (roof, _) = square(5.0, 8.0);
        positions.extend(roof);
        triangles.extend([[4, 5, 6], [4, 6, 7]]);
        let surface = Surface::flat(positions, triangles);
        let sun = |shadow| {
            [Light::Directional { to_light: [0.0, 1.0, 0.0], irradiance: [1.0; 3], shadow, region: None }]
        };
        let blue = |shadow: bool, x: f64| {
            Converged::new(&surface, &sun(shadow), &MEDIUM, 0.5).exitance(&[[x, 0.0, 0.0]])[0][2]
        };
        let total = MEDIUM.dipoles()[2].total();
        assert!(blue(true, 0.0) < 1e-4 * total, "5 mm into the shadow, 13 decay lengths");
        assert_rel(blue(true, 12.0), total, 1e-3, "7 mm outside the shadow");
        assert_rel(blue(false, 0.0), total, 1e-3, "no shadow asked for");
        // At the shadow's edge half the plane gives light; the edge lies on patch boundaries here.
        assert_rel(blue(true, 5.0), 0.5 * total, 1e-3, "edge");
    }

    #[test]
    fn parts_of_a_patch_have_its_light() {
        let corners = [[0.1, 0.2], [0.5, 0.1], [0.3, 0.6]];
        let plane = |[u, v]: [f64; 2]| [1.0 + 2.0 * u - v, 3.0 * v, 0.5];
        let fit = Linear::new(corners, rule().map(|(weights, _)| plane(between(corners, weights))));
        for weights in [[0.0, 0.0], [1.0, 0.0], [0.2, 0.7], [1.0 / 3.0; 2]] {
            let place = between(corners, weights);
            for k in 0..3 {
                assert!((fit.at(place)[k] - plane(place)[k]).abs() < 1e-12, "{weights:?}");
            }
        }
        let bent = Linear::new(corners, rule().map(|([u, _], _)| [u * u, 0.0, 0.0]));
        assert!((bent.at(corners[1])[0] - 1.0).abs() > 0.05, "what is not linear is not kept");
    }

    /// The parts' light comes from the whole here, and from rays there.
    #[test]
    fn soft_light_is_the_same_in_parts() {
        let (positions, triangles) = octasphere(10.0, 3);
        let surface = Surface::smooth(positions, triangles);
        let lights =
            [Light::Ambient { radiance: [1.0; 3], axis: [0.0, 1.0, 0.0], half_angle: 1.2, shadow: true }];
        let dull = Medium { sigma_s_prime: [0.7, 0.9, 1.2], sigma_a: [0.02, 0.1, 0.3], ior: 1.3 };
        let receivers = [[10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, -10.0, 0.0]];
        let soft = Converged::new(&surface, &lights, &dull, 1.0);
        let hard = Converged { is_soft: false, ..Converged::new(&surface, &lights, &dull, 1.0) };
        let brighter = Converged::new(&surface, &lights, &dull, 4.0);
        let far = |a: &Converged<'_>| {
            let (a, b) = (a.exitance(&receivers), hard.exitance(&receivers));
            let pairs = a.as_flattened().iter().zip(b.as_flattened());
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / b[1][0]
        };
        // Patches of a tenth of the radius, and the noise of 64 rays: measured 4e-4.
        assert!(far(&soft) < 2e-3, "{}", far(&soft));
        assert!(far(&brighter) > far(&soft), "coarser patches must be worse: {}", far(&brighter));
    }

    #[test]
    fn nothing_scatters_or_shines() {
        let (positions, triangles) = square(1.0, 0.0);
        let surface = Surface::flat(positions, triangles);
        let clear = Medium { sigma_s_prime: [0.0; 3], ..MEDIUM };
        let lights = [uniform()];
        assert_eq!(Converged::new(&surface, &lights, &clear, 0.1).exitance(&[[0.0; 3]]), [[0.0; 3]]);
        assert_eq!(Converged::new(&surface, &[], &MEDIUM, 0.1).exitance(&[[0.0; 3]]), [[0.0; 3]]);
        let empty = Surface::flat(Vec::new(), Vec::new());
        assert_eq!(Converged::new(&empty, &lights, &MEDIUM, 0.1).exitance(&[[0.0; 3]]), [[0.0; 3]]);
    }

    #[test]
    fn the_number_of_patches_is_bounded() {
        let (positions, triangles) = square(100.0, 0.0);
        let surface = Surface::flat(positions, triangles);
        let plane = Converged::new(&surface, &[], &MEDIUM, 1e-6);
        assert!(plane.edge() > 1e-6 && (plane.patches.len() as f64) < MAX_PATCHES, "{}", plane.patches.len());
        assert!(Converged::new(&surface, &[], &MEDIUM, 10.0).edge() == 10.0);
    }
}
