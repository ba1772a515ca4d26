//! Results from the GPU to the CPU: for tools and tests, as a frame never calls them.
//!
//! [`buffer`] and [`texture`] block, which a browser does not allow; [`buffer_async`] and [`texture_async`] are their twins for it.

use crate::Error;
use std::future::poll_fn;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Poll, Waker};

/// The whole content of a buffer that has `COPY_SRC`.
///
/// # Errors
/// [`Error::ReadBack`] when the device is lost or does not answer within ten minutes.
#[cfg(not(target_arch = "wasm32"))]
pub fn buffer<T: bytemuck::Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    source: &wgpu::Buffer,
) -> Result<Vec<T>, Error> {
    let copy = Download::of_buffer(device, queue, source);
    blocking::wait(device, &copy.staging)?;
    copy.read()
}

/// Every texel of one layer of a two-dimensional texture that has `COPY_SRC`, row by row from the top.
/// `T` is one texel, as `[f32; 4]` for `Rgba32Float` or `f32` for `Depth32Float`.
///
/// # Errors
/// [`Error::ReadBack`] when the device is lost or does not answer within ten minutes.
#[cfg(not(target_arch = "wasm32"))]
pub fn texture<T: bytemuck::Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    source: &wgpu::Texture,
    layer: u32,
) -> Result<Vec<T>, Error> {
    let copy = Download::of_texture::<T>(device, queue, source, layer);
    blocking::wait(device, &copy.staging)?;
    copy.read()
}

/// What [`buffer`](fn@buffer) returns, without blocking. A browser polls the device on its own; elsewhere the host must do so for the future to
/// end.
///
/// # Errors
/// [`Error::ReadBack`] when the device is lost.
pub async fn buffer_async<T: bytemuck::Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    source: &wgpu::Buffer,
) -> Result<Vec<T>, Error> {
    let copy = Download::of_buffer(device, queue, source);
    mapped(&copy.staging).await?;
    copy.read()
}

/// What [`texture`](fn@texture) returns, without blocking. A browser polls the device on its own; elsewhere the host must do so for the future
/// to end.
///
/// # Errors
/// [`Error::ReadBack`] when the device is lost.
pub async fn texture_async<T: bytemuck::Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    source: &wgpu::Texture,
    layer: u32,
) -> Result<Vec<T>, Error> {
    let copy = Download::of_texture::<T>(device, queue, source, layer);
    mapped(&copy.staging).await?;
    copy.read()
}

/// A copy that the CPU can read once the GPU has made it: rows of `row` bytes, `pitch` bytes apart.
struct Download {
    staging: wgpu::Buffer,
    row: usize,
    pitch: usize,
}

impl Download {
    fn of_buffer(device: &wgpu::Device, queue: &wgpu::Queue, source: &wgpu::Buffer) -> Self {
        let staging = staging(device, source.size());
        let mut encoder = encoder(device);
        encoder.copy_buffer_to_buffer(source, 0, &staging, 0, source.size());
        queue.submit([encoder.finish()]);
        let row = source.size() as usize;
        Self { staging, row, pitch: row }
    }

    fn of_texture<T>(device: &wgpu::Device, queue: &wgpu::Queue, source: &wgpu::Texture, layer: u32) -> Self {
        let row = source.width() * size_of::<T>() as u32;
        let pitch = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let staging = staging(device, u64::from(pitch) * u64::from(source.height()));
        let mut encoder = encoder(device);
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
                    bytes_per_row: Some(pitch),
                    rows_per_image: None,
                },
            },
            wgpu::Extent3d { width: source.width(), height: source.height(), depth_or_array_layers: 1 },
        );
        queue.submit([encoder.finish()]);
        Self { staging, row: row as usize, pitch: pitch as usize }
    }

    /// Once it is mapped.
    fn read<T: bytemuck::Pod>(&self) -> Result<Vec<T>, Error> {
        let bytes = self.staging.get_mapped_range(..).map_err(failed)?;
        let rows = bytes.chunks(self.pitch.max(1));
        Ok(rows.map(|row| bytemuck::pod_collect_to_vec(&row[..self.row])).collect::<Vec<_>>().concat())
    }
}

fn encoder(device: &wgpu::Device) -> wgpu::CommandEncoder {
    device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("read back") })
}

fn staging(device: &wgpu::Device, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    })
}

fn failed(error: impl std::fmt::Display) -> Error {
    Error::ReadBack(error.to_string())
}

/// Ends when the CPU can read the buffer.
async fn mapped(staging: &wgpu::Buffer) -> Result<(), Error> {
    #[derive(Default)]
    struct Answer {
        result: Option<Result<(), wgpu::BufferAsyncError>>,
        waker: Option<Waker>,
    }
    let answer = Arc::new(Mutex::new(Answer::default()));
    let told = Arc::clone(&answer);
    staging.map_async(wgpu::MapMode::Read, .., move |result| {
        let mut answer = told.lock().unwrap_or_else(PoisonError::into_inner);
        answer.result = Some(result);
        answer.waker.take().into_iter().for_each(Waker::wake);
    });
    let ready = poll_fn(|context| {
        let mut answer = answer.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(result) = answer.result.take() {
            return Poll::Ready(result);
        }
        answer.waker = Some(context.waker().clone());
        Poll::Pending
    });
    ready.await.map_err(failed)
}

#[cfg(not(target_arch = "wasm32"))]
mod blocking {
    use super::failed;
    use crate::Error;
    use std::sync::mpsc::channel;
    use std::time::Duration;

    /// Longer than any dispatch of ours takes even on a software rasteriser.
    const PATIENCE: Duration = Duration::from_secs(600);

    /// Until the CPU can read the buffer.
    pub fn wait(device: &wgpu::Device, staging: &wgpu::Buffer) -> Result<(), Error> {
        let (sender, receiver) = channel();
        staging.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver waits below; if it is gone nobody wants the answer.
            let _ = sender.send(result);
        });
        let patience = wgpu::PollType::Wait { submission_index: None, timeout: Some(PATIENCE) };
        device.poll(patience).map_err(failed)?;
        receiver.recv_timeout(PATIENCE).map_err(failed)?.map_err(failed)
    }
}
