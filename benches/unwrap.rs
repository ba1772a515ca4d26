//! From mesh to atlas, once per model: charts, relaxation, packing, raster, texel order. `TRANSLUME_MODELS` adds real scans.

use criterion::{Criterion, criterion_group, criterion_main};
use std::path::Path;
use std::time::Duration;
use translume_mesh::{Atlas, AtlasOptions, Mesh, builtin, load};

fn models() -> Vec<Mesh> {
    let mut models = vec![builtin::teapot(), builtin::torus_knot(), builtin::creature()];
    if let Some(folder) = std::env::var_os("TRANSLUME_MODELS") {
        let files = ["spot.obj", "stanford-bunny.obj"].map(|name| Path::new(&folder).join(name));
        models.extend(files.iter().filter_map(|file| load::load(file).ok()).map(|loaded| loaded.mesh));
    }
    models
}

fn unwrap(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("unwrap at 512²");
    group.sample_size(10).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_secs(4));
    for mesh in models() {
        for (label, equiareal) in [("equal areas", true), ("as flattened", false)] {
            let options = AtlasOptions { size: 512, equiareal, ..Default::default() };
            group.bench_function(format!("{}, {label}", mesh.name), |bencher| {
                bencher.iter(|| Atlas::build(&mesh, &options, |_| true));
            });
        }
    }
}

criterion_group!(benches, unwrap);
criterion_main!(benches);
