//! Whole frames, everything recomputed as for a body that deforms: wall time from recording to the end of the GPU's work.

use criterion::{Criterion, criterion_group, criterion_main};
use std::time::Duration;
use translume::{
    AmbientLight, BodyDescriptor, Deformation, Frame, Light, Lighting, Method, PointLight, Translume, wgpu,
};
use translume_mesh::{Atlas, AtlasOptions, builtin};

fn frame(criterion: &mut Criterion) {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle().with_env());
    let Ok(adapter) = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
    else {
        return;
    };
    let Ok((device, queue)) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))
    else {
        return;
    };
    let Ok(translume) = Translume::new(&device) else { return };
    let mesh = builtin::creature_with(10_000);
    let lamp = PointLight { position: [-40.0, 120.0, -90.0], intensity: [2e4; 3], ..Default::default() };
    let lights = [Light::Point(lamp), Light::Ambient(AmbientLight::default())];

    let mut group = criterion.benchmark_group(format!("frame on {}", adapter.get_info().name));
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(5));
    for (size, method) in
        [(64, Method::AllPairs), (64, Method::default()), (128, Method::default()), (256, Method::default())]
    {
        let Ok(atlas) = Atlas::build(&mesh, &AtlasOptions { size, ..Default::default() }, |_| true) else {
            continue;
        };
        let descriptor = BodyDescriptor { method, mm_per_unit: 1.0, ..BodyDescriptor::new(&mesh, &atlas) };
        let Ok(mut body) = translume.create_body(&device, &descriptor) else { continue };
        let mut weight = 0.0;
        group.bench_function(format!("{size}², {method:?}"), |bencher| {
            bencher.iter(|| {
                weight = if weight > 0.5 { 0.0 } else { weight + 0.01 };
                let deformation = Deformation::Morph(&[weight]);
                let lighting = Lighting::Lights(&lights);
                let prepared =
                    body.prepare(&device, &queue, &Frame { deformation, lighting, ..Default::default() });
                assert!(prepared.is_ok(), "{prepared:?}");
                let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
                body.encode(&mut encoder);
                queue.submit([encoder.finish()]);
                device.poll(wgpu::PollType::Wait {
                    submission_index: None,
                    timeout: Some(Duration::from_secs(60)),
                })
            });
        });
    }
}

criterion_group!(benches, frame);
criterion_main!(benches);
