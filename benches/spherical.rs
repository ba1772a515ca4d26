//! From mesh to egg, once per model: coarsening, laying, checking.

use criterion::{Criterion, criterion_group, criterion_main};
use std::time::Duration;
use translume_mesh::builtin;
use translume_mesh::spherical::{EggOptions, to_egg};

fn spherical(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("spherical");
    group.sample_size(10).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_secs(4));
    for mesh in [builtin::creature_with(5_000), builtin::sphere([0.0; 3], 50.0, 5), builtin::creature()] {
        let name = format!("{}, {} triangles", mesh.name, mesh.triangles.len());
        group.bench_function(name, |bencher| {
            bencher.iter(|| to_egg(&mesh, &EggOptions::default(), |_| true));
        });
    }
}

criterion_group!(benches, spherical);
criterion_main!(benches);
