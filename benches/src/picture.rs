//! A picture of the body, and how long its pass takes.

use crate::Gpu;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use translume::{Body, Camera, Composite, CompositeTarget, CompositeView, Gloss, wgpu};

/// 1024² pixels of half floats, and the timestamps of the pass that draws them.
pub struct Picture {
    composite: Composite,
    view: CompositeView,
    colour: wgpu::TextureView,
    depth: wgpu::TextureView,
    clock: Option<PassClock>,
}

const SIZE: u32 = 1024;

impl Picture {
    pub fn new(gpu: &Gpu, body: &Body) -> Self {
        let target = CompositeTarget::default();
        let composite = gpu.translume.composite(&gpu.device, target);
        let depth = target.depth.map_or(wgpu::TextureFormat::Depth32Float, |(format, _)| format);
        Self {
            view: composite.view(&gpu.device, body),
            composite,
            colour: attachment(&gpu.device, target.format),
            depth: attachment(&gpu.device, depth),
            clock: gpu.has_timestamps.then(|| PassClock::new(gpu)),
        }
    }

    pub fn prepare(&mut self, gpu: &Gpu, body: &Body, camera: &Camera) {
        self.view.prepare(&gpu.device, &gpu.queue, body, camera, Gloss::None);
    }

    pub fn draw(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(clock) = &self.clock {
            clock.start(encoder);
        }
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("composite"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &self.colour,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &self.depth,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(1.0),
                        store: wgpu::StoreOp::Discard,
                    }),
                    stencil_ops: None,
                }),
                timestamp_writes: self.clock.as_ref().map(PassClock::writes),
                ..Default::default()
            });
            self.composite.draw(&mut pass, &self.view);
        }
        if let Some(clock) = &self.clock {
            clock.resolve(encoder);
        }
    }

    /// How long the pass of the last submission took, once that has ended.
    pub fn time(&self) -> Option<Duration> {
        self.clock.as_ref()?.read()
    }
}

fn attachment(device: &wgpu::Device, format: wgpu::TextureFormat) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture"),
        size: wgpu::Extent3d { width: SIZE, height: SIZE, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// Timestamps of a pass of the host, for one submission at a time.
struct PassClock {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    read_back: wgpu::Buffer,
    is_mapped: Arc<AtomicBool>,
    period: f32,
}

impl PassClock {
    fn new(gpu: &Gpu) -> Self {
        let buffer = |usage| {
            let label = Some("timestamps");
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label,
                size: 24,
                usage,
                mapped_at_creation: false,
            })
        };
        Self {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("composite"),
                ty: wgpu::QueryType::Timestamp,
                count: 3,
            }),
            resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            read_back: buffer(wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ),
            is_mapped: Arc::default(),
            period: gpu.queue.get_timestamp_period(),
        }
    }

    /// An empty pass whose timestamp Mesa's software driver takes when that of the next pass begins, as the library's stages have it.
    fn start(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("start"),
            timestamp_writes: Some(wgpu::ComputePassTimestampWrites {
                query_set: &self.queries,
                beginning_of_pass_write_index: Some(0),
                end_of_pass_write_index: None,
            }),
        });
    }

    fn writes(&self) -> wgpu::RenderPassTimestampWrites<'_> {
        wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(1),
            end_of_pass_write_index: Some(2),
        }
    }

    fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..3, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.read_back, 0, 24);
        let is_mapped = Arc::clone(&self.is_mapped);
        encoder.map_buffer_on_submit(&self.read_back, wgpu::MapMode::Read, .., move |mapped| {
            is_mapped.store(mapped.is_ok(), Ordering::Release);
        });
    }

    fn read(&self) -> Option<Duration> {
        if !self.is_mapped.swap(false, Ordering::Acquire) {
            return None;
        }
        let ticks = self.read_back.get_mapped_range(..).ok();
        let ticks: Option<[u64; 3]> = ticks.map(|bytes| bytemuck::pod_read_unaligned(&bytes));
        self.read_back.unmap();
        let [start, begin, end] = ticks?;
        // Metal leaves that of an empty pass at 0.
        let begin = if start > 0 { start } else { begin };
        let ticks = end.checked_sub(begin).filter(|_| begin > 0)?;
        Some(Duration::from_nanos((ticks as f64 * f64::from(self.period)) as u64))
    }
}
