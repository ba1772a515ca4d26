//! A host that draws an opaque square into every depth map.

use std::num::NonZeroU64;
use translume::{Frame, ShadowView, Work, wgpu};
use translume_tests::{Fixture, gpu};

/// Half the side of the square, and its height over the plane y = 0, world units.
pub const HALF: f32 = 20.0;
pub const HEIGHT: f32 = 30.0;
const STRIDE: u32 = 256;

const QUAD: &str = "
@group(0) @binding(0) var<uniform> view_projection: mat4x4f;

@vertex
fn vertex(@builtin(vertex_index) k: u32) -> @builtin(position) vec4f {
    let x = select(-20.0, 20.0, k == 1u || k == 4u || k == 5u);
    let z = select(-20.0, 20.0, k == 2u || k == 3u || k == 5u);
    return view_projection * vec4f(x, 30.0, z, 1.0);
}
";

/// The host's pipeline for its square.
pub struct Host {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
}

impl Host {
    pub fn new() -> Self {
        let device = &gpu().device;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("host"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: true,
                    min_binding_size: NonZeroU64::new(64),
                },
                count: None,
            }],
        });
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("host"),
            source: wgpu::ShaderSource::Wgsl(QUAD.into()),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("host"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("host"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
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
        Self { layout, pipeline }
    }

    /// One frame with the square in every map. Returns the numbers of the views in the order they were drawn.
    pub fn run(&self, fixture: &mut Fixture, frame: &Frame<'_>) -> (Work, Vec<usize>) {
        fixture.prepare(frame).unwrap();
        let views: Vec<ShadowView> = fixture.body.shadow_views().collect();
        let (device, queue) = (&gpu().device, &gpu().queue);
        let uniforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("host"),
            size: u64::from(STRIDE) * views.len().max(1) as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        for view in &views {
            let offset = u64::from(STRIDE) * view.index as u64;
            queue.write_buffer(&uniforms, offset, bytemuck::bytes_of(&view.view_projection));
        }
        let binding = wgpu::BufferBinding { buffer: &uniforms, offset: 0, size: NonZeroU64::new(64) };
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("host"),
            layout: &self.layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::Buffer(binding) }],
        });
        let mut drawn = Vec::new();
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let work = fixture.body.encode_with(&mut encoder, |pass, view| {
            drawn.push(view);
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &group, &[STRIDE * view as u32]);
            pass.draw(0..6, 0..1);
        });
        queue.submit([encoder.finish()]);
        (work, drawn)
    }
}
