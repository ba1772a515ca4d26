//! Every stage on its own: the creature morphs, in an atlas of 256².

use criterion::{Criterion, criterion_group, criterion_main};
use translume::{Method, Stage};
use translume_benches::{Gpu, METHODS, MODES, Scene, creature, group, small_creature};

fn stages(criterion: &mut Criterion) {
    let gpu = Gpu::new();
    let mut group = group(criterion, "stage", &gpu);
    let mut bench = |name: &str, scene: &mut Scene<'_>, stage| {
        group.bench_function(name, |bencher| {
            bencher.iter_custom(|count| (0..count).map(|_| scene.stage(stage)).sum());
        });
    };
    let mut scene = Scene::new(&gpu, &creature(), &MODES[0]);
    for stage in [Stage::Deform, Stage::Shadow, Stage::Gather, Stage::Cluster, Stage::Resolve] {
        bench(stage.name(), &mut scene, stage);
    }
    for (name, method) in METHODS {
        scene.set_method(*method);
        bench(&format!("scatter, {name}"), &mut scene, Stage::Scatter);
    }
    scene.shadow_sky(true);
    bench("visibility", &mut scene, Stage::Visibility);

    let mut small = Scene::new(&gpu, &small_creature(), &MODES[0]);
    for (name, method) in METHODS.iter().chain(&[("all pairs", Method::AllPairs)]) {
        small.set_method(*method);
        bench(&format!("scatter at 64², {name}"), &mut small, Stage::Scatter);
    }
}

criterion_group!(benches, stages);
criterion_main!(benches);
