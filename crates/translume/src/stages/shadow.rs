//! Shadow: the depth of the deformed mesh seen from each shadowed light.
//!
//! reads  positions, triangles                              writes  one layer of depth per view
//! twin   `translume_reference::Surface`, by tracing rays   WGSL    `shadow.wgsl`

use crate::Light;
use crate::buffers::Buffers;
use crate::gpu::{self, UNIFORM_ARRAY, UNIFORM_STRIDE};
use crate::layout::MAX_VIEWS;
use glam::camera::rh::{proj, view};
use glam::{Mat4, Vec3};

/// A point light further off its body than this (cosine of the half angle under which the body appears) needs one view; a nearer
/// one, or one inside, needs six.
const SINGLE_VIEW_COSINE: f32 = 0.5;
/// A spot light with a wider cone (radians) takes six views: one would be stretched too far towards its rim.
const WIDEST_CONE: f32 = 1.05;
/// Room around the body for filtering, in texels of the map.
const MARGIN: f32 = 4.0;

pub(crate) struct Shadow {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
}

/// One depth map: a matrix from millimetres to clip space and the width of its texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View {
    pub matrix: Mat4,
    /// mm; for a perspective view at a depth of 1 mm.
    pub texel: f32,
    pub perspective: bool,
}

/// The depth maps of a body, and the uniforms they are drawn with.
pub(crate) struct DepthMaps {
    pub texture: wgpu::Texture,
    pub sampled: wgpu::TextureView,
    /// Compares with the four nearest texels and blends the answers.
    pub sampler: wgpu::Sampler,
    layers: Vec<wgpu::TextureView>,
    uniforms: wgpu::Buffer,
    group: wgpu::BindGroup,
}

/// The views of one light over a body whose bounding box has these corners, mm: none, one or six.
/// `light` is in world units; `scale` takes it to millimetres.
pub(crate) fn views(light: &Light, scale: f32, corners: &[Vec3; 8], resolution: u32) -> Vec<View> {
    match light {
        Light::Directional(light) if light.shadow => {
            vec![directional_view(Vec3::from(light.to_light).normalize(), corners, resolution)]
        }
        Light::Point(light) if light.shadow => {
            point_views(Vec3::from(light.position) * scale, corners, resolution)
        }
        Light::Spot(light) if light.shadow => {
            let position = Vec3::from(light.position) * scale;
            let views = point_views(position, corners, resolution);
            if views.len() > 1 && light.outer_angle <= WIDEST_CONE {
                vec![cone_view(position, light.direction.into(), light.outer_angle, corners, resolution)]
            } else {
                views
            }
        }
        _ => Vec::new(),
    }
}

/// What a spot light near or inside its body sees: beyond its cone it is dark anyway.
fn cone_view(position: Vec3, axis: Vec3, outer_angle: f32, corners: &[Vec3; 8], resolution: u32) -> View {
    let look = view::look_to_mat4(position, axis, axis.any_orthonormal_vector());
    let margin = 1.0 + 2.0 * MARGIN / resolution as f32;
    let far = reach(position, corners);
    perspective(look, outer_angle.tan() * margin, 1e-4 * far, far, resolution)
}

/// A little more than the distance of the furthest corner.
fn reach(position: Vec3, corners: &[Vec3; 8]) -> f32 {
    1.02 * corners.iter().map(|corner| corner.distance(position)).fold(0.0, f32::max)
}

fn directional_view(to_light: Vec3, corners: &[Vec3; 8], resolution: u32) -> View {
    let centre = corners.iter().sum::<Vec3>() / 8.0;
    let look = view::look_to_mat4(centre, -to_light, to_light.any_orthonormal_vector());
    let seen = corners.map(|corner| look.transform_point3(corner));
    let (low, high) = (reduce(&seen, Vec3::min), reduce(&seen, Vec3::max));
    let half = 0.5 * (high - low).truncate().max_element().max(f32::MIN_POSITIVE);
    let half = half * (1.0 + 2.0 * MARGIN / resolution as f32);
    let middle = 0.5 * (low + high);
    let slack = 0.01 * (high - low).max_element();
    let matrix = proj::directx::orthographic(
        middle.x - half,
        middle.x + half,
        middle.y - half,
        middle.y + half,
        -high.z - slack,
        -low.z + slack,
    );
    View { matrix: matrix * look, texel: 2.0 * half / resolution as f32, perspective: false }
}

fn point_views(position: Vec3, corners: &[Vec3; 8], resolution: u32) -> Vec<View> {
    let centre = corners.iter().sum::<Vec3>() / 8.0;
    let forward = (centre - position).normalize_or(Vec3::Z);
    let look = view::look_to_mat4(position, forward, forward.any_orthonormal_vector());
    let seen = corners.map(|corner| look.transform_point3(corner));
    let narrow = seen.iter().all(|p| -p.z > SINGLE_VIEW_COSINE * p.length());
    let margin = 1.0 + 2.0 * MARGIN / resolution as f32;
    if narrow {
        let tangent = seen.iter().map(|p| p.x.abs().max(p.y.abs()) / -p.z).fold(0.0, f32::max) * margin;
        let (near, far) = (-reduce(&seen, Vec3::max).z, -reduce(&seen, Vec3::min).z);
        return vec![perspective(look, tangent, 0.98 * near, 1.02 * far, resolution)];
    }
    let far = reach(position, corners);
    let faces = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    faces
        .map(|face| {
            let look = view::look_to_mat4(position, face, face.any_orthonormal_vector());
            // A face is drawn a little wider than a quarter turn, so that filtering never leaves it.
            perspective(look, 1.05 * margin, 1e-4 * far, far, resolution)
        })
        .to_vec()
}

fn perspective(look: Mat4, tangent: f32, near: f32, far: f32, resolution: u32) -> View {
    let matrix = proj::directx::perspective(2.0 * tangent.atan(), 1.0, near, far);
    View { matrix: matrix * look, texel: 2.0 * tangent / resolution as f32, perspective: true }
}

fn reduce(points: &[Vec3; 8], f: fn(Vec3, Vec3) -> Vec3) -> Vec3 {
    points.iter().copied().reduce(f).unwrap_or_default()
}

impl Shadow {
    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

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
            layout: Some(&gpu::pipeline_layout(device, "shadow", &layout)),
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
                depth_compare: Some(wgpu::CompareFunction::Less),
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

    /// Room for `layers` depth maps.
    pub fn depth_maps(&self, device: &wgpu::Device, resolution: u32, layers: u32) -> DepthMaps {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("depth maps"),
            size: wgpu::Extent3d { width: resolution, height: resolution, depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: Self::FORMAT,
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
        let uniforms = gpu::uniform_buffer(device, "shadow views", UNIFORM_STRIDE * MAX_VIEWS as u64);
        let group = gpu::bind(device, "shadow", &self.layout, &[gpu::uniform_slot::<Mat4>(&uniforms)]);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("depth maps"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        DepthMaps { texture, sampled, sampler, layers, uniforms, group }
    }

    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        maps: &DepthMaps,
        buffers: &Buffers,
        views: u32,
        indices: u32,
    ) {
        for (slot, layer) in (0..views).zip(&maps.layers) {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("shadow"),
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: layer,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(1.0),
                        store: wgpu::StoreOp::Store,
                    }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &maps.group, &[slot * UNIFORM_STRIDE as u32]);
            pass.set_vertex_buffer(0, buffers.positions.slice(..));
            pass.set_index_buffer(buffers.triangles.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..indices, 0, 0..1);
        }
    }
}

impl DepthMaps {
    pub fn layers(&self) -> u32 {
        self.texture.depth_or_array_layers()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DirectionalLight, PointLight};

    fn unit_box() -> [Vec3; 8] {
        std::array::from_fn(|k| Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32) * 2.0 - 1.0)
    }

    fn holds(view: &View, point: Vec3) -> bool {
        let ndc = view.matrix.project_point3(point);
        ndc.x.abs() <= 1.0 && ndc.y.abs() <= 1.0 && (0.0..=1.0).contains(&ndc.z)
    }

    #[test]
    fn every_corner_is_inside_the_map() {
        for direction in [[0.0, 1.0, 0.0], [1.0, 2.0, -3.0], [0.0, 0.0, -1.0]] {
            let light = Light::Directional(DirectionalLight { to_light: direction, ..Default::default() });
            let views = views(&light, 1.0, &unit_box(), 512);
            assert_eq!(views.len(), 1);
            assert!(unit_box().iter().all(|corner| holds(&views[0], *corner)), "{direction:?}");
            assert!(!holds(&views[0], Vec3::splat(3.0)), "a map that holds everything resolves nothing");
        }
    }

    #[test]
    fn a_near_point_light_looks_all_around() {
        let at = |position| Light::Point(PointLight { position, ..Default::default() });
        let far = views(&at([0.0, 9.0, 0.0]), 1.0, &unit_box(), 512);
        assert_eq!(far.len(), 1);
        assert!(unit_box().iter().all(|corner| holds(&far[0], *corner)));
        for position in [[0.0; 3], [0.0, 1.0, 0.0], [0.9, 0.2, -0.4]] {
            let near = views(&at(position), 1.0, &unit_box(), 512);
            assert_eq!(near.len(), 6);
            for corner in unit_box() {
                assert!(near.iter().any(|view| holds(view, corner)), "{position:?} misses {corner}");
            }
        }
    }

    #[test]
    fn a_light_without_shadow_needs_no_map() {
        let light = Light::Point(PointLight { shadow: false, ..Default::default() });
        assert!(views(&light, 1.0, &unit_box(), 512).is_empty());
    }
}
