//! Dual: the scatter sum with groups of texels at both ends, level by level from the coarsest receivers to the texels.
//!
//! reads  bounds and lamps of the tree, kernel table      writes  exitance per texel, linear RGB, or what points need
//! judge  `Method::AllPairs` on the same adapter          WGSL    `dual.wgsl`

use super::points::{Field, PointMemory, Points};
use crate::Error;
use crate::buffers::Buffers;
use crate::evaluate::Evaluate;
use crate::gpu::{
    self, FLOAT_TEXTURE, MediumKind, Pass, PerMedium, READ, UNIFORM_ARRAY, UNIFORM_STRIDE, WRITE,
};
use crate::layout::{DualLayout, ScatterLayout};
use crate::stages::cluster::Tree;
use std::sync::Arc;

/// The coarsest level of receivers has at least this many nodes: fewer would not share enough to be worth a dispatch.
const LEAST_RECEIVERS: u32 = 64;
/// Opening angle of single texels over that of groups: they test the source's size alone. On the creature at 256² a ratio of 0.75 doubles the
/// error, 0.45 hardly gains and takes a tenth more evaluations.
const LEAF_THETA: f32 = 0.6;
/// Opening angle for which [`BodyDescriptor::list_entries`](crate::BodyDescriptor::list_entries) counts.
const DEFAULT_THETA: f32 = 0.65;
/// Bytes in front of the lists.
const LISTS_HEADER: u64 = 16;
/// Words of the empty list and the list of the root.
const ROOT: u32 = 3;
/// Bytes of an expansion, as in `shared/expansion.wgsl`: ten vectors.
pub(crate) const EXPANSION: u64 = 160;

pub(crate) struct Dual {
    layout: wgpu::BindGroupLayout,
    start: wgpu::ComputePipeline,
    inner: PerMedium,
    leaf: PerMedium,
    pub points: Points,
}

const _: () = assert!(size_of::<DualLayout>() as u64 <= UNIFORM_STRIDE);

/// What the dual scatter of one body remembers during a frame.
pub(crate) struct DualMemory {
    uniforms: wgpu::Buffer,
    pub lists: Arc<Lists>,
    group: wgpu::BindGroup,
    plan: Plan,
    evaluate: Evaluate,
    pub kind: MediumKind,
    /// Where exitance is evaluated at points.
    pub points: Option<PointMemory>,
}

/// What is written and read within the stage alone, unless exitance is evaluated at points.
pub(crate) struct Lists {
    pub expansions: wgpu::Buffer,
    pub heads: wgpu::Buffer,
    pub lists: wgpu::Buffer,
}

/// Bytes of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ListSizes {
    expansions: u64,
    heads: u64,
    lists: u64,
}

impl ListSizes {
    pub fn new(tree: &Tree, demand: Demand, limits: &wgpu::Limits) -> Self {
        Self {
            expansions: expansions(tree, demand.evaluate),
            heads: 4 * u64::from(tree.clusters()),
            lists: LISTS_HEADER + 4 * u64::from(capacity(tree.counts[0], demand, limits)),
        }
    }

    pub fn or_larger(self, other: Self) -> Self {
        Self {
            expansions: self.expansions.max(other.expansions),
            heads: self.heads.max(other.heads),
            lists: self.lists.max(other.lists),
        }
    }

    pub fn bytes(self) -> u64 {
        self.expansions + self.heads + self.lists
    }
}

impl Lists {
    pub fn new(device: &wgpu::Device, sizes: ListSizes) -> Self {
        Self {
            expansions: gpu::buffer(device, "expansions", sizes.expansions),
            heads: gpu::buffer(device, "heads", sizes.heads),
            lists: gpu::buffer(device, "lists", sizes.lists),
        }
    }

    pub fn sizes(&self) -> ListSizes {
        ListSizes { expansions: self.expansions.size(), heads: self.heads.size(), lists: self.lists.size() }
    }

    /// Whether they are so large or larger.
    pub fn hold(&self, sizes: ListSizes) -> bool {
        self.sizes() == self.sizes().or_larger(sizes)
    }
}

/// What decides how much memory a body's dual scatter needs.
#[derive(Clone, Copy)]
pub(crate) struct Demand {
    /// Words of the lists per texel at the default opening angle.
    pub list_entries: u32,
    pub theta: f32,
    pub evaluate: Evaluate,
}

/// Level of the coarsest receivers; 0 where texels are too few for groups of them.
fn start_level(tree: &Tree) -> u32 {
    tree.counts.iter().rposition(|count| *count >= LEAST_RECEIVERS).unwrap_or(0) as u32
}

/// Words for the lists: as many as wished, as a binding holds, and as the 28 bits of a link can tell apart. Too few only cost time.
fn capacity(texels: u32, demand: Demand, limits: &wgpu::Limits) -> u32 {
    let room = ((binding(limits) - LISTS_HEADER) / 4).min(1 << 28);
    let growth = (DEFAULT_THETA / demand.theta).max(1.0).powi(2);
    let wished = f64::from(texels) * f64::from(demand.list_entries) * f64::from(growth);
    (wished as u64 + u64::from(ROOT)).min(room) as u32
}

fn binding(limits: &wgpu::Limits) -> u64 {
    gpu::binding_limit(limits).min(1 << 30)
}

/// The first receiver whose expansion is kept: on the second level, for those of the first go straight to the texels; or on the first,
/// for points.
fn first_expansion(tree: &Tree, evaluate: Evaluate) -> u32 {
    let level = if evaluate == Evaluate::PerTexel { 2 } else { 1 };
    tree.offsets.get(level).copied().unwrap_or(0)
}

/// Bytes of the expansions.
fn expansions(tree: &Tree, evaluate: Evaluate) -> u64 {
    EXPANSION * u64::from((tree.clusters() - first_expansion(tree, evaluate)).max(1))
}

/// Whether the device can hold what the dual scatter remembers.
pub(crate) fn check(tree: &Tree, evaluate: Evaluate, limits: &wgpu::Limits) -> Result<(), Error> {
    let (required, actual) = (expansions(tree, evaluate), binding(limits));
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
        let pipelines = gpu::pipeline_layout(device, "dual", &[&layout]);
        let shaders = [translume_shaders::DUAL, translume_shaders::DUAL_ORIENTED];
        Self {
            start: gpu::compute_pipeline(device, &layout, &module, "start"),
            inner: PerMedium::new(device, &pipelines, shaders, "inner"),
            leaf: PerMedium::new(device, &pipelines, shaders, "leaf"),
            points: Points::new(device),
            layout,
        }
    }

    /// Binds a body's lists and expansions.
    pub fn memory(
        &self,
        device: &wgpu::Device,
        (buffers, kernel_table): (&Buffers, &wgpu::TextureView),
        (tree, demand): (&Tree, Demand),
        lists: Arc<Lists>,
    ) -> DualMemory {
        let plan = Plan::new(tree, demand, &device.limits());
        let uniforms = gpu::uniform_buffer(device, "dual", UNIFORM_STRIDE * u64::from(plan.start_level + 1));
        let resources = [
            gpu::uniform_slot::<DualLayout>(&uniforms),
            buffers.bounds.as_entire_binding(),
            buffers.lamps.as_entire_binding(),
            buffers.exitance.as_entire_binding(),
            lists.expansions.as_entire_binding(),
            lists.heads.as_entire_binding(),
            lists.lists.as_entire_binding(),
            wgpu::BindingResource::TextureView(kernel_table),
        ];
        let group = gpu::bind(device, "dual", &self.layout, &resources);
        let field = Field {
            uniforms: &uniforms,
            expansions: &lists.expansions,
            heads: &lists.heads,
            lists: &lists.lists,
            kernel_table,
        };
        let points = self.points.memory(device, buffers, &field, demand.evaluate);
        let evaluate = demand.evaluate;
        DualMemory { uniforms, lists, group, plan, evaluate, kind: MediumKind::default(), points }
    }

    /// Makes the pipelines of a body, so that no frame has to.
    pub fn compile(&self, memory: &DualMemory) {
        self.inner.get(memory.kind);
        match memory.points {
            Some(PointMemory::Vertices { .. }) => _ = self.points.vertices.get(memory.kind),
            Some(PointMemory::Fragments { .. }) => (),
            None => _ = self.leaf.get(memory.kind),
        }
    }

    pub fn encode(&self, pass: &mut Pass<'_>, memory: &DualMemory, tree: &Tree, vertices: u32) {
        pass.set_pipeline(&self.start);
        pass.set_bind_group(&memory.group, &[0]);
        pass.dispatch_workgroups(1, 1);
        let last = u32::from(memory.points.is_some());
        for level in (last..=memory.plan.start_level).rev() {
            let pipeline = if level > 0 { &self.inner } else { &self.leaf };
            pass.set_pipeline(pipeline.get(memory.kind));
            pass.set_bind_group(&memory.group, &[level * UNIFORM_STRIDE as u32]);
            pass.dispatch(tree.counts[level as usize]);
        }
        if let Some(points) = &memory.points {
            self.points.encode(pass, points, vertices, memory.kind);
        }
    }
}

impl DualMemory {
    /// Whether it serves this demand too.
    pub fn serves(&self, demand: Demand, tree: &Tree, limits: &wgpu::Limits) -> bool {
        self.evaluate == demand.evaluate && self.plan.capacity >= capacity(tree.counts[0], demand, limits)
    }

    /// Bytes, apart from the lists.
    pub fn bytes(&self) -> u64 {
        self.uniforms.size() + self.vertex_exitance().map_or(0, wgpu::Buffer::size)
    }

    pub fn vertex_exitance(&self) -> Option<&wgpu::Buffer> {
        self.points.as_ref().and_then(PointMemory::vertex_exitance)
    }

    /// One uniform per level of receivers, ready for dynamic offsets.
    pub fn write(&self, queue: &wgpu::Queue, scatter: &ScatterLayout, tree: &Tree, theta: f32) {
        queue.write_buffer(&self.uniforms, 0, &self.plan.uniforms(scatter, tree, theta));
    }
}

/// How a body's tree is walked from both ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    /// Level of the coarsest receivers.
    pub start_level: u32,
    /// Words of the lists.
    pub capacity: u32,
    first_expansion: u32,
}

impl Plan {
    pub fn new(tree: &Tree, demand: Demand, limits: &wgpu::Limits) -> Self {
        Self {
            start_level: start_level(tree),
            capacity: capacity(tree.counts[0], demand, limits),
            first_expansion: first_expansion(tree, demand.evaluate),
        }
    }

    /// One uniform per level of receivers, ready for dynamic offsets.
    pub fn uniforms(&self, scatter: &ScatterLayout, tree: &Tree, theta: f32) -> Vec<u8> {
        let stride = UNIFORM_STRIDE as usize;
        let offsets = Tree::packed(&tree.offsets);
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
                first_expansion: self.first_expansion,
                padding: [0; 2],
                terms: scatter.terms,
                offsets,
                sources: scatter.sources,
            };
            slot[..size_of::<DualLayout>()].copy_from_slice(bytemuck::bytes_of(&uniform));
        }
        bytes
    }
}
