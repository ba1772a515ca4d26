//! Shadow: the depth of the deformed mesh, and of the host's casters, seen from lights and from the sky.
//!
//! reads  positions, triangles                              writes  a square of depth per view
//! twin   `translume_reference::Surface`, by tracing rays   WGSL    `shadow.wgsl`

use crate::buffers::Buffers;
use crate::gpu::{self, UNIFORM_ARRAY, UNIFORM_STRIDE};
use crate::shadow_view::View;
use crate::stages::Stage;
use crate::timings::Recording;
use glam::Mat4;
use std::sync::Arc;

pub(crate) struct Shadow {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
}

/// Square layers of depth.
pub(crate) struct DepthLayers {
    pub texture: wgpu::Texture,
    pub sampled: wgpu::TextureView,
    layers: Vec<wgpu::TextureView>,
}

/// Depth maps, and the uniforms they are drawn with.
pub(crate) struct DepthMaps {
    pub layers: Arc<DepthLayers>,
    uniforms: wgpu::Buffer,
    group: wgpu::BindGroup,
}

/// What the host has to know of a view to draw its casters into it.
///
/// ```no_run
/// # fn example(device: &translume::wgpu::Device, queue: &translume::wgpu::Queue, body: &mut translume::Body) -> Result<(), translume::Error> {
/// // Matrices for the host's casters, before `encode_with` draws them.
/// let matrices: Vec<_> = body.shadow_views().map(|view| view.view_projection).collect();
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowView {
    /// World space to clip space, column-major. Depth is reversed: 1 at the near plane, 0 at the far one, greater is nearer.
    pub view_projection: [[f32; 4]; 4],
    /// Its number among those of the next frame, from 0. Those that share a layer of the depth maps are drawn together, so not always in
    /// this order.
    pub index: usize,
    /// Which of the frame's lights it belongs to; `None` for the sky.
    pub light: Option<usize>,
}

/// The host's share of a shadow pass: gets the pass with viewport and scissor set to the view's square.
pub(crate) type DrawCasters<'a> = &'a mut dyn FnMut(&mut wgpu::RenderPass<'_>, usize);

impl Shadow {
    pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

    pub fn new(device: &wgpu::Device) -> Self {
        let layout = gpu::layout(device, "shadow", wgpu::ShaderStages::VERTEX, &[UNIFORM_ARRAY]);
        let module = gpu::module(device, translume_shaders::SHADOW);
        let position = wgpu::VertexBufferLayout {
            array_stride: 16,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x4],
        };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("shadow"),
            layout: Some(&gpu::pipeline_layout(device, "shadow", &[&layout])),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(position)],
            },
            // Both sides cast shadows: scans are open, and a body may be turned inside out.
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: Self::FORMAT,
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

    /// These layers, and room for the uniforms of `views`.
    pub fn depth_maps(&self, device: &wgpu::Device, layers: Arc<DepthLayers>, views: u64) -> DepthMaps {
        let uniforms = gpu::uniform_buffer(device, "shadow views", UNIFORM_STRIDE * views);
        let group = gpu::bind(device, "shadow", &self.layout, &[gpu::uniform_slot::<Mat4>(&uniforms)]);
        DepthMaps { layers, uniforms, group }
    }

    /// Draws the views, whose uniforms begin at slot `first`, for a stage: a pass for each layer, a draw for each view.
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        (stage, recording): (Stage, &mut Recording<'_>),
        maps: &DepthMaps,
        (first, views): (usize, &[View]),
        (buffers, indices): (&Buffers, u32),
        casters: DrawCasters<'_>,
    ) {
        for (number, layer) in (0..).zip(&maps.layers.layers) {
            let mut here = (first..).zip(views).filter(|(_, view)| view.tile.layer == number).peekable();
            if here.peek().is_none() {
                continue;
            }
            let timestamp_writes = recording.render_pass(encoder, stage);
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(stage.name()),
                timestamp_writes,
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: layer,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(0.0),
                        store: wgpu::StoreOp::Store,
                    }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            for (slot, view) in here {
                let [x, y, width] = [view.tile.x, view.tile.y, view.tile.width];
                pass.set_viewport(x as f32, y as f32, width as f32, width as f32, 0.0, 1.0);
                pass.set_scissor_rect(x, y, width, width);
                pass.set_pipeline(&self.pipeline);
                pass.set_bind_group(0, &maps.group, &[slot as u32 * UNIFORM_STRIDE as u32]);
                pass.set_vertex_buffer(0, buffers.positions.slice(..));
                pass.set_index_buffer(buffers.triangles.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..indices, 0, 0..1);
                recording.work.draws += 1;
                casters(&mut pass, slot);
            }
        }
    }
}

impl DepthLayers {
    pub fn new(device: &wgpu::Device, width: u32, layers: u32) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("depth maps"),
            size: wgpu::Extent3d { width, height: width, depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: Shadow::FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = |dimension, base_array_layer, array_layer_count| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(dimension),
                base_array_layer,
                array_layer_count: Some(array_layer_count),
                ..Default::default()
            })
        };
        let sampled = view(wgpu::TextureViewDimension::D2Array, 0, layers);
        let layers = (0..layers).map(|layer| view(wgpu::TextureViewDimension::D2, layer, 1)).collect();
        Self { texture, sampled, layers }
    }

    /// Whether there are at least this many layers of this width.
    pub fn fit(&self, width: u32, layers: u32) -> bool {
        self.texture.width() == width && self.texture.depth_or_array_layers() >= layers
    }

    pub fn bytes(&self) -> u64 {
        depth_bytes(self.texture.width(), self.texture.depth_or_array_layers())
    }
}

/// Of layers of this width.
pub(crate) fn depth_bytes(width: u32, layers: u32) -> u64 {
    4 * u64::from(width).pow(2) * u64::from(layers)
}

impl DepthMaps {
    /// Apart from the layers.
    pub fn bytes(&self) -> u64 {
        self.uniforms.size()
    }

    pub fn write_views(&self, queue: &wgpu::Queue, views: &[View]) {
        for (slot, view) in (0..).zip(views) {
            queue.write_buffer(
                &self.uniforms,
                slot * UNIFORM_STRIDE,
                bytemuck::bytes_of(&view.matrix.to_cols_array_2d()),
            );
        }
    }
}
