//! Groups at both ends of the sum, against all pairs.

use translume::{DirectionalLight, Light, Medium, Method, readback};
use translume_tests::{Fixture, Pose, creature, gpu, sphere_with};

const MEDIA: [&str; 5] = ["skimmilk", "marble", "skin1", "ketchup", "spectralon"];

fn sun() -> [Light; 1] {
    [Light::Directional(DirectionalLight { to_light: [0.3, 0.7, 0.6], ..Default::default() })]
}

/// Radiant exitance of each texel, and the kernel evaluations it took.
fn show(fixture: &mut Fixture, method: Method) -> Vec<[f32; 4]> {
    fixture.body.set_method(method).unwrap();
    let targets = fixture.model.mesh.targets.len();
    fixture.run(&Pose::rest(targets).frame(&sun()));
    readback::buffer(&gpu().device, &gpu().queue, fixture.body.outputs().exitance).unwrap()
}

/// Chunks taken and receivers without room.
fn lists(fixture: &Fixture) -> [u32; 2] {
    let lists = fixture.body.outputs().lists.expect("the method was dual");
    let words: Vec<u32> = readback::buffer(&gpu().device, &gpu().queue, lists).unwrap();
    [words[0], words[1]]
}

/// How far a result is from the exact one, over the mean of the latter; of the worst channel.
#[derive(Clone, Copy, Debug, Default)]
struct Figures {
    rmse: f64,
    /// What 99 % of the texels stay below.
    most: f64,
    bias: f64,
    /// Kernel evaluations per texel.
    evaluations: f64,
}

fn figures(measured: &[[f32; 4]], exact: &[[f32; 4]]) -> Figures {
    assert_eq!(measured.len(), exact.len());
    let count = exact.len() as f64;
    let mut worst = Figures {
        evaluations: measured.iter().map(|b| f64::from(b[3])).sum::<f64>() / count,
        ..Default::default()
    };
    for channel in 0..3 {
        let pairs = measured.iter().zip(exact).map(|(a, b)| [f64::from(a[channel]), f64::from(b[channel])]);
        let mean = pairs.clone().map(|[_, b]| b).sum::<f64>() / count;
        let mut errors: Vec<f64> = pairs.map(|[a, b]| (a - b) / mean).collect();
        worst.bias = worst.bias.max((errors.iter().sum::<f64>() / count).abs());
        worst.rmse = worst.rmse.max((errors.iter().map(|e| e * e).sum::<f64>() / count).sqrt());
        errors.iter_mut().for_each(|e| *e = e.abs());
        errors.sort_by(f64::total_cmp);
        worst.most = worst.most.max(errors[(0.99 * count) as usize]);
    }
    worst
}

#[test]
#[ignore]
fn explore() {
    for (name, model, scale) in
        [("creature", creature(), 1.0), ("creature/10", creature(), 0.1), ("sphere", sphere_with(64), 0.1)]
    {
        for medium in MEDIA {
            let mut fixture = Fixture::new(&model, |d| {
                d.medium = Medium::preset(medium).unwrap();
                d.mm_per_unit = scale;
            });
            let exact = show(&mut fixture, Method::AllPairs);
            let tree = figures(&show(&mut fixture, Method::Tree { theta: 0.4 }), &exact);
            print!("{name:12} {medium:10} tree {:.3}% |", 100.0 * tree.rmse);
            for theta in [0.4, 0.5, 0.6, 0.7, 0.8, 1.0] {
                let f = figures(&show(&mut fixture, Method::Dual { theta }), &exact);
                let [c, o] = lists(&fixture);
                print!(
                    "  {theta}: {:.2} {:.2} {:.2}% {:.0}ev {:.1}w {o}",
                    100.0 * f.rmse,
                    100.0 * f.most,
                    100.0 * f.bias,
                    f.evaluations,
                    c as f64 * 8.0 / exact.len() as f64
                );
            }
            println!();
        }
    }
}
