//! Cluster: the texels summed up their tree, four to one, level by level.
//!
//! reads  texel positions, normals, irradiance, which texels are needed      writes  clusters, receivers, bounds and lamps of every level
//! twin   `translume_reference::cluster`            WGSL    `cluster.wgsl`

use crate::buffers::Buffers;
use crate::gpu::{self, Pass, READ, UNIFORM, UNIFORM_ARRAY, UNIFORM_STRIDE, WRITE};
use crate::layout::LevelLayout;

pub(crate) struct ClusterStage {
    layout: wgpu::BindGroupLayout,
    from_texels: wgpu::ComputePipeline,
    from_clusters: wgpu::ComputePipeline,
}

/// Where the levels of a body's tree lie. Level 0 is the texels; level l has one node for every 4^l of them.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    /// Nodes of each level, from the texels up to a single node; two levels at least.
    pub counts: Vec<u32>,
    /// First entry of each level in the buffer of clusters; level 0 is not in it.
    pub offsets: Vec<u32>,
    /// First entry of each level among the sources in the buffer of bounds. Every node has four children there, some of them dark.
    pub source_offsets: Vec<u32>,
}

impl Tree {
    pub fn new(texels: u32) -> Self {
        let mut counts = vec![texels];
        let mut offsets = vec![0];
        let mut total = 0;
        let mut count = texels;
        while count > 1 || counts.len() == 1 {
            count = count.div_ceil(4);
            counts.push(count);
            offsets.push(total);
            total += count;
        }
        let mut source_offsets = vec![0];
        for (level, count) in counts.iter().enumerate().skip(1) {
            source_offsets.push(source_offsets[level - 1] + 4 * count);
        }
        Self { counts, offsets, source_offsets }
    }

    /// Entries of the buffer of clusters.
    pub fn clusters(&self) -> u32 {
        self.counts.iter().skip(1).sum()
    }

    /// Entries of the sources in the buffer of bounds; those of the receivers follow.
    pub fn sources(&self) -> u32 {
        self.source_offsets.last().map_or(0, |last| last + 1)
    }

    /// One number a level, as shaders read them.
    pub fn packed(levels: &[u32]) -> [[u32; 4]; 4] {
        let mut packed = [[0; 4]; 4];
        for (level, number) in levels.iter().enumerate() {
            packed[level / 4][level % 4] = *number;
        }
        packed
    }

    pub fn top_level(&self) -> u32 {
        self.counts.len() as u32 - 1
    }

    /// One uniform per level above the texels, ready for dynamic offsets.
    pub fn uniforms(&self) -> Vec<u8> {
        let stride = UNIFORM_STRIDE as usize;
        let mut bytes = vec![0; stride * (self.counts.len() - 1).max(1)];
        for level in 1..self.counts.len() {
            let uniform = LevelLayout {
                child_count: self.counts[level - 1],
                node_count: self.counts[level],
                child_offset: self.offsets[level - 1],
                node_offset: self.offsets[level],
                source_offset: self.source_offsets[level],
                receiver_offset: self.sources() + self.offsets[level],
                child_sources: self.source_offsets[level - 1],
                padding: 0,
            };
            let at = stride * (level - 1);
            bytes[at..at + size_of::<LevelLayout>()].copy_from_slice(bytemuck::bytes_of(&uniform));
        }
        bytes
    }
}

impl ClusterStage {
    pub fn new(device: &wgpu::Device) -> Self {
        let types = [UNIFORM_ARRAY, READ, READ, READ, WRITE, WRITE, WRITE, WRITE, UNIFORM, READ];
        let layout = gpu::layout(device, "cluster", wgpu::ShaderStages::COMPUTE, &types);
        let module = gpu::module(device, translume_shaders::CLUSTER);
        Self {
            from_texels: gpu::compute_pipeline(device, &layout, &module, "from_texels"),
            from_clusters: gpu::compute_pipeline(device, &layout, &module, "from_clusters"),
            layout,
        }
    }

    pub fn bind(&self, device: &wgpu::Device, buffers: &Buffers) -> wgpu::BindGroup {
        let resources = [
            gpu::uniform_slot::<LevelLayout>(&buffers.cluster_uniforms),
            buffers.texel_positions.as_entire_binding(),
            buffers.texel_normals.as_entire_binding(),
            buffers.irradiance.as_entire_binding(),
            buffers.clusters.as_entire_binding(),
            buffers.receivers.as_entire_binding(),
            buffers.bounds.as_entire_binding(),
            buffers.lamps.as_entire_binding(),
            buffers.need.as_entire_binding(),
            buffers.marks.as_entire_binding(),
        ];
        gpu::bind(device, "cluster", &self.layout, &resources)
    }

    pub fn encode(&self, pass: &mut Pass<'_>, group: &wgpu::BindGroup, tree: &Tree) {
        for level in 1..tree.counts.len() {
            pass.set_pipeline(if level == 1 { &self.from_texels } else { &self.from_clusters });
            pass.set_bind_group(group, &[(level - 1) as u32 * UNIFORM_STRIDE as u32]);
            pass.dispatch(tree.counts[level]);
        }
    }
}
