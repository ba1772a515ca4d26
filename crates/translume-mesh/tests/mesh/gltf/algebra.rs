//! Matrices and quaternions in double precision, for [`reference`](super::reference).

/// Column-major.
pub type Matrix = [[f64; 4]; 4];

pub const IDENTITY: Matrix =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

pub fn product(a: Matrix, b: Matrix) -> Matrix {
    std::array::from_fn(|c| std::array::from_fn(|r| (0..4).map(|k| a[k][r] * b[c][k]).sum()))
}

pub fn transform(m: Matrix, p: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|r| m[0][r] * p[0] + m[1][r] * p[1] + m[2][r] * p[2] + m[3][r])
}

/// T · R · S; the columns of R are the turned axes, q v q*.
pub fn trs(translation: &[f64], rotation: &[f64], scale: &[f64]) -> Matrix {
    let q = normalized(rotation);
    let axis = |k: usize| {
        let mut v = [0.0; 3];
        v[k] = 1.0;
        // v + 2 w (u × v) + 2 u × (u × v), with q = (u, w).
        let u = [q[0], q[1], q[2]];
        let once = cross(u, v);
        let twice = cross(u, once);
        let turned: [f64; 3] = std::array::from_fn(|r| v[r] + 2.0 * (q[3] * once[r] + twice[r]));
        [turned[0] * scale[k], turned[1] * scale[k], turned[2] * scale[k], 0.0]
    };
    [axis(0), axis(1), axis(2), [translation[0], translation[1], translation[2], 1.0]]
}

pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn normalized(q: &[f64]) -> Vec<f64> {
    let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    q.iter().map(|x| x / length).collect()
}

/// The specification, appendix C, spherical linear interpolation.
pub fn slerp(t: f64, from: &[f64], to: &[f64]) -> Vec<f64> {
    let [from, to] = [normalized(from), normalized(to)];
    let dot: f64 = from.iter().zip(&to).map(|(a, b)| a * b).sum();
    let (a, s) = (dot.abs().min(1.0).acos(), dot.signum());
    let (f, g) =
        if a < 1e-6 { (1.0 - t, t) } else { ((a * (1.0 - t)).sin() / a.sin(), (a * t).sin() / a.sin()) };
    from.iter().zip(&to).map(|(x, y)| f * x + s * g * y).collect()
}

/// The specification, appendix C, cubic spline interpolation.
pub fn hermite(t: f64, span: f64, from: &[f64], out: &[f64], to: &[f64], into: &[f64]) -> Vec<f64> {
    let f = [
        2.0 * t.powi(3) - 3.0 * t.powi(2) + 1.0,
        span * (t.powi(3) - 2.0 * t.powi(2) + t),
        -2.0 * t.powi(3) + 3.0 * t.powi(2),
        span * (t.powi(3) - t.powi(2)),
    ];
    (0..from.len()).map(|k| f[0] * from[k] + f[1] * out[k] + f[2] * to[k] + f[3] * into[k]).collect()
}
