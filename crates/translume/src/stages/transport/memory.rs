//! What the boundary solver of one body remembers.

use super::{Sites, TransportStage};
use crate::Error;
use crate::buffers::Buffers;
use crate::gpu::{self, UNIFORM_STRIDE};
use crate::kernel_table::KernelTableLayout;
use crate::layout::{
    ChargeLayout, DualLayout, LevelLayout, NodeLayout, ParabolaLayout, ScatterLayout, ShapeLayout,
    SiteLightLayout, StateLayout, StrataLayout, SurroundingsLayout, TermLayout, TransportLayout,
};
use crate::stages::cluster::Tree;
use crate::stages::scatter::dual::{Demand, Lists, Plan};
use std::sync::Arc;

/// Most workgroups of the solver's sums.
const MOST_GROUPS: u32 = 256;
/// Texels that are worth a workgroup of them.
const TEXELS_PER_GROUP: u32 = 512;
/// Directions, as in `krylov.wgsl`.
const DIRECTIONS: u64 = StateLayout::DIRECTIONS as u64;
/// Of pairs of them, of each with a target, and two more.
const PRODUCTS: u64 = DIRECTIONS * (DIRECTIONS + 1) / 2 + DIRECTIONS + 2;
/// `Angle::Wide` over `Angle::Narrow`, and no wider than this: beyond, expansions say little.
const WIDER: f32 = 1.9;
const WIDEST: f32 = 0.9;

pub(crate) struct TransportMemory {
    pub sites: Sites,
    uniform: wgpu::Buffer,
    levels: wgpu::Buffer,
    state: wgpu::Buffer,
    bytes: u64,
    pub lists: Arc<Lists>,
    pub plan: Plan,
    pub groups: u32,
    pub group: wgpu::BindGroup,
    pub discs: wgpu::BindGroup,
    pub source: wgpu::BindGroup,
    pub merge: wgpu::BindGroup,
    pub given: wgpu::BindGroup,
    pub sent: wgpu::BindGroup,
    pub lit_below: wgpu::BindGroup,
    pub sent_below: wgpu::BindGroup,
    pub returning: wgpu::BindGroup,
    pub krylov: wgpu::BindGroup,
    pub layer: wgpu::BindGroup,
    pub picture: wgpu::BindGroup,
    pub near: wgpu::BindGroup,
    pub smooth: wgpu::BindGroup,
    pub strangers: wgpu::BindGroup,
    layout: TransportLayout,
    /// Of the uniforms as they are; none before they were written.
    theta: Option<f32>,
}

/// What of the body it reads.
pub(crate) struct Inputs<'a> {
    pub buffers: &'a Buffers,
    pub sites: Sites,
}

impl TransportMemory {
    pub fn new(
        device: &wgpu::Device,
        stage: &TransportStage,
        Inputs { buffers, sites }: Inputs<'_>,
        demand: Demand,
        lists: Arc<Lists>,
        layout: TransportLayout,
    ) -> Self {
        let tree = &sites.tree;
        let plan = Plan::new(tree, demand, &device.limits());
        let uniform = gpu::uniform_buffer(device, "transport", size_of::<TransportLayout>() as u64);
        let levels =
            gpu::uniform_buffer(device, "potential", 2 * UNIFORM_STRIDE * u64::from(plan.start_level + 1));
        let sizes = Sizes::new(&sites);
        let storage = |label, bytes: u64| gpu::buffer(device, label, bytes);
        let site_levels =
            gpu::buffer_with(device, "levels of sites", wgpu::BufferUsages::UNIFORM, &tree.uniforms());
        let [site_positions, site_normals, site_exitance] =
            ["site positions", "site normals", "site exitance"].map(|label| storage(label, sizes.vectors));
        let surroundings = storage("surroundings", sizes.surroundings);
        let site_lights = storage("site lights", sizes.lights);
        let bounds = storage("bounds of sites", sizes.bounds);
        let nodes = storage("nodes", sizes.nodes);
        let shapes = storage("shapes", sizes.shapes);
        let charges = storage("charges", sizes.charges);
        let strata = storage("strata", sizes.strata);
        let [given, sent, light_under, sent_under] =
            ["given", "sent", "light under the surface", "sent under the surface"]
                .map(|label| storage(label, sizes.vectors));
        let entered = storage("entered", 2 * sizes.vectors);
        let fluence = storage("fluence", 3 * sizes.vectors);
        let leaving = storage("leaving", sizes.leaving);
        let directions = storage("directions", sizes.directions);
        let state = storage("state", size_of::<StateLayout>() as u64);
        let groups = layout.groups;
        let partial = storage("partial sums", sizes.partial);
        let parabolas = storage("parabolas", sizes.parabolas);

        let bind = |label, layout: &wgpu::BindGroupLayout, resources: &[wgpu::BindingResource<'_>]| {
            gpu::bind(device, label, layout, resources)
        };
        let level = || gpu::uniform_slot::<LevelLayout>(&site_levels);
        let all = wgpu::Buffer::as_entire_binding;
        let sum = |label, sums: &wgpu::Buffer| {
            let resources = [
                gpu::uniform_slot::<DualLayout>(&levels),
                all(&bounds),
                all(&charges),
                all(sums),
                all(&lists.expansions),
                all(&lists.heads),
                all(&lists.lists),
                all(&uniform),
                all(&shapes),
                all(&strata),
            ];
            bind(label, &stage.layouts.potential, &resources)
        };
        let to_texels = |label, known: &wgpu::Buffer| {
            let resources = [
                all(&uniform),
                all(known),
                all(&site_positions),
                all(&site_normals),
                all(&site_exitance),
                all(&buffers.texel_positions),
                all(&buffers.texel_normals),
                all(&buffers.marks),
                all(&buffers.exitance),
            ];
            bind(label, &stage.layouts.smooth, &resources)
        };
        Self {
            group: bind(
                "group",
                &stage.layouts.group,
                &[
                    all(&uniform),
                    all(&buffers.texel_positions),
                    all(&buffers.texel_normals),
                    all(&buffers.irradiance),
                    all(&buffers.marks),
                    all(&site_positions),
                    all(&site_normals),
                    all(&site_lights),
                ],
            ),
            discs: bind(
                "sites",
                &stage.layouts.sites,
                &[
                    level(),
                    all(&site_positions),
                    all(&site_normals),
                    all(&nodes),
                    all(&bounds),
                    all(&shapes),
                    all(&uniform),
                ],
            ),
            source: bind(
                "source",
                &stage.layouts.source,
                &[
                    all(&uniform),
                    all(&buffers.gather_uniform),
                    all(&site_positions),
                    all(&site_normals),
                    all(&site_lights),
                    all(&nodes),
                    all(&charges),
                    all(&strata),
                    all(&entered),
                    all(&surroundings),
                ],
            ),
            merge: bind(
                "merge",
                &stage.layouts.merge,
                &[level(), all(&uniform), all(&bounds), all(&charges), all(&strata)],
            ),
            given: sum("given", &given),
            sent: sum("sent", &sent),
            lit_below: sum("lit below", &light_under),
            sent_below: sum("sent below", &sent_under),
            returning: bind(
                "returning",
                &stage.layouts.returning,
                &[
                    level(),
                    all(&uniform),
                    all(&bounds),
                    all(&shapes),
                    all(&fluence),
                    all(&entered),
                    all(&leaving),
                    all(&charges),
                    all(&nodes),
                    all(&surroundings),
                ],
            ),
            krylov: bind(
                "krylov",
                &stage.layouts.krylov,
                &[
                    all(&uniform),
                    all(&given),
                    all(&sent),
                    all(&shapes),
                    all(&directions),
                    all(&state),
                    all(&partial),
                    all(&fluence),
                    all(&leaving),
                ],
            ),
            layer: bind(
                "layer",
                &stage.layouts.layer,
                &[
                    all(&uniform),
                    all(&strata),
                    all(&entered),
                    all(&fluence),
                    all(&light_under),
                    all(&sent_under),
                    all(&parabolas),
                    all(&site_exitance),
                ],
            ),
            picture: bind(
                "picture",
                &stage.layouts.picture,
                &[
                    all(&uniform),
                    all(&buffers.gather_uniform),
                    all(&nodes),
                    all(&site_positions),
                    all(&site_normals),
                    all(&parabolas),
                    all(&site_exitance),
                    all(&charges),
                    all(&strata),
                    all(&shapes),
                ],
            ),
            near: bind(
                "near",
                &stage.layouts.near,
                &[all(&uniform), all(&nodes), all(&site_positions), all(&site_normals), all(&surroundings)],
            ),
            smooth: to_texels("smooth", &surroundings),
            strangers: to_texels("strangers", &nodes),
            bytes: bytes(&sites),
            sites,
            uniform,
            levels,
            state,
            lists,
            plan,
            groups,
            layout,
            theta: None,
        }
    }

    /// Starts anew at the next frame: what the last one solved has nothing to do with it.
    pub fn forget(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(&self.state, 0, None);
    }

    /// Where the solver is.
    pub fn state(&self) -> &wgpu::Buffer {
        &self.state
    }

    /// Workgroups of the solver's sums.
    pub fn groups(tree: &Tree) -> u32 {
        tree.counts[0].div_ceil(TEXELS_PER_GROUP).min(MOST_GROUPS)
    }

    /// Bytes, apart from the lists.
    pub fn bytes(&self) -> u64 {
        let own = [&self.uniform, &self.levels, &self.state].map(wgpu::Buffer::size);
        own.iter().sum::<u64>() + self.bytes
    }

    /// Takes over the medium, and how small clusters have to look.
    pub fn write(&mut self, queue: &wgpu::Queue, layout: TransportLayout, theta: f32) {
        let layout = TransportLayout { eye: self.layout.eye, ..layout };
        if self.theta == Some(theta) && layout == self.layout {
            return;
        }
        (self.layout, self.theta) = (layout, Some(theta));
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&self.layout));
        let scatter = ScatterLayout {
            table: KernelTableLayout::default(),
            texel_count: layout.site_count,
            first_source: 0,
            source_count: 0,
            top_level: layout.top_level,
            theta_squared: 0.0,
            // G is singular: near is near.
            z_r_squared: 0.0,
            padding: [0; 2],
            sources: layout.sources,
            terms: [TermLayout::default(); 2],
        };
        let wide = (WIDER * theta).min(WIDEST.max(theta));
        let levels = [theta, wide].map(|theta| self.plan.uniforms(&scatter, &self.sites.tree, theta));
        queue.write_buffer(&self.levels, 0, &levels.concat());
    }

    /// Whether that is another eye.
    pub fn look(&mut self, queue: &wgpu::Queue, eye: [f32; 3]) -> bool {
        let is_new = self.layout.eye != eye;
        if is_new {
            self.layout.eye = eye;
            queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&self.layout));
        }
        is_new
    }

    /// Whether it serves this demand too.
    pub fn serves(&self, demand: Demand, level: u32, limits: &wgpu::Limits) -> bool {
        level == self.sites.level
            && self.plan.capacity >= Plan::new(&self.sites.tree, demand, limits).capacity
    }
}

/// Bytes of what grows with the body.
struct Sizes {
    bounds: u64,
    nodes: u64,
    shapes: u64,
    charges: u64,
    strata: u64,
    leaving: u64,
    directions: u64,
    partial: u64,
    parabolas: u64,
    lights: u64,
    surroundings: u64,
    /// Of a vector per site.
    vectors: u64,
}

impl Sizes {
    fn new(Sites { tree, .. }: &Sites) -> Self {
        let (sites, sources, nodes) =
            (u64::from(tree.counts[0]), u64::from(tree.sources()), u64::from(tree.clusters()).max(1));
        let of = |size: usize, count: u64| size as u64 * count;
        Self {
            bounds: 16 * (2 * sources + nodes),
            nodes: of(size_of::<NodeLayout>(), nodes),
            shapes: of(size_of::<ShapeLayout>(), sources),
            charges: of(size_of::<ChargeLayout>(), 2 * sources),
            strata: of(size_of::<StrataLayout>(), sources),
            leaving: 16 * (sources + sites),
            directions: 48 * (DIRECTIONS + 1) * sites,
            partial: 16 * PRODUCTS * u64::from(TransportMemory::groups(tree)),
            parabolas: of(size_of::<ParabolaLayout>(), sites),
            lights: of(size_of::<SiteLightLayout>(), sites),
            surroundings: of(size_of::<SurroundingsLayout>(), sites),
            vectors: 16 * sites,
        }
    }
}

/// Bytes that the boundary solver of a body takes, apart from the lists.
pub(crate) fn bytes(sites: &Sites) -> u64 {
    let Sizes {
        bounds,
        nodes,
        shapes,
        charges,
        strata,
        leaving,
        directions,
        partial,
        parabolas,
        lights,
        surroundings,
        vectors,
    } = Sizes::new(sites);
    let tree = bounds + nodes + shapes + charges + strata;
    let levels = UNIFORM_STRIDE * u64::from(sites.tree.top_level());
    tree + levels + leaving + directions + partial + parabolas + lights + surroundings + 12 * vectors
}

/// The finest level of so many texels of whose sites a binding holds all, no coarser than this.
pub(crate) fn finest(texels: u32, coarsest: u32, limits: &wgpu::Limits) -> u32 {
    (0..coarsest).find(|level| check(&Sites::new(texels, *level), limits).is_ok()).unwrap_or(coarsest)
}

/// Whether a binding holds the largest of it.
pub(crate) fn check(sites: &Sites, limits: &wgpu::Limits) -> Result<(), Error> {
    let Sizes { charges, directions, strata, .. } = Sizes::new(sites);
    let (required, actual) = (charges.max(directions).max(strata), gpu::binding_limit(limits));
    if required <= actual {
        return Ok(());
    }
    Err(Error::Limit {
        what: "the boundary solver".to_owned(),
        limit: "max_storage_buffer_binding_size",
        required,
        actual,
        remedy: "use a smaller atlas or `Transport::Classic`, or create the device with higher limits",
    })
}
