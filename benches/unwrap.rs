//! From mesh to atlas, once per model: charts, packing, raster, texel order.

use criterion::{Criterion, criterion_group, criterion_main};
use std::time::Duration;
use translume_mesh::{Atlas, AtlasOptions, builtin};

fn unwrap(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("unwrap");
    group.sample_size(10).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_secs(4));
    let options = AtlasOptions { size: 256, ..Default::default() };
    for mesh in [builtin::teapot(), builtin::sphere([0.0; 3], 50.0, 4), builtin::torus_knot()] {
        group.bench_function(&mesh.name, |bencher| bencher.iter(|| Atlas::build(&mesh, &options, |_| true)));
    }
}

criterion_group!(benches, unwrap);
criterion_main!(benches);
