//! Results from the GPU to the CPU: for tools and tests. These functions block; a frame never calls them.

use crate::Error;
use std::time::Duration;

/// Longer than any dispatch of ours takes even on a software rasteriser.
const PATIENCE: Duration = Duration::from_secs(600);

/// The whole content of a buffer that has `COPY_SRC`.
///
/// # Errors
/// [`Error::ReadBack`] when the device is lost or does not answer within ten minutes.
pub fn buffer<T: bytemuck::Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    source: &wgpu::Buffer,
) -> Result<Vec<T>, Error> {
    let staging = staging(device, source.size());
    let mut encoder =
        device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("read back") });
    encoder.copy_buffer_to_buffer(source, 0, &staging, 0, source.size());
    queue.submit([encoder.finish()]);
    map(device, &staging, |bytes| bytemuck::pod_collect_to_vec(bytes))
}

/// Every texel of one layer of a two-dimensional texture that has `COPY_SRC`, row by row from the top.
/// `T` is one texel, as `[f32; 4]` for `Rgba32Float` or `f32` for `Depth32Float`.
///
/// # Errors
/// [`Error::ReadBack`] when the device is lost or does not answer within ten minutes.
pub fn texture<T: bytemuck::Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    source: &wgpu::Texture,
    layer: u32,
) -> Result<Vec<T>, Error> {
    let row = source.width() * size_of::<T>() as u32;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let staging = staging(device, u64::from(padded) * u64::from(source.height()));
    let mut encoder =
        device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("read back") });
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo {
            texture: source,
            mip_level: 0,
            origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
            aspect: wgpu::TextureAspect::All,
        },
        wgpu::TexelCopyBufferInfo {
            buffer: &staging,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded),
                rows_per_image: None,
            },
        },
        wgpu::Extent3d { width: source.width(), height: source.height(), depth_or_array_layers: 1 },
    );
    queue.submit([encoder.finish()]);
    map(device, &staging, |bytes| {
        bytes
            .chunks(padded as usize)
            .flat_map(|line| bytemuck::pod_collect_to_vec(&line[..row as usize]))
            .collect()
    })
}

fn staging(device: &wgpu::Device, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    })
}

fn map<R>(device: &wgpu::Device, staging: &wgpu::Buffer, read: impl FnOnce(&[u8]) -> R) -> Result<R, Error> {
    let failed = |reason: String| Error::ReadBack(reason);
    let (sender, receiver) = std::sync::mpsc::channel();
    staging.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver waits below; if it is gone nobody wants the answer.
        let _ = sender.send(result);
    });
    device
        .poll(wgpu::PollType::Wait { submission_index: None, timeout: Some(PATIENCE) })
        .map_err(|error| failed(error.to_string()))?;
    let mapped = receiver.recv_timeout(PATIENCE).map_err(|error| failed(error.to_string()))?;
    mapped.map_err(|error| failed(error.to_string()))?;
    let bytes = staging.get_mapped_range(..).map_err(|error| failed(error.to_string()))?;
    Ok(read(&bytes))
}
