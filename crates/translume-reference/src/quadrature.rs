//! Adaptive one-dimensional integration.

/// Gauss–Kronrod nodes on [0, 1] (the rule is symmetric), outermost first. Every second one, from index 1, is a Gauss
/// node. Source: Kronrod 1965; the digits are those of QUADPACK's qk15.
const NODES: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_47,
    0.0,
];
const KRONROD: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_56,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
    0.209_482_141_084_727_82,
];
const GAUSS: [f64; 4] =
    [0.129_484_966_168_869_7, 0.279_705_391_489_276_64, 0.381_830_050_505_118_9, 0.417_959_183_673_469_4];

/// Halvings of an interval before its estimate is taken as it is.
const MAX_DEPTH: u32 = 40;

/// ∫ f over [from, to]. `tolerance` bounds the Gauss–Kronrod difference relative to the integral, which overstates the
/// error of the result by orders of magnitude for a smooth integrand.
pub(crate) fn integrate(f: impl Fn(f64) -> f64, from: f64, to: f64, tolerance: f64) -> f64 {
    let (first, error) = kronrod(&f, from, to);
    let mut sum = 0.0;
    let mut pending = vec![(from, to, first, error, 0)];
    while let Some((a, b, value, error, depth)) = pending.pop() {
        let outstanding: f64 = pending.iter().map(|entry| entry.2).sum();
        if error <= tolerance * (sum + outstanding + value).abs() || depth == MAX_DEPTH {
            sum += value;
            continue;
        }
        let middle = 0.5 * (a + b);
        for (a, b) in [(middle, b), (a, middle)] {
            let (value, error) = kronrod(&f, a, b);
            pending.push((a, b, value, error, depth + 1));
        }
    }
    sum
}

/// The sum of [`integrate`] over the panels between sorted `breaks`, each mapped so that square-root singularities of
/// the integrand at the breaks vanish: x = centre − half · cos u.
pub(crate) fn integrate_panels(f: impl Fn(f64) -> f64, breaks: &[f64], tolerance: f64) -> f64 {
    let panel = |from: f64, to: f64| {
        let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
        let mapped = |u: f64| f(centre - half * u.cos()) * half * u.sin();
        integrate(mapped, 0.0, std::f64::consts::PI, tolerance)
    };
    breaks.windows(2).filter(|pair| pair[1] > pair[0]).map(|pair| panel(pair[0], pair[1])).sum()
}

/// The 15-point Kronrod estimate and its distance from the embedded 7-point Gauss estimate.
fn kronrod(f: &impl Fn(f64) -> f64, from: f64, to: f64) -> (f64, f64) {
    let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (mut fine, mut coarse) = (0.0, 0.0);
    for (k, &node) in NODES.iter().enumerate() {
        let value = if node == 0.0 { f(centre) } else { f(centre - half * node) + f(centre + half * node) };
        fine += KRONROD[k] * value;
        if k % 2 == 1 {
            coarse += GAUSS[k / 2] * value;
        }
    }
    (half * fine, half * (fine - coarse).abs())
}

/// Kronrod's 15 nodes over an interval, with their weights.
#[cfg(test)]
pub(crate) fn nodes(from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> {
    let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
    let each = NODES.iter().zip(KRONROD);
    each.flat_map(move |(node, weight)| {
        let sides = if *node == 0.0 { 1 } else { 2 };
        [-1.0, 1.0].into_iter().take(sides).map(move |side| (centre + side * half * node, half * weight))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_have_their_degrees() {
        // Kronrod 15 integrates polynomials up to degree 22 exactly, its embedded Gauss 7 up to 13.
        let power = |n: i32| move |x: f64| x.powi(n);
        let (fine, difference) = kronrod(&power(12), -1.0, 1.0);
        assert!((fine - 2.0 / 13.0).abs() < 1e-15 && difference < 1e-15);
        let (fine, difference) = kronrod(&power(22), -1.0, 1.0);
        assert!((fine - 2.0 / 23.0).abs() < 1e-15, "{fine}");
        assert!(difference > 1e-6, "degree 22 is beyond the Gauss rule, and the error estimate must see it");
    }

    #[test]
    fn narrow_peak_and_root_ends() {
        let width = 1e-3;
        let peak = |x: f64| width / (width * width + x * x);
        let exact = (1.0 / width).atan() + (0.5 / width).atan();
        assert!((integrate(peak, -0.5, 1.0, 1e-10) - exact).abs() < 1e-12 * exact);
        // A quarter disc: infinite slope at x = 1.
        let disc = integrate_panels(|x: f64| (1.0 - x * x).max(0.0).sqrt(), &[0.0, 1.0], 1e-10);
        assert!((disc - std::f64::consts::FRAC_PI_4).abs() < 1e-12, "{disc}");
    }
}
