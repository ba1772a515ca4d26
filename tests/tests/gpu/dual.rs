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

/// Words taken and receivers without room.
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
            for theta in [0.4, 0.6, 0.7, 0.8, 0.9] {
                let f = figures(&show(&mut fixture, Method::Dual { theta }), &exact);
                let [c, o] = lists(&fixture);
                print!(
                    "  {theta}: {:.2} {:.2} {:.2}% {:.0}ev {:.1}w {o}",
                    100.0 * f.rmse,
                    100.0 * f.most,
                    100.0 * f.bias,
                    f.evaluations,
                    c as f64 / exact.len() as f64
                );
            }
            println!();
        }
    }
}

/// CPU seconds of this process, all threads.
fn cpu() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap().split_whitespace().collect();
    (fields[11].parse::<f64>().unwrap() + fields[12].parse::<f64>().unwrap()) / 100.0
}

fn timed(fixture: &mut Fixture, method: Method, repeats: u32) -> [f64; 2] {
    use translume::{Stage, wgpu};
    let wait = || {
        gpu().device.poll(wgpu::PollType::Wait { submission_index: None, timeout: None }).unwrap();
    };
    let targets = fixture.model.mesh.targets.len();
    let (mut spent, mut wall) = (0.0, f64::INFINITY);
    for k in 0..=repeats {
        fixture.body.set_method(Method::AllPairs).unwrap();
        fixture.prepare(&Pose::rest(targets).frame(&sun())).unwrap();
        fixture.body.set_method(method).unwrap();
        fixture.prepare(&Pose::rest(targets).frame(&sun())).unwrap();
        let mut encoder = gpu().device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        fixture.body.encode_through(&mut encoder, Stage::Cluster);
        gpu().queue.submit([encoder.finish()]);
        wait();
        let (before, start) = (cpu(), std::time::Instant::now());
        let mut encoder = gpu().device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        fixture.body.encode_through(&mut encoder, Stage::Scatter);
        gpu().queue.submit([encoder.finish()]);
        wait();
        if k > 0 {
            spent += cpu() - before;
            wall = wall.min(start.elapsed().as_secs_f64());
        }
    }
    [1e3 * spent / f64::from(repeats), 1e3 * wall]
}

#[test]
#[ignore]
fn full_size() {
    use translume_mesh::builtin;
    use translume_tests::Model;
    let sizes = std::env::var("SIZES").unwrap_or_else(|_| "256".to_owned());
    let angles = std::env::var("ANGLES").unwrap_or_else(|_| "0.5 0.6 0.7".to_owned());
    let media = std::env::var("MEDIA").unwrap_or_else(|_| "skimmilk skin1".to_owned());
    let angles: Vec<f32> = angles.split(' ').map(|a| a.parse().unwrap()).collect();
    for size in sizes.split(' ').map(|s| s.parse().unwrap()) {
        let model = Model::new(builtin::creature(), size);
        for medium in media.split(' ') {
            let mut fixture = Fixture::new(&model, |d| d.medium = Medium::preset(medium).unwrap());
            let cache = format!("/tmp/exact-{size}-{medium}.bin");
            let exact: Vec<[f32; 4]> = match std::fs::read(&cache) {
                Ok(bytes) => bytemuck::pod_collect_to_vec(&bytes),
                Err(_) => {
                    let exact = show(&mut fixture, Method::Tree { theta: 0.15 });
                    std::fs::write(&cache, bytemuck::cast_slice(&exact)).unwrap();
                    exact
                }
            };
            let tree = Method::Tree { theta: 0.4 };
            print!("{size}² {} texels {medium} ", exact.len());
            if std::env::var("TREE").is_ok() {
                let f = figures(&show(&mut fixture, tree), &exact);
                let [cpu, wall] = timed(&mut fixture, tree, 5);
                print!("tree .4: {:.3}% {cpu:.0} CPU-ms {wall:.0} ms", 100.0 * f.rmse);
            }
            println!();
            for &theta in &angles {
                let dual = Method::Dual { theta };
                let f = figures(&show(&mut fixture, dual), &exact);
                let [c, o] = lists(&fixture);
                let [cpu, wall] =
                    timed(&mut fixture, dual, std::env::var("REPEATS").map_or(5, |r| r.parse().unwrap()));
                println!(
                    "   dual {theta}: rmse {:.3} p99 {:.2} bias {:.3}% {:.1} ev {:.1} w {o} | {cpu:.0} CPU-ms {wall:.0} ms",
                    100.0 * f.rmse,
                    100.0 * f.most,
                    100.0 * f.bias,
                    f.evaluations,
                    c as f64 / exact.len() as f64
                );
            }
        }
    }
}
