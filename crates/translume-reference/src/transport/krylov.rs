//! Few-step GMRES (Saad and Schultz 1986) for all channels at once, each with its own small least squares.
//!
//! Unknowns and rows are scaled by √A over φ_Q^¾: a body lit from behind is dark where it is seen, and errors there must count.

use rayon::prelude::*;

use super::equation::Equation;

type Rgb = [f64; 3];

/// What is darker than this share of the brightest weighs no more.
const DARK: f64 = 1e-5;
/// A residual below this share is rounding.
const ENOUGH: f64 = 1e-9;

/// The fluence after so many applications of the equation, and the share of what is given that it leaves, channel by channel.
pub(super) fn solve(equation: &Equation, given: &[Rgb], steps: usize) -> (Vec<Rgb>, Rgb) {
    let most = given.iter().fold([0.0; 3], |most: Rgb, given| each(|k| most[k].max(given[k])));
    let scaled = |(index, given): (usize, &Rgb)| -> Rgb {
        let root = equation.area(index).sqrt();
        each(|k| if most[k] > 0.0 { root / given[k].max(DARK * most[k]).powf(0.75) } else { 0.0 })
    };
    let scale: Vec<Rgb> = given.iter().enumerate().map(scaled).collect();
    let weighed = |values: &[Rgb]| -> Vec<Rgb> {
        values.iter().zip(&scale).map(|(value, scale)| each(|k| value[k] * scale[k])).collect()
    };
    let unweighed = |values: &[Rgb]| -> Vec<Rgb> {
        let plain =
            |(value, scale): (&Rgb, &Rgb)| each(|k| if scale[k] > 0.0 { value[k] / scale[k] } else { 0.0 });
        values.iter().zip(&scale).map(plain).collect()
    };
    let right = weighed(given);
    let norm = length(&right);
    let mut basis = vec![over(&right, norm)];
    let mut columns: Vec<Vec<Rgb>> = Vec::new();
    let (mut weights, mut residual) = ([Vec::new(), Vec::new(), Vec::new()], [1.0; 3]);
    for step in 0..steps {
        let mut next = weighed(&equation.apply(&unweighed(&basis[step])));
        let mut column = Vec::new();
        for direction in &basis {
            let along = dot(&next, direction);
            let apart =
                |(next, direction): (&mut Rgb, &Rgb)| (0..3).for_each(|k| next[k] -= along[k] * direction[k]);
            next.iter_mut().zip(direction).for_each(apart);
            column.push(along);
        }
        let rest = length(&next);
        column.push(rest);
        columns.push(column);
        basis.push(over(&next, rest));
        for k in 0..3 {
            (weights[k], residual[k]) = least_squares(&columns, k, norm[k]);
        }
        if residual.iter().all(|&share| share < ENOUGH) {
            break;
        }
    }
    let sum = |index: usize| each(|k| weights[k].iter().zip(&basis).map(|(y, v)| y * v[index][k]).sum());
    let mut fluence = unweighed(&(0..given.len()).map(sum).collect::<Vec<_>>());
    extend(equation, given, &mut fluence);
    (fluence, residual)
}

/// Sites without an area are no unknowns: their rows give their fluence.
fn extend(equation: &Equation, given: &[Rgb], fluence: &mut [Rgb]) {
    let without: Vec<usize> = (0..equation.len()).filter(|&index| equation.area(index) <= 0.0).collect();
    if without.is_empty() {
        return;
    }
    let left = equation.apply(fluence);
    for index in without {
        fluence[index] =
            each(|k| fluence[index][k] + (given[index][k] - left[index][k]) / equation.closure(index));
    }
}

fn each(of: impl Fn(usize) -> f64) -> Rgb {
    [of(0), of(1), of(2)]
}

fn dot(a: &[Rgb], b: &[Rgb]) -> Rgb {
    let add = |sum: Rgb, other: Rgb| each(|k| sum[k] + other[k]);
    a.par_iter().zip(b).map(|(a, b)| each(|k| a[k] * b[k])).reduce(|| [0.0; 3], add)
}

fn length(a: &[Rgb]) -> Rgb {
    dot(a, a).map(f64::sqrt)
}

fn over(a: &[Rgb], length: Rgb) -> Vec<Rgb> {
    a.iter().map(|a| each(|k| if length[k] > 0.0 { a[k] / length[k] } else { 0.0 })).collect()
}

/// The combination of directions that leaves least of a right side of length `norm`, and the share it leaves: Givens rotations.
fn least_squares(columns: &[Vec<Rgb>], channel: usize, norm: f64) -> (Vec<f64>, f64) {
    let count = columns.len();
    let entry = |row: usize, column: usize| columns[column].get(row).map_or(0.0, |entry| entry[channel]);
    let mut matrix: Vec<Vec<f64>> =
        (0..=count).map(|row| (0..count).map(|column| entry(row, column)).collect()).collect();
    let mut right = vec![0.0; count + 1];
    right[0] = norm;
    for c in 0..count {
        let r = matrix[c][c].hypot(matrix[c + 1][c]);
        if r == 0.0 {
            continue;
        }
        let (cos, sin) = (matrix[c][c] / r, matrix[c + 1][c] / r);
        let turn = |upper: f64, lower: f64| (cos * upper + sin * lower, cos * lower - sin * upper);
        let (upper, lower) = matrix.split_at_mut(c + 1);
        for (upper, lower) in upper[c].iter_mut().zip(&mut lower[0]).skip(c) {
            (*upper, *lower) = turn(*upper, *lower);
        }
        (right[c], right[c + 1]) = turn(right[c], right[c + 1]);
    }
    let mut weights = vec![0.0; count];
    for c in (0..count).rev() {
        let known: f64 = (c + 1..count).map(|column| matrix[c][column] * weights[column]).sum();
        weights[c] = if matrix[c][c] == 0.0 { 0.0 } else { (right[c] - known) / matrix[c][c] };
    }
    let residual = if norm > 0.0 { right[count].abs() / norm } else { 0.0 };
    (weights, residual)
}
