//! Whole frames of the models of Table 1 of Gong et al. 2008 in every scatter mode: a point light with a shadow, ambient light, an atlas
//! of 256², a picture of 1024².

use criterion::{Criterion, criterion_group, criterion_main};
use translume_benches::{Change, Gpu, MODES, Scene, bunny, bunny_to_egg, creature, group, teapot};

fn frame(criterion: &mut Criterion) {
    let gpu = Gpu::new();
    let still = [("static", Change::Nothing), ("camera alone", Change::Camera)];
    let morph = [("morphing", Change::Morph)];
    let all = [still[0], still[1], morph[0]];
    let mut group = group(criterion, "frame", &gpu);
    let models =
        [(Some(teapot()), &still[..]), (bunny(), &still), (bunny_to_egg(), &morph), (Some(creature()), &all)];
    for (model, changes) in &models {
        let Some(model) = model else { continue };
        for mode in MODES {
            let mut scene = Scene::new(&gpu, model, mode);
            for (name, change) in *changes {
                // What the change before left behind.
                scene.frame(*change);
                group.bench_function(format!("{}, {name}, {}", model.name, mode.name), |bencher| {
                    bencher.iter_custom(|count| (0..count).map(|_| scene.frame(*change)).sum());
                });
            }
        }
    }
}

criterion_group!(benches, frame);
criterion_main!(benches);
