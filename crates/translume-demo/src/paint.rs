//! Draws a body in colours of its texels: charts, density, error.
//!
//! reads  deformed positions, a colour for each pixel of the atlas      writes  a canvas      WGSL    `paint.wgsl`

use crate::canvas::Canvas;
use crate::gpu::Gpu;
use translume::wgpu::util::DeviceExt as _;
use translume::{Body, Camera, wgpu};
use translume_mesh::Atlas;

/// The pipeline.
pub struct Painter {
    pipeline: wgpu::RenderPipeline,
}

/// One body's vertices in the order of its atlas.
pub struct Outlines {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    count: u32,
}

impl Outlines {
    pub fn new(device: &wgpu::Device, atlas: &Atlas) -> Self {
        let words = atlas.vertices.iter().flat_map(|vertex| {
            let [u, v] = vertex.uv;
            [vertex.xref, u.to_bits(), v.to_bits()].map(u32::to_le_bytes)
        });
        let vertices: Vec<u8> = words.flatten().collect();
        let indices: Vec<u8> =
            atlas.triangles.as_flattened().iter().copied().flat_map(u32::to_le_bytes).collect();
        let buffer = |label, contents: &[u8], usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some(label),
                contents,
                usage,
            })
        };
        Self {
            vertices: buffer("atlas vertices", &vertices, wgpu::BufferUsages::STORAGE),
            indices: buffer("atlas triangles", &indices, wgpu::BufferUsages::INDEX),
            count: 3 * atlas.triangles.len() as u32,
        }
    }
}

impl Painter {
    pub fn new(device: &wgpu::Device) -> Self {
        let module = device.create_shader_module(wgpu::include_wgsl!("paint.wgsl"));
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("paint"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: Canvas::DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Less),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("paint"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(Canvas::FORMAT.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { pipeline }
    }

    /// Draws a body, prepared and encoded before, in linear `colours`, one for each pixel of the atlas.
    pub fn paint(
        &self,
        gpu: &Gpu,
        canvas: &Canvas,
        (body, outlines): (&Body, &Outlines),
        (camera, mm_per_unit): (&Camera, f32),
        (size, colours): (u32, &[[u8; 4]]),
    ) {
        let Gpu { device, queue, .. } = gpu;
        let extent = wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 1 };
        let texture = device.create_texture_with_data(
            queue,
            &wgpu::TextureDescriptor {
                label: Some("colours"),
                size: extent,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba8UnormSrgb,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            },
            wgpu::wgt::TextureDataOrder::LayerMajor,
            colours.as_flattened(),
        );
        let to_world = glam::Mat4::from_scale(glam::Vec3::splat(1.0 / mm_per_unit));
        let to_clip = glam::Mat4::from_cols_array_2d(&camera.view_projection) * to_world;
        let mut words: Vec<f32> = to_clip.to_cols_array().to_vec();
        words.extend(camera.eye.map(|x| x * mm_per_unit));
        words.push(0.0);
        let bytes: Vec<u8> = words.into_iter().flat_map(f32::to_le_bytes).collect();
        let view = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("view"),
            contents: &bytes,
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let texture = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("paint"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: view.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: body.outputs().positions.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: outlines.vertices.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 3, resource: wgpu::BindingResource::TextureView(&texture) },
            ],
        });
        let mut encoder =
            device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("paint") });
        canvas.pass(&mut encoder, |pass| {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.set_index_buffer(outlines.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..outlines.count, 0, 0..1);
        });
        queue.submit([encoder.finish()]);
    }
}
