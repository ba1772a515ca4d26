//! Evens out area per texel: the paper's equiareal parameterisation, as a relaxation of charts that are already flat.
//!
//! Maillot, Yahia, Verroust 1993 ("Interactive texture mapping") weigh area against angle; Surazhsky and Gotsman 2003 ("Explicit
//! surface remeshing") relax vertices one by one until areas are even. Here all vertices of a chart move at once, boundary
//! included: Gauss–Newton on the relative areas of its triangles, each step held smooth by the Dirichlet energy of the
//! displacement (Levenberg 1944), so that area flows across the chart rather than into single triangles.

use glam::DVec2;

use super::boundary::Boundary;

/// Weight of the displacement's Dirichlet energy beside the squared relative area errors. A hundredth lets areas win
/// everywhere but keeps single steps smooth.
const SMOOTHNESS: f64 = 0.01;
/// A chart is even once the root mean square of its relative area errors is below this.
const EVEN: f64 = 0.005;
/// Steps for one chart; most are even after three.
const MAX_STEPS: usize = 12;
/// Iterations of conjugate gradients in a step. An inexact step costs a further one at worst.
const MAX_ITERATIONS: usize = 80;
/// Residual, relative, at which they stop.
const RESIDUAL: f64 = 0.02;
/// No triangle may shrink to less than this share of its area in a step, so that none flips.
const LEAST_SHRINK: f64 = 0.2;

/// Rounds in which the parts of a boundary that met are held; after that all of it is.
const MAX_ROUNDS: usize = 8;

/// One chart: points, triangles over them, and the surface of each triangle.
#[derive(Default)]
pub(super) struct Chart {
    pub points: Vec<DVec2>,
    pub triangles: Vec<[u32; 3]>,
    /// Surface of each triangle, above 0, in any unit.
    pub areas: Vec<f64>,
    /// Points that may not move; the others may where this is shorter.
    held: Vec<bool>,
}

impl Chart {
    /// Moves the points. No triangle turns over and no part of the boundary crosses another, if none did before.
    pub fn relax(&mut self) {
        let boundary = Boundary::of(&self.triangles, self.points.len());
        let before = self.points.clone();
        self.held = vec![false; self.points.len()];
        for round in 0..=MAX_ROUNDS {
            self.even_out();
            let met = boundary.meetings(&self.points);
            if met.is_empty() {
                return;
            }
            self.points.clone_from(&before);
            let hold = if round + 1 < MAX_ROUNDS { &met } else { &boundary.points };
            hold.iter().for_each(|&v| self.held[v as usize] = true);
        }
    }

    fn even_out(&mut self) {
        let mut error = self.error(&self.points);
        for _ in 0..MAX_STEPS {
            if error < EVEN {
                break;
            }
            let step = self.step();
            // Halved until it helps.
            let tried = (0..8).map(|k| 0.5_f64.powi(k)).find_map(|scale| {
                let moved: Vec<DVec2> = self.points.iter().zip(&step).map(|(&p, &d)| p + scale * d).collect();
                let improved = self.error(&moved);
                (improved < error && self.keeps_triangles(&moved)).then_some((moved, improved))
            });
            let Some((moved, improved)) = tried else { break };
            self.points = moved;
            if improved > 0.95 * error {
                break;
            }
            error = improved;
        }
    }

    fn area(&self, points: &[DVec2], triangle: usize) -> f64 {
        let [a, b, c] = self.triangles[triangle].map(|v| points[v as usize]);
        (b - a).perp_dot(c - a) / 2.0
    }

    /// UV area that a unit of surface should get: what it gets on average.
    fn density(&self, points: &[DVec2]) -> f64 {
        let laid: f64 = (0..self.triangles.len()).map(|t| self.area(points, t)).sum();
        laid / self.areas.iter().sum::<f64>()
    }

    /// Root mean square of (area / wanted area − 1), weighted by surface.
    fn error(&self, points: &[DVec2]) -> f64 {
        let density = self.density(points);
        let squares = self
            .areas
            .iter()
            .enumerate()
            .map(|(t, &surface)| surface * (self.area(points, t) / (density * surface) - 1.0).powi(2));
        (squares.sum::<f64>() / self.areas.iter().sum::<f64>()).sqrt()
    }

    fn keeps_triangles(&self, moved: &[DVec2]) -> bool {
        (0..self.triangles.len()).all(|t| self.area(moved, t) > LEAST_SHRINK * self.area(&self.points, t))
    }

    /// The displacement of every point in one Gauss–Newton step.
    fn step(&self) -> Vec<DVec2> {
        let density = self.density(&self.points);
        let total: f64 = self.areas.iter().sum();
        let mut rows = Vec::with_capacity(self.triangles.len());
        let mut target = vec![DVec2::ZERO; self.points.len()];
        for (t, (&triangle, &surface)) in self.triangles.iter().zip(&self.areas).enumerate() {
            let p = triangle.map(|v| self.points[v as usize]);
            let wanted = density * surface;
            let weight = (surface / total).sqrt();
            // Gradient of the triangle's area by each corner, over the wanted area.
            let gradient =
                [0, 1, 2].map(|k| (p[(k + 1) % 3] - p[(k + 2) % 3]).perp() * (-0.5 * weight / wanted));
            let missing = weight * (1.0 - self.area(&self.points, t) / wanted);
            for (v, g) in triangle.into_iter().zip(gradient) {
                target[v as usize] += g * missing;
            }
            rows.push(gradient);
        }
        let smoothness = SMOOTHNESS / (density * total);
        self.hold(&mut target);
        conjugate_gradients(&target, &self.diagonal(&rows, smoothness), |x, y| {
            self.apply(&rows, smoothness, x, y);
        })
    }

    /// The normal equations' matrix times a vector: area rows, and each triangle's edges as springs.
    fn apply(&self, rows: &[[DVec2; 3]], smoothness: f64, x: &[DVec2], y: &mut [DVec2]) {
        y.fill(DVec2::ZERO);
        for (triangle, gradient) in self.triangles.iter().zip(rows) {
            let [a, b, c] = triangle.map(|v| x[v as usize]);
            let change = gradient[0].dot(a) + gradient[1].dot(b) + gradient[2].dot(c);
            let middle = a + b + c;
            for (k, corner) in [a, b, c].into_iter().enumerate() {
                y[triangle[k] as usize] += gradient[k] * change + smoothness * (3.0 * corner - middle);
            }
        }
        self.hold(y);
    }

    fn hold(&self, displacements: &mut [DVec2]) {
        displacements
            .iter_mut()
            .zip(&self.held)
            .filter(|(_, held)| **held)
            .for_each(|(d, _)| *d = DVec2::ZERO);
    }

    fn diagonal(&self, rows: &[[DVec2; 3]], smoothness: f64) -> Vec<DVec2> {
        let mut diagonal = vec![DVec2::ZERO; self.points.len()];
        for (triangle, gradient) in self.triangles.iter().zip(rows) {
            for (&v, &g) in triangle.iter().zip(gradient) {
                diagonal[v as usize] += g * g + 2.0 * smoothness;
            }
        }
        diagonal
    }
}

/// Solves A x = b for a symmetric positive semidefinite A, preconditioned by its diagonal (Hestenes and Stiefel 1952).
fn conjugate_gradients(
    b: &[DVec2],
    diagonal: &[DVec2],
    apply: impl Fn(&[DVec2], &mut [DVec2]),
) -> Vec<DVec2> {
    let dot = |x: &[DVec2], y: &[DVec2]| x.iter().zip(y).map(|(x, y)| x.dot(*y)).sum::<f64>();
    let mut x = vec![DVec2::ZERO; b.len()];
    let mut residual = b.to_vec();
    let mut conditioned: Vec<DVec2> = residual.iter().zip(diagonal).map(|(r, d)| *r / *d).collect();
    let mut direction = conditioned.clone();
    let mut image = x.clone();
    let mut energy = dot(&residual, &conditioned);
    let enough = RESIDUAL * RESIDUAL * energy;
    for _ in 0..MAX_ITERATIONS {
        if energy <= enough {
            break;
        }
        apply(&direction, &mut image);
        let along = energy / dot(&direction, &image);
        for k in 0..b.len() {
            x[k] += along * direction[k];
            residual[k] -= along * image[k];
            conditioned[k] = residual[k] / diagonal[k];
        }
        let next = dot(&residual, &conditioned);
        for (d, c) in direction.iter_mut().zip(&conditioned) {
            *d = *c + (next / energy) * *d;
        }
        energy = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of 2·n² triangles, every one of which wants the same area, laid out by `place` from [0, 1]².
    fn square(n: u32, place: impl Fn(DVec2) -> DVec2) -> Chart {
        let across = n + 1;
        let points = (0..across * across)
            .map(|k| place(DVec2::new((k % across).into(), (k / across).into()) / f64::from(n)))
            .collect();
        let triangles: Vec<_> = (0..n * n)
            .flat_map(|k| {
                let a = k / n * across + k % n;
                [[a, a + 1, a + across + 1], [a, a + across + 1, a + across]]
            })
            .collect();
        Chart { points, areas: vec![1.0; triangles.len()], triangles, held: Vec::new() }
    }

    fn crowded(p: DVec2) -> DVec2 {
        DVec2::new(p.x + 0.1 * (6.0 * p.x).sin() * p.y, p.y * (1.0 + 0.3 * p.y))
    }

    #[test]
    fn areas_become_even_and_no_triangle_turns_over() {
        let mut chart = square(20, crowded);
        let before = chart.error(&chart.points);
        chart.relax();
        let after = chart.error(&chart.points);
        assert!(before > 0.2 && after < EVEN, "{before} → {after}");
        assert!((0..chart.triangles.len()).all(|t| chart.area(&chart.points, t) > 0.0));
    }

    #[test]
    fn held_points_stay_and_the_others_make_up_for_them() {
        let mut chart = square(20, crowded);
        let boundary = Boundary::of(&chart.triangles, chart.points.len()).points;
        let (before, error) = (chart.points.clone(), chart.error(&chart.points));
        chart.held = vec![false; before.len()];
        boundary.iter().for_each(|&v| chart.held[v as usize] = true);
        chart.even_out();
        assert!(boundary.iter().all(|&v| chart.points[v as usize] == before[v as usize]));
        // Triangles with two corners on the boundary have one to move, those in the corners of the square none.
        assert!(chart.error(&chart.points) < 0.3 * error, "{error} → {}", chart.error(&chart.points));
    }

    /// A horseshoe whose ends want to grow into each other.
    #[test]
    fn a_boundary_does_not_grow_across_itself() {
        let bent = |p: DVec2| DVec2::from_angle(6.2 * p.x) * (2.0 - p.y);
        let mut chart = square(24, bent);
        let last = |t: usize| t % 48 >= 42 || t % 48 < 6;
        (0..chart.areas.len()).filter(|&t| last(t)).for_each(|t| chart.areas[t] = 3.0);
        let meets = |chart: &Chart| {
            !Boundary::of(&chart.triangles, chart.points.len()).meetings(&chart.points).is_empty()
        };
        let mut careless = square(24, bent);
        careless.areas.clone_from(&chart.areas);
        careless.even_out();
        assert!(meets(&careless), "without the check it would");
        let before = chart.error(&chart.points);
        chart.relax();
        assert!(!meets(&chart) && chart.error(&chart.points) < 0.5 * before);
    }
}
