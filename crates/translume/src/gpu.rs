//! Short words for long wgpu descriptors.

use crate::stages::Stage;
use crate::timings::Recording;
use std::borrow::Cow;
use std::sync::OnceLock;
use wgpu::BindingType;

pub(crate) const fn storage(read_only: bool) -> BindingType {
    BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only },
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

pub(crate) const READ: BindingType = storage(true);
pub(crate) const WRITE: BindingType = storage(false);
pub(crate) const UNIFORM: BindingType = uniform(false);
pub(crate) const UNIFORM_ARRAY: BindingType = uniform(true);

const fn uniform(has_dynamic_offset: bool) -> BindingType {
    BindingType::Buffer { ty: wgpu::BufferBindingType::Uniform, has_dynamic_offset, min_binding_size: None }
}

/// An unfilterable float texture: readable on every device.
pub(crate) const FLOAT_TEXTURE: BindingType = BindingType::Texture {
    sample_type: wgpu::TextureSampleType::Float { filterable: false },
    view_dimension: wgpu::TextureViewDimension::D2,
    multisampled: false,
};

/// Depth maps.
pub(crate) const DEPTH_MAPS: BindingType = BindingType::Texture {
    sample_type: wgpu::TextureSampleType::Depth,
    view_dimension: wgpu::TextureViewDimension::D2Array,
    multisampled: false,
};

/// Uniforms picked by dynamic offset stand this far apart (WebGPU's default alignment).
pub(crate) const UNIFORM_STRIDE: u64 = 256;

/// Bytes that one storage binding holds.
pub(crate) fn binding_limit(limits: &wgpu::Limits) -> u64 {
    limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
}

/// Bindings 0, 1, 2 … of group 0.
pub(crate) fn layout(
    device: &wgpu::Device,
    label: &str,
    visibility: wgpu::ShaderStages,
    types: &[BindingType],
) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(types)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty: *ty, count: None })
        .collect();
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// Resources for bindings 0, 1, 2 … of group 0.
pub(crate) fn bind(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    let entries: Vec<_> = (0..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

/// The first `size` bytes of a buffer of uniforms, moved by dynamic offset.
pub(crate) fn uniform_slot<T>(buffer: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
    let size = wgpu::BufferSize::new(size_of::<T>() as u64);
    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: 0, size })
}

pub(crate) fn module(device: &wgpu::Device, shader: translume_shaders::Shader) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(shader.name),
        source: wgpu::ShaderSource::Wgsl(Cow::Borrowed(shader.source)),
    })
}

pub(crate) fn pipeline_layout(
    device: &wgpu::Device,
    label: &str,
    groups: &[&wgpu::BindGroupLayout],
) -> wgpu::PipelineLayout {
    let groups: Vec<_> = groups.iter().copied().map(Some).collect();
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &groups,
        immediate_size: 0,
    })
}

pub(crate) fn compute_pipeline(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    module: &wgpu::ShaderModule,
    entry_point: &str,
) -> wgpu::ComputePipeline {
    specialised_pipeline(device, layout, module, entry_point, &[])
}

/// With values for the module's `override`s.
pub(crate) fn specialised_pipeline(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    module: &wgpu::ShaderModule,
    entry_point: &str,
    constants: &[(&str, f64)],
) -> wgpu::ComputePipeline {
    let layout = pipeline_layout(device, entry_point, &[layout]);
    pipeline_with(device, &layout, module, entry_point, constants)
}

/// With any layout.
pub(crate) fn pipeline_with(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    entry_point: &str,
    constants: &[(&str, f64)],
) -> wgpu::ComputePipeline {
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry_point),
        layout: Some(layout),
        module,
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
        cache: None,
    })
}

/// A compute pipeline for each kind of medium, made when it is first needed.
pub(crate) struct PerMedium {
    device: wgpu::Device,
    layout: wgpu::PipelineLayout,
    /// For radial profiles, and for sources off the surface.
    shaders: [translume_shaders::Shader; 2],
    entry_point: &'static str,
    pipelines: [OnceLock<wgpu::ComputePipeline>; 8],
}

impl PerMedium {
    pub fn new(
        device: &wgpu::Device,
        layout: &wgpu::PipelineLayout,
        shaders: [translume_shaders::Shader; 2],
        entry_point: &'static str,
    ) -> Self {
        let (device, layout) = (device.clone(), layout.clone());
        Self { device, layout, shaders, entry_point, pipelines: Default::default() }
    }

    pub fn get(&self, kind: MediumKind) -> &wgpu::ComputePipeline {
        let Self { device, layout, shaders, entry_point, pipelines } = self;
        let oriented = usize::from(kind.oriented);
        pipelines[kind.index() + 4 * oriented].get_or_init(|| {
            pipeline_with(device, layout, &module(device, shaders[oriented]), entry_point, &kind.constants())
        })
    }
}

/// What of a medium decides which code scatters it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct MediumKind {
    /// Whether the three channels are alike.
    pub monochrome: bool,
    /// Whether light wanders differently far from place to place.
    pub scaled: bool,
    /// Whether its sources lie off the surface.
    pub oriented: bool,
}

impl MediumKind {
    /// Those whose sources lie on the surface, each at its index.
    pub const ALL: [Self; 4] = [
        Self { monochrome: false, scaled: false, oriented: false },
        Self { monochrome: true, scaled: false, oriented: false },
        Self { monochrome: false, scaled: true, oriented: false },
        Self { monochrome: true, scaled: true, oriented: false },
    ];

    pub fn index(self) -> usize {
        usize::from(self.monochrome) + 2 * usize::from(self.scaled)
    }

    /// Of WGSL.
    pub fn constants(self) -> [(&'static str, f64); 2] {
        let on = |on: bool| f64::from(u8::from(on));
        [("MONOCHROME", on(self.monochrome)), ("SCALED", on(self.scaled))]
    }
}

/// Threads of a workgroup; `WORKGROUP` in `shared/dispatch.wgsl`.
const WORKGROUP: u32 = 64;
/// WebGPU's default limit of workgroups along one axis.
const WORKGROUPS_PER_ROW: u32 = 65_535;

/// How much was recorded.
///
/// ```no_run
/// # fn example(device: &translume::wgpu::Device, queue: &translume::wgpu::Queue, body: &mut translume::Body) -> Result<(), translume::Error> {
/// let mut encoder = device.create_command_encoder(&Default::default());
/// let work = body.encode(&mut encoder);
/// println!("{} draws, {} dispatches", work.draws, work.dispatches);
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Draws of the body into depth maps, one per view. What the host draws there is not counted.
    pub draws: u32,
    /// Dispatches of compute work.
    pub dispatches: u32,
}

/// A compute pass that counts and is timed.
pub(crate) struct Pass<'a> {
    pass: wgpu::ComputePass<'a>,
    work: &'a mut Work,
}

impl<'a> Pass<'a> {
    pub fn begin(
        encoder: &'a mut wgpu::CommandEncoder,
        stage: Stage,
        recording: &'a mut Recording<'_>,
    ) -> Self {
        let timestamp_writes = recording.compute_pass(encoder, stage);
        let label = Some(stage.name());
        let pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label, timestamp_writes });
        Self { pass, work: &mut recording.work }
    }

    pub fn set_pipeline(&mut self, pipeline: &wgpu::ComputePipeline) {
        self.pass.set_pipeline(pipeline);
    }

    /// Group 0.
    pub fn set_bind_group(&mut self, group: &wgpu::BindGroup, offsets: &[u32]) {
        self.pass.set_bind_group(0, group, offsets);
    }

    /// Group 1.
    pub fn set_second_group(&mut self, group: &wgpu::BindGroup) {
        self.pass.set_bind_group(1, group, &[]);
    }

    /// One invocation per item, in rows where one row is too long.
    pub fn dispatch(&mut self, items: u32) {
        let workgroups = items.div_ceil(WORKGROUP);
        let rows = workgroups.div_ceil(WORKGROUPS_PER_ROW).max(1);
        self.dispatch_workgroups(workgroups.div_ceil(rows), rows);
    }

    pub fn dispatch_workgroups(&mut self, x: u32, y: u32) {
        self.pass.dispatch_workgroups(x, y, 1);
        self.work.dispatches += 1;
    }
}

/// A buffer with this content. An empty one still gets room for a few bytes, because bindings may not be empty.
pub(crate) fn buffer_with<T: bytemuck::NoUninit>(
    device: &wgpu::Device,
    label: &str,
    usage: wgpu::BufferUsages,
    content: &[T],
) -> wgpu::Buffer {
    use wgpu::util::DeviceExt as _;
    let bytes = bytemuck::cast_slice(content);
    let contents = if bytes.is_empty() { &[0_u8; 16][..] } else { bytes };
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
}

/// A zeroed buffer that shaders may write and hosts may copy from.
pub(crate) fn buffer(device: &wgpu::Device, label: &str, size: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size.max(16),
        usage,
        mapped_at_creation: false,
    })
}

/// A buffer for uniforms.
pub(crate) fn uniform_buffer(device: &wgpu::Device, label: &str, size: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage,
        mapped_at_creation: false,
    })
}

/// An `Rgba32Float` texture without mip levels: read by `textureLoad`, so no device has to filter it.
pub(crate) fn float_texture(
    device: &wgpu::Device,
    label: &str,
    (width, height): (u32, u32),
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage,
        view_formats: &[],
    })
}
