//! Reading back with and without blocking.

use std::pin::pin;
use std::task::{Context, Poll, Waker};
use std::time::Duration;
use translume::wgpu::util::DeviceExt as _;
use translume::{Error, readback, wgpu};
use translume_tests::{Gpu, gpu};

/// Longer than a copy takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// As a host does that polls its device now and then.
fn awaited<T>(gpu: &Gpu, future: impl Future<Output = Result<T, Error>>) -> T {
    let mut future = pin!(future);
    let mut context = Context::from_waker(Waker::noop());
    loop {
        if let Poll::Ready(result) = future.as_mut().poll(&mut context) {
            return result.unwrap();
        }
        gpu.device.poll(wgpu::PollType::Wait { submission_index: None, timeout: Some(PATIENCE) }).unwrap();
    }
}

#[test]
fn buffers_come_back_as_they_were() {
    let gpu = gpu();
    let Gpu { device, queue, .. } = gpu;
    let read = |values: &[u32]| {
        let buffer = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("numbers"),
            contents: bytemuck::cast_slice(values),
            usage: wgpu::BufferUsages::COPY_SRC,
        });
        let blocking = readback::buffer::<u32>(device, queue, &buffer).unwrap();
        assert_eq!(awaited(gpu, readback::buffer_async::<u32>(device, queue, &buffer)), blocking);
        blocking
    };
    let values: Vec<u32> = (0..1000).map(|k| k * k).collect();
    assert_eq!(read(&values), values);
    assert_ne!(read(&[7; 1000]), values);
}

/// Rows of 7 texels are padded on their way.
#[test]
fn textures_come_back_without_the_padding_of_their_rows() {
    let gpu = gpu();
    let Gpu { device, queue, .. } = gpu;
    let texels: Vec<[f32; 4]> = (0..35).map(|k| [k as f32, 0.5, -1.0, 1e9]).collect();
    let texture = device.create_texture_with_data(
        queue,
        &wgpu::TextureDescriptor {
            label: Some("numbers"),
            size: wgpu::Extent3d { width: 7, height: 5, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Float,
            usage: wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        },
        wgpu::wgt::TextureDataOrder::LayerMajor,
        bytemuck::cast_slice(&texels),
    );
    let blocking = readback::texture::<[f32; 4]>(device, queue, &texture, 0).unwrap();
    assert_eq!(blocking, texels);
    assert_eq!(awaited(gpu, readback::texture_async::<[f32; 4]>(device, queue, &texture, 0)), texels);
}
