//! What recording takes of the heap: nothing beyond what wgpu takes for the same passes.

use super::{Host, bodies, lights};
use allocation_counter::measure;
use translume::{Body, Config, Deformation, Frame, Lighting, Stage, Translume, Work, wgpu};
use translume_tests::{Check, at_most, holds, notices};

/// Passes recorded by hand, with pipelines that do nothing.
struct Bare {
    compute: wgpu::ComputePipeline,
    render: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    buffer: wgpu::Buffer,
    depth: wgpu::TextureView,
}

const NOTHING: &str = "
    @group(0) @binding(0) var<uniform> word: vec4f;
    @compute @workgroup_size(1) fn nothing() { _ = word; }
    @vertex fn nowhere(@location(0) position: vec4f) -> @builtin(position) vec4f { return position + word; }";

impl Bare {
    fn new(Host { device, .. }: &Host) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(NOTHING.into()),
        });
        let uniform = wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::COMPUTE | wgpu::ShaderStages::VERTEX,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: true,
                min_binding_size: None,
            },
            count: None,
        };
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &[uniform] };
        let group_layout = device.create_bind_group_layout(&descriptor);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&group_layout)],
            immediate_size: 0,
        });
        let compute = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: Some(&layout),
            module: &module,
            entry_point: Some("nothing"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let position = wgpu::VertexBufferLayout {
            array_stride: 16,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x4],
        };
        let render = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("nowhere"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(position)],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: wgpu::TextureFormat::Depth32Float,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: None,
            multiview_mask: None,
            cache: None,
        });
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 256,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::INDEX,
            mapped_at_creation: false,
        });
        let size = wgpu::BufferSize::new(16);
        let binding = wgpu::BufferBinding { buffer: &buffer, offset: 0, size };
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &group_layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::Buffer(binding) }],
        });
        let depth = device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: 64, height: 64, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Depth32Float,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let depth = depth.create_view(&wgpu::TextureViewDescriptor::default());
        Self { compute, render, group, buffer, depth }
    }

    /// As much as a stage recorded: its draws in one pass, its dispatches in another.
    fn record(&self, encoder: &mut wgpu::CommandEncoder, Work { draws, dispatches }: Work, stage: Stage) {
        if draws > 0 {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(stage.name()),
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &self.depth,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(0.0),
                        store: wgpu::StoreOp::Store,
                    }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            for _ in 0..draws {
                pass.set_viewport(0.0, 0.0, 16.0, 16.0, 0.0, 1.0);
                pass.set_scissor_rect(0, 0, 16, 16);
                pass.set_pipeline(&self.render);
                pass.set_bind_group(0, &self.group, &[0]);
                pass.set_vertex_buffer(0, self.buffer.slice(..));
                pass.set_index_buffer(self.buffer.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..3, 0, 0..1);
            }
        }
        if dispatches > 0 {
            let descriptor =
                wgpu::ComputePassDescriptor { label: Some(stage.name()), timestamp_writes: None };
            let mut pass = encoder.begin_compute_pass(&descriptor);
            for _ in 0..dispatches {
                pass.set_pipeline(&self.compute);
                pass.set_bind_group(0, &self.group, &[0]);
                pass.dispatch_workgroups(1, 1, 1);
            }
        }
    }
}

/// Allocations of a body's stages, each against those of wgpu alone; `beside` happens while the body records.
fn stages(host: &Host, body: &mut Body, bare: &Bare, beside: impl Fn()) -> Check {
    let mut encoders = [(); 2].map(|()| host.device.create_command_encoder(&Default::default()));
    for stage in Stage::ALL {
        let mut work = Work::default();
        let [ours, theirs] = &mut encoders;
        let ours = measure(|| {
            work = body.encode_through(ours, stage);
            beside();
        });
        let theirs = measure(|| bare.record(theirs, work, stage));
        at_most(
            &format!("{}: allocations beyond wgpu's {}", stage.name(), theirs.count_total),
            ours.count_total as f64 - theirs.count_total as f64,
            0.0,
        )?;
    }
    let commands = encoders.map(wgpu::CommandEncoder::finish);
    host.queue.submit(commands);
    Ok(())
}

#[test]
fn recording_takes_nothing_of_the_heap_for_itself() {
    let host = Host::new();
    let translume = Translume::new(&host.device, &Config::default()).unwrap();
    let mut body = bodies(&host, &translume).swap_remove(1);
    let bare = Bare::new(&host);
    let mut frame = |beside: fn()| {
        let mut checks = Vec::new();
        // The first frames make what is made once, in wgpu too.
        for number in 0..4 {
            let lights = lights(number as f32);
            let deformation = Deformation::Morph(&[number as f32 * 0.1]);
            let frame = Frame { deformation, lighting: Lighting::Lights(&lights), ..Frame::default() };
            body.prepare(&host.device, &host.queue, &frame).unwrap();
            checks.push(stages(&host, &mut body, &bare, beside));
        }
        checks.pop().unwrap()
    };
    holds(frame(|| ()));
    notices(frame(|| drop(std::hint::black_box(vec![0_u8; 3]))));
}
