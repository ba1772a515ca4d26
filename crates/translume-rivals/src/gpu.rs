//! Short words for long wgpu descriptors.

use translume::wgpu::{self, BindingType, TextureFormat, TextureUsages};

pub const PICTURE: TextureFormat = TextureFormat::Rgba32Float;
pub const DEPTH: TextureFormat = TextureFormat::Depth32Float;

pub const UNIFORM: BindingType = BindingType::Buffer {
    ty: wgpu::BufferBindingType::Uniform,
    has_dynamic_offset: false,
    min_binding_size: None,
};
pub const READ: BindingType = BindingType::Buffer {
    ty: wgpu::BufferBindingType::Storage { read_only: true },
    has_dynamic_offset: false,
    min_binding_size: None,
};
pub const SAMPLER: BindingType = BindingType::Sampler(wgpu::SamplerBindingType::Filtering);

pub const fn texture(
    sample_type: wgpu::TextureSampleType,
    view_dimension: wgpu::TextureViewDimension,
) -> BindingType {
    BindingType::Texture { sample_type, view_dimension, multisampled: false }
}

pub const fn float(filterable: bool) -> wgpu::TextureSampleType {
    wgpu::TextureSampleType::Float { filterable }
}

/// A group with these bindings, all visible to vertex and fragment shaders.
pub fn layout(device: &wgpu::Device, label: &str, bindings: &[(u32, BindingType)]) -> wgpu::BindGroupLayout {
    let visibility = wgpu::ShaderStages::VERTEX_FRAGMENT;
    let entries: Vec<_> = bindings
        .iter()
        .map(|&(binding, ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None })
        .collect();
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

pub fn bind(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: &[(u32, wgpu::BindingResource<'_>)],
) -> wgpu::BindGroup {
    let entries: Vec<_> = resources
        .iter()
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding: *binding, resource: resource.clone() })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

pub fn buffer(device: &wgpu::Device, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size.max(16),
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

pub fn target(
    device: &wgpu::Device,
    label: &str,
    format: TextureFormat,
    [width, height, layers]: [u32; 3],
    mip_level_count: u32,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: layers },
        mip_level_count,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

/// One level of one layer, as what `dimension` says.
pub fn level(
    texture: &wgpu::Texture,
    dimension: wgpu::TextureViewDimension,
    layer: u32,
    level: u32,
) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(dimension),
        base_array_layer: layer,
        array_layer_count: Some(1),
        base_mip_level: level,
        mip_level_count: Some(1),
        ..Default::default()
    })
}

/// All of it.
pub fn view(texture: &wgpu::Texture, dimension: wgpu::TextureViewDimension) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor { dimension: Some(dimension), ..Default::default() })
}

/// What a pass is drawn with.
pub struct Pass<'a> {
    pub label: &'a str,
    pub module: &'a wgpu::ShaderModule,
    pub layout: &'a wgpu::BindGroupLayout,
    pub vertex: &'a str,
    /// Whether it draws the mesh, or all of the target.
    pub mesh: bool,
    /// `None` for depth alone.
    pub fragment: Option<&'a str>,
    pub targets: &'a [TextureFormat],
    pub writes: wgpu::ColorWrites,
    pub depth: Option<wgpu::CompareFunction>,
    pub constants: &'a [(&'a str, f64)],
}

impl Pass<'_> {
    pub fn pipeline(&self, device: &wgpu::Device) -> wgpu::RenderPipeline {
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(self.label),
            bind_group_layouts: &[Some(self.layout)],
            immediate_size: 0,
        });
        let vector = |location: &'static [wgpu::VertexAttribute]| {
            Some(wgpu::VertexBufferLayout {
                array_stride: 16,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: location,
            })
        };
        let buffers = [
            vector(&const { wgpu::vertex_attr_array![0 => Float32x3] }),
            vector(&const { wgpu::vertex_attr_array![1 => Float32x3] }),
        ];
        let compilation_options =
            || wgpu::PipelineCompilationOptions { constants: self.constants, ..Default::default() };
        let target = |&format| Some(wgpu::ColorTargetState { format, blend: None, write_mask: self.writes });
        let targets: Vec<_> = self.targets.iter().map(target).collect();
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.label),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: self.module,
                entry_point: Some(self.vertex),
                compilation_options: compilation_options(),
                buffers: if self.mesh { &buffers } else { &[] },
            },
            // Scans are open: their inside is drawn too.
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: self.depth.map(|compare| wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(compare),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: self.fragment.map(|entry_point| wgpu::FragmentState {
                module: self.module,
                entry_point: Some(entry_point),
                compilation_options: compilation_options(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// Begins a pass that clears what it draws into: colours to nothing, depth to the far plane.
pub fn begin<'e, const N: usize>(
    encoder: &'e mut wgpu::CommandEncoder,
    label: &str,
    colours: [&wgpu::TextureView; N],
    depth: Option<&wgpu::TextureView>,
) -> wgpu::RenderPass<'e> {
    let clear =
        wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store };
    let attachment = |view| {
        Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops: clear })
    };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &colours.map(attachment),
        depth_stencil_attachment: depth.map(|view| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
