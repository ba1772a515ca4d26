//! Composite: the camera's view of a body, L_o = F_t(η, ω_o)·B/π, and what its surface reflects.
//!
//! reads  corners (position and normal in the atlas' order), exitance of texels, vertices or points       writes  the host's colour and depth attachments
//! twin   `translume_reference::composite`           WGSL    `composite.wgsl`

use crate::gpu::{self, DEPTH_MAPS, FLOAT_TEXTURE, MediumKind, UNIFORM};
use crate::layout::CompositeLayout;
use crate::stages::scatter::points::{PointMemory, Points};
use crate::{Body, Camera, Geometry};
use std::sync::OnceLock;
use wgpu::ShaderStages;

/// What the host draws into.
///
/// ```
/// use translume::{CompositeTarget, wgpu};
///
/// // A renderer with reversed depth and four samples a pixel.
/// let target = CompositeTarget {
///     depth: Some((wgpu::TextureFormat::Depth32Float, wgpu::CompareFunction::Greater)),
///     samples: 4,
///     ..Default::default()
/// };
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompositeTarget {
    /// Format of the colour attachment; radiance is linear, so a float format keeps it whole.
    pub format: wgpu::TextureFormat,
    /// Format of the depth attachment and which depth is nearer; `None` draws without depth.
    pub depth: Option<(wgpu::TextureFormat, wgpu::CompareFunction)>,
    /// Samples per pixel of both attachments.
    pub samples: u32,
}

impl Default for CompositeTarget {
    /// `Rgba16Float` with `Depth32Float`, nearer is less, one sample.
    fn default() -> Self {
        Self {
            format: wgpu::TextureFormat::Rgba16Float,
            depth: Some((wgpu::TextureFormat::Depth32Float, wgpu::CompareFunction::Less)),
            samples: 1,
        }
    }
}

/// What the surface reflects before light enters.
///
/// ```
/// use translume::Gloss;
///
/// let wax = Gloss::Rough(0.35);
/// assert_eq!(Gloss::default(), Gloss::None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Gloss {
    /// Nothing: the subsurface part alone, for a host that adds its own highlights and for comparison with references.
    #[default]
    None,
    /// A dielectric of the medium's index of refraction with this roughness, 0.03 (polished) to 1 (matt). Reflects every light of the
    /// frame, with its shadows. A medium with index 1 reflects nothing.
    Rough(f32),
}

/// Draws bodies into one kind of target.
///
/// ```no_run
/// # fn example(device: &translume::wgpu::Device, queue: &translume::wgpu::Queue, translume: &translume::Translume,
/// #     body: &translume::Body, camera: &translume::Camera, pass: &mut translume::wgpu::RenderPass<'_>) {
/// use translume::{CompositeTarget, Gloss};
///
/// // once
/// let composite = translume.composite(device, CompositeTarget::default());
/// let mut view = composite.view(device, body);
/// // each frame, after `Body::prepare` and before the pass
/// view.prepare(device, queue, body, camera, Gloss::Rough(0.35));
/// // in the pass
/// composite.draw(pass, &view);
/// # }
/// ```
pub struct Composite {
    device: wgpu::Device,
    layout: wgpu::BindGroupLayout,
    target: CompositeTarget,
    /// Of exitance at texels, at vertices, and at fragments of each kind of medium.
    kinds: [Kind; FRAGMENTS + 4],
    depth: wgpu::PipelineLayout,
    /// Draws depth before exitance is summed up at fragments.
    depth_alone: OnceLock<wgpu::RenderPipeline>,
}

const TEXELS: usize = 0;
const VERTICES: usize = 1;
const FRAGMENTS: usize = 2;

/// What draws one kind of exitance.
struct Kind {
    medium: MediumKind,
    layout: wgpu::PipelineLayout,
    shader: translume_shaders::Shader,
    /// For smooth normals and for flat ones, made when a body first needs them.
    pipelines: [OnceLock<wgpu::RenderPipeline>; 2],
}

/// One body seen by one camera.
///
/// ```no_run
/// # fn example(device: &translume::wgpu::Device, composite: &translume::Composite, body: &translume::Body) {
/// // Two cameras, two views of one body.
/// let [left, right] = [composite.view(device, body), composite.view(device, body)];
/// # }
/// ```
pub struct CompositeView {
    uniform: wgpu::Buffer,
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
    /// The depth maps that are bound; a body makes new ones when it gets more shadows.
    depth_maps: wgpu::Texture,
    vertices: wgpu::Buffer,
    corners: wgpu::Buffer,
    indices: wgpu::Buffer,
    index_count: u32,
    flat: bool,
    kind: usize,
    /// Of exitance at points.
    points: Option<wgpu::BindGroup>,
}

impl Composite {
    pub(crate) fn new(device: &wgpu::Device, points: &Points, target: CompositeTarget) -> Self {
        let types = [UNIFORM, FLOAT_TEXTURE, UNIFORM, DEPTH_MAPS];
        let layout = gpu::layout(device, "composite", ShaderStages::VERTEX_FRAGMENT, &types);
        let kind = |shader, second: Option<&wgpu::BindGroupLayout>, medium| Kind {
            medium,
            layout: gpu::pipeline_layout(
                device,
                "composite",
                &std::iter::once(&layout).chain(second).collect::<Vec<_>>(),
            ),
            shader,
            pipelines: <[OnceLock<_>; 2]>::default(),
        };
        let fragments =
            |k| kind(translume_shaders::COMPOSITE_FRAGMENTS, Some(&points.field), MediumKind::ALL[k]);
        let kinds = [
            kind(translume_shaders::COMPOSITE, None, MediumKind::default()),
            kind(translume_shaders::COMPOSITE_VERTICES, Some(&points.seen), MediumKind::default()),
            fragments(0),
            fragments(1),
            fragments(2),
            fragments(3),
        ];
        let depth = kind(translume_shaders::COMPOSITE, None, MediumKind::default()).layout;
        let composite =
            Self { device: device.clone(), layout, target, kinds, depth, depth_alone: OnceLock::new() };
        for flat in [false, true] {
            composite.pipeline(TEXELS, flat);
        }
        composite
    }

    fn pipeline(&self, kind: usize, flat: bool) -> &wgpu::RenderPipeline {
        let Kind { medium, layout, shader, pipelines } = &self.kinds[kind];
        pipelines[usize::from(flat)].get_or_init(|| {
            let medium = (kind >= FRAGMENTS).then_some(*medium);
            let pass = Pass::Picture { flat, medium };
            pipeline(&self.device, layout, *shader, self.target, pass)
        })
    }

    fn depth_pipeline(&self) -> &wgpu::RenderPipeline {
        self.depth_alone.get_or_init(|| {
            pipeline(&self.device, &self.depth, translume_shaders::COMPOSITE, self.target, Pass::DepthAlone)
        })
    }

    /// Binds a body for drawing. Needed once per body and camera.
    #[must_use]
    pub fn view(&self, device: &wgpu::Device, body: &Body) -> CompositeView {
        let uniform = gpu::uniform_buffer(device, "composite", size_of::<CompositeLayout>() as u64);
        CompositeView {
            group: bind(device, &self.layout, &uniform, body),
            depth_maps: body.seen_depth().texture.clone(),
            layout: self.layout.clone(),
            uniform,
            vertices: body.buffers.atlas_vertices.clone(),
            corners: body.buffers.corners.clone(),
            indices: body.buffers.atlas_indices.clone(),
            index_count: body.extent.triangles * 3,
            flat: body.flat_normals,
            kind: TEXELS,
            points: None,
        }
    }

    /// Records one draw, or two where exitance is summed up at fragments. The first body evaluated elsewhere than at texels makes its
    /// pipeline here. Call [`CompositeView::prepare`] before the pass begins.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, view: &CompositeView) {
        pass.set_bind_group(0, &view.group, &[]);
        pass.set_vertex_buffer(0, view.vertices.slice(..));
        pass.set_vertex_buffer(1, view.corners.slice(..));
        pass.set_index_buffer(view.indices.slice(..), wgpu::IndexFormat::Uint32);
        if view.kind >= FRAGMENTS && self.target.depth.is_some() {
            pass.set_pipeline(self.depth_pipeline());
            pass.draw_indexed(0..view.index_count, 0, 0..1);
        }
        pass.set_pipeline(self.pipeline(view.kind, view.flat));
        if let Some(points) = &view.points {
            pass.set_bind_group(1, points, &[]);
        }
        pass.draw_indexed(0..view.index_count, 0, 0..1);
    }
}

impl CompositeView {
    /// Takes over the camera and the surface, and the body's medium and profile. Call it after [`Body::prepare`].
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        body: &Body,
        camera: &Camera,
        gloss: Gloss,
    ) {
        if self.depth_maps != body.seen_depth().texture {
            self.group = bind(device, &self.layout, &self.uniform, body);
            self.depth_maps = body.seen_depth().texture.clone();
        }
        self.points = body.points().map(|points| points.drawn().clone());
        self.kind = match body.points() {
            None => TEXELS,
            Some(PointMemory::Vertices { .. }) => VERTICES,
            Some(PointMemory::Fragments { .. }) => FRAGMENTS + body.kind.index(),
        };
        let (view_projection, eye) = camera.in_mm(body.mm_per_unit);
        let uniform = CompositeLayout {
            view_projection,
            eye,
            eta: body.medium().ior,
            exit_scale: body.exit_scale,
            roughness: match gloss {
                Gloss::None => 0.0,
                // Below this the highlight of a point is smaller than a pixel and only flickers.
                Gloss::Rough(roughness) => roughness.clamp(0.03, 1.0),
            },
            padding: [0; 2],
        };
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
    }
}

fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    uniform: &wgpu::Buffer,
    body: &Body,
) -> wgpu::BindGroup {
    let resources = [
        uniform.as_entire_binding(),
        wgpu::BindingResource::TextureView(body.exitance_view()),
        body.buffers.gather_uniform.as_entire_binding(),
        wgpu::BindingResource::TextureView(&body.seen_depth().sampled),
    ];
    gpu::bind(device, "composite", layout, &resources)
}

#[derive(Clone, Copy)]
enum Pass {
    /// With the kind of medium where exitance is summed up at fragments, after a depth pass.
    Picture {
        flat: bool,
        medium: Option<MediumKind>,
    },
    DepthAlone,
}

/// What lets a fragment through that is as near as the depth pass found it.
fn or_equal(compare: wgpu::CompareFunction) -> wgpu::CompareFunction {
    match compare {
        wgpu::CompareFunction::Less => wgpu::CompareFunction::LessEqual,
        wgpu::CompareFunction::Greater => wgpu::CompareFunction::GreaterEqual,
        other => other,
    }
}

fn pipeline(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    shader: translume_shaders::Shader,
    target: CompositeTarget,
    pass: Pass,
) -> wgpu::RenderPipeline {
    let module = &gpu::module(device, shader);
    let (entry_point, after_depth, write_mask) = match pass {
        Pass::Picture { medium, .. } => ("fragment", medium.is_some(), wgpu::ColorWrites::ALL),
        Pass::DepthAlone => ("depth_alone", false, wgpu::ColorWrites::empty()),
    };
    let mut constants = Vec::new();
    if let Pass::Picture { flat, medium } = pass {
        constants.push(("FLAT_NORMALS", f64::from(u8::from(flat))));
        constants.extend(medium.iter().flat_map(|medium| medium.constants()));
    }
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("composite"),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &Geometry::LAYOUTS.map(Some),
        },
        // Scans are open: their inside is drawn too, with the light of their outside.
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: target.depth.map(|(format, compare)| wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(true),
            depth_compare: Some(if after_depth { or_equal(compare) } else { compare }),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState { count: target.samples, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &constants,
                ..Default::default()
            },
            targets: &[Some(wgpu::ColorTargetState { format: target.format, blend: None, write_mask })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
