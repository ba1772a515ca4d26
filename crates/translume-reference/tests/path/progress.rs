//! A picture as it grows: honest errors, focus, repetition, interruption.

use super::*;

/// Mean over pixels of (squared distance of two runs) over (sum of their squared errors): 1 where errors are honest.
fn honesty(runs: &[Estimate], gain: f64) -> f64 {
    let (mut ratio, mut count) = (0.0, 0.0);
    for pair in runs.chunks_exact(2) {
        for pixel in 0..pair[0].radiance.len() {
            for k in 0..3 {
                let distance = pair[0].radiance[pixel][k] - pair[1].radiance[pixel][k];
                let claimed =
                    gain * gain * (pair[0].error[pixel][k].powi(2) + pair[1].error[pixel][k].powi(2));
                if claimed > 0.0 {
                    (ratio, count) = (ratio + distance * distance / claimed, count + 1.0);
                }
            }
        }
    }
    ratio / count
}

#[test]
fn errors_are_as_large_as_they_say() {
    let (ball, medium, lights, eye) = lit_ball();
    let tracer = PathTracer::new(&ball, medium, &lights).expect("fine");
    for is_focused in [false, true] {
        let run = |seed| {
            let mut trace = tracer.trace(eye, seed);
            trace.pass(16, |_| true);
            if is_focused {
                trace.focus();
            }
            trace.pass(128, |_| true);
            trace.estimate()
        };
        let runs: Vec<Estimate> = (0..6).map(run).collect();
        let ratio = honesty(&runs, 1.0);
        // 4,000 squares of a normal number have a mean of 1 ± 0.02; spread is a little larger where samples are few and skew.
        assert!((ratio - 1.0).abs() < 0.12, "{ratio}");
        assert!((honesty(&runs, 0.9) - 1.0).abs() > 0.12, "errors too small by a tenth must be noticed");
    }
}

/// Paths go where they are needed: less noise of as many of them, and the same mean.
#[test]
fn focus_lessens_noise_and_changes_nothing() {
    let (ball, medium, _, eye) = lit_ball();
    // From behind, where a rim is bright and the rest dark.
    let lights = [sun([0.1, 0.3, -0.95])];
    let tracer = PathTracer::new(&ball, medium, &lights).expect("fine");
    let run = |is_focused: bool| {
        let mut trace = tracer.trace(eye, 3);
        trace.pass(16, |_| true);
        if is_focused {
            trace.focus();
        }
        trace.pass(64, |_| true);
        trace.estimate()
    };
    let (even, focused) = (run(false), run(true));
    let paths =
        |estimate: &Estimate| estimate.samples.as_flattened().iter().map(|&n| f64::from(n)).sum::<f64>();
    // The even run keeps its first 16 paths and looks beside the body too.
    assert!(paths(&focused) < 0.8 * paths(&even), "{} {}", paths(&focused), paths(&even));
    assert!(focused.noise() < 0.95 * even.noise(), "{} {}", focused.noise(), even.noise());
    for k in 0..3 {
        let ([expected, error], [found, own]) = (mean(&even, k), mean(&focused, k));
        assert!(agree([found, own.hypot(error)], expected, 3.5), "{found} {expected} ± {error}");
        assert!(!agree([1.1 * found, own.hypot(error)], expected, 3.5), "a tenth must be noticed");
    }
}

/// Where one channel has no noise at all it still gets paths, and no pixel is left black.
#[test]
fn focus_leaves_nothing_black() {
    let ball = Ball { center: [0.0; 3], radius: 10.0 };
    let tracer = PathTracer::new(&ball, volume([0.1, 1.0, 6.0], [0.0; 3]), &[sky()]).expect("fine");
    let mut trace = tracer.trace(camera([0.0, 0.0, 60.0], 0.4, 24), 1);
    trace.pass(8, |_| true);
    trace.focus();
    trace.pass(2, |_| true);
    let estimate = trace.estimate();
    let inside: Vec<usize> = (0..24 * 24).filter(|&pixel| estimate.coverage[pixel] == 1.0).collect();
    assert!(inside.len() > 200);
    // The thinnest chords of the red channel let most light through; blue is opaque but for the last hundredth of a millimetre.
    assert!(inside.iter().all(|&pixel| estimate.radiance[pixel].iter().all(|c| *c > 0.0)));
    let white = inside.iter().filter(|&&pixel| estimate.radiance[pixel][2] > 0.999).count();
    assert!(white > inside.len() * 9 / 10 && white <= inside.len(), "{white} of {}", inside.len());
    assert!(estimate.samples.contains(&[0; 3]), "beside the body no paths are needed");
}

#[test]
fn runs_repeat_bit_for_bit_on_any_number_of_threads() {
    let (ball, medium, lights, eye) = lit_ball();
    let tracer = PathTracer::new(&ball, medium, &lights).expect("fine");
    let run = |threads, seed| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let mut trace = tracer.trace(eye, seed);
            trace.pass(4, |_| true);
            trace.focus();
            trace.pass(4, |_| true);
            trace.estimate()
        })
    };
    assert_eq!(run(1, 5), run(3, 5));
    assert_ne!(run(1, 5), run(1, 6));
}

#[test]
fn interrupted_pictures_are_valid() {
    let (ball, medium, lights, _) = lit_ball();
    let tracer = PathTracer::new(&ball, medium, &lights).expect("fine");
    let mut trace = tracer.trace(camera([0.0, 20.0, 60.0], 0.12, 64), 1);
    assert!(trace.pass(2, |_| true));
    let whole = trace.estimate();
    let mut heard = Vec::new();
    assert!(!trace.pass(2, |progress| {
        heard.push(progress.done);
        false
    }));
    assert_eq!(heard.len(), 1, "no more after the first no");
    let estimate = trace.estimate();
    assert!(
        heard[0] < 64 * 64
            && estimate.samples[heard[0] - 1] == [4; 3]
            && estimate.samples[heard[0]] == [2; 3]
    );
    assert_eq!(estimate.radiance[heard[0]..], whole.radiance[heard[0]..]);
    assert_ne!(estimate.radiance[..heard[0]], whole.radiance[..heard[0]]);
}
