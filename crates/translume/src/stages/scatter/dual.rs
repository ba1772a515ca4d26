//! Dual: the scatter sum with groups of texels at both ends, level by level from the coarsest receivers to the texels.
//!
//! reads  bounds and lamps of the tree, kernel table      writes  exitance per texel, linear RGB
//! judge  `Method::AllPairs` on the same adapter          WGSL    `dual.wgsl`

use crate::Error;
use crate::buffers::Buffers;
use crate::gpu::{self, FLOAT_TEXTURE, Pass, READ, UNIFORM_ARRAY, UNIFORM_STRIDE, WRITE};
use crate::layout::{DualLayout, ScatterLayout};
use crate::stages::cluster::Tree;

/// The coarsest level of receivers has at least this many nodes: fewer would not share enough to be worth a dispatch.
const LEAST_RECEIVERS: u32 = 64;
/// Opening angle of single texels over that of groups: they test the source's size alone. At θ = 0.8 a ratio of 0.51 raises the error of
/// skin1 on the creature at 256² from 0.5 % to 1.0 % and saves a seventh of the time; 0.35 hardly gains.
const LEAF_THETA: f32 = 0.4;
/// Bytes in front of the lists.
const LISTS_HEADER: u64 = 16;
/// Words of the empty list and the list of the root.
const ROOT: u32 = 3;
/// Bytes of an expansion, as in `shared/expansion.wgsl`: ten vectors.
pub(crate) const EXPANSION: u64 = 160;

pub(crate) struct Dual {
    layout: wgpu::BindGroupLayout,
    start: wgpu::ComputePipeline,
    inner: wgpu::ComputePipeline,
    leaf: wgpu::ComputePipeline,
}

/// What the dual scatter of one body remembers during a frame.
pub(crate) struct DualMemory {
    uniforms: wgpu::Buffer,
    pub lists: wgpu::Buffer,
    group: wgpu::BindGroup,
    start_level: u32,
    capacity: u32,
}

/// Level of the coarsest receivers; 0 where texels are too few for groups of them.
fn start_level(tree: &Tree) -> u32 {
    tree.counts.iter().rposition(|count| *count >= LEAST_RECEIVERS).unwrap_or(0) as u32
}

/// Words for the lists: as many as wished, as a binding holds, and as the 28 bits of a link can tell apart. Too few only cost time.
fn capacity(texels: u32, entries_per_texel: u32, limits: &wgpu::Limits) -> u32 {
    let room = (binding(limits) - LISTS_HEADER) / 4;
    texels.saturating_mul(entries_per_texel).saturating_add(ROOT).min(1 << 28).min(room as u32)
}

fn binding(limits: &wgpu::Limits) -> u64 {
    limits.max_storage_buffer_binding_size.min(limits.max_buffer_size).min(1 << 30)
}

/// Bytes of the expansions of all receivers from the second level on.
fn expansions(tree: &Tree) -> u64 {
    EXPANSION * u64::from(tree.counts.iter().skip(2).sum::<u32>().max(1))
}

/// Whether the device can hold what the dual scatter remembers.
pub(crate) fn check(tree: &Tree, limits: &wgpu::Limits) -> Result<(), Error> {
    let (required, actual) = (expansions(tree), binding(limits));
    if required <= actual {
        return Ok(());
    }
    Err(Error::Limit {
        what: "the dual scatter".to_owned(),
        limit: "max_storage_buffer_binding_size",
        required,
        actual,
        remedy: "use a smaller atlas or `Method::Tree`, or create the device with higher limits",
    })
}

impl Dual {
    pub fn new(device: &wgpu::Device) -> Self {
        let types = [UNIFORM_ARRAY, READ, READ, WRITE, WRITE, WRITE, WRITE, FLOAT_TEXTURE];
        let layout = gpu::layout(device, "dual", wgpu::ShaderStages::COMPUTE, &types);
        let module = gpu::module(device, translume_shaders::DUAL);
        Self {
            start: gpu::compute_pipeline(device, &layout, &module, "start"),
            inner: gpu::compute_pipeline(device, &layout, &module, "inner"),
            leaf: gpu::compute_pipeline(device, &layout, &module, "leaf"),
            layout,
        }
    }

    /// Room for a body's lists and expansions.
    pub fn memory(
        &self,
        device: &wgpu::Device,
        buffers: &Buffers,
        kernel_table: &wgpu::TextureView,
        tree: &Tree,
        entries_per_texel: u32,
    ) -> DualMemory {
        let start_level = start_level(tree);
        let capacity = capacity(tree.counts[0], entries_per_texel, &device.limits());
        let uniforms = gpu::uniform_buffer(device, "dual", UNIFORM_STRIDE * u64::from(start_level + 1));
        let expansions = gpu::buffer(device, "expansions", expansions(tree));
        let heads = gpu::buffer(device, "heads", 4 * u64::from(tree.clusters()));
        let lists = gpu::buffer(device, "lists", LISTS_HEADER + 4 * u64::from(capacity));
        let resources = [
            gpu::uniform_slot::<DualLayout>(&uniforms),
            buffers.bounds.as_entire_binding(),
            buffers.lamps.as_entire_binding(),
            buffers.exitance.as_entire_binding(),
            expansions.as_entire_binding(),
            heads.as_entire_binding(),
            lists.as_entire_binding(),
            wgpu::BindingResource::TextureView(kernel_table),
        ];
        let group = gpu::bind(device, "dual", &self.layout, &resources);
        DualMemory { uniforms, lists, group, start_level, capacity }
    }

    pub fn encode(&self, pass: &mut Pass<'_>, memory: &DualMemory, tree: &Tree) {
        pass.set_pipeline(&self.start);
        pass.set_bind_group(&memory.group, &[0]);
        pass.dispatch_workgroups(1, 1);
        for level in (0..=memory.start_level).rev() {
            pass.set_pipeline(if level > 0 { &self.inner } else { &self.leaf });
            pass.set_bind_group(&memory.group, &[level * UNIFORM_STRIDE as u32]);
            pass.dispatch(tree.counts[level as usize]);
        }
    }
}

impl DualMemory {
    /// One uniform per level of receivers, ready for dynamic offsets.
    pub fn write(&self, queue: &wgpu::Queue, scatter: &ScatterLayout, tree: &Tree, theta: f32) {
        let stride = UNIFORM_STRIDE as usize;
        let mut sources = [[0; 4]; 4];
        for (level, offset) in tree.source_offsets.iter().enumerate() {
            sources[level / 4][level % 4] = *offset;
        }
        let mut bytes = vec![0; stride * (self.start_level as usize + 1)];
        for (level, slot) in (0..).zip(bytes.chunks_mut(stride)) {
            let uniform = DualLayout {
                table: scatter.table,
                texel_count: scatter.texel_count,
                level,
                start_level: self.start_level,
                top_level: scatter.top_level,
                theta_squared: theta * theta,
                leaf_theta_squared: (LEAF_THETA * theta).powi(2),
                z_r_squared: scatter.z_r_squared,
                capacity: self.capacity,
                first_receiver: tree.sources(),
                padding: [0; 3],
                offsets: scatter.offsets,
                sources,
            };
            slot[..size_of::<DualLayout>()].copy_from_slice(bytemuck::bytes_of(&uniform));
        }
        queue.write_buffer(&self.uniforms, 0, &bytes);
    }
}
