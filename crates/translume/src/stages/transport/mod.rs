//! Transport: light that entered → radiant exitance, by diffusion with the boundary that the body has.
//!
//! reads  texel positions, normals, irradiance, lights, marks      writes  exitance per texel, linear RGB
//! twin   `translume_reference::transport`
//!
//! | WGSL | what it does | twin |
//! | --- | --- | --- |
//! | `transport/group.wgsl` | texels, so many to a site | |
//! | `transport/sites.wgsl` | sites as discs, summed up their tree | `sites` |
//! | `transport/source.wgsl`, `shared/ray.wgsl`, `shared/fan.wgsl` | where light scatters first, through what it came, what the body hides of the sky | `source`, `rays` |
//! | `transport/merge.wgsl` | what sites send, summed up their tree | |
//! | `kernel/potential.wgsl`, `dual.wgsl` | the sums of the equation | `equation`, `disc` |
//! | `transport/returning.wgsl` | light that enters again | `equation` |
//! | `transport/krylov.wgsl` | the next try | `krylov` |
//! | `transport/layer.wgsl` | exitance by the diffuse law, φ under the surface | `layer` |
//! | `transport/picture.wgsl` | radiance towards the eye, once scattered light, beams that spread | `picture`, `single`, `phase` |
//! | `transport/twice.wgsl` | twice scattered light | `twice` |
//! | `transport/near.wgsl` | the sites around each | |
//! | `transport/smooth.wgsl`, `transport/strangers.wgsl` | exitance of texels from that of the sites around | |

mod memory;
mod sites;

use crate::gpu::{self, Pass, READ, UNIFORM, UNIFORM_ARRAY, UNIFORM_STRIDE, WRITE};
use crate::stages::cluster::Tree;
pub(crate) use memory::{Inputs, TransportMemory, bytes, check, finest};
pub(crate) use sites::Sites;
use wgpu::ComputePipeline;

/// Tries of the first frame, and of every later one.
const COLD: u32 = 8;
const WARM: u32 = 2;

/// Share of the light that is not explained by the last solution from which on a body is another.
const STALE: f32 = 0.3;

/// How often light that leaves a concave body is followed back into it for a direction of the first frame.
const RETURNS: u32 = 2;

pub(crate) struct TransportStage {
    layouts: Layouts,
    group: ComputePipeline,
    sites: [ComputePipeline; 2],
    enter: ComputePipeline,
    light_of_sites: ComputePipeline,
    merge_light: ComputePipeline,
    merge_surface: ComputePipeline,
    begin: ComputePipeline,
    /// Inner and leaf of each sum.
    light: [ComputePipeline; 2],
    surface: [ComputePipeline; 2],
    lit_below: [ComputePipeline; 2],
    sent_below: [ComputePipeline; 2],
    leave: ComputePipeline,
    merge_leaving: ComputePipeline,
    come_in: ComputePipeline,
    charge: ComputePipeline,
    charge_found: ComputePipeline,
    krylov: Krylov,
    diffuse: ComputePipeline,
    parabola: ComputePipeline,
    gathered: ComputePipeline,
    near: ComputePipeline,
    smooth: ComputePipeline,
    strangers: ComputePipeline,
}

/// What `krylov.wgsl` does, in its order.
struct Krylov {
    measure: ComputePipeline,
    settle_mean: ComputePipeline,
    start: ComputePipeline,
    adopt: ComputePipeline,
    take: ComputePipeline,
    project_direction: ComputePipeline,
    weigh_direction: ComputePipeline,
    part: ComputePipeline,
    turn: ComputePipeline,
    project_residual: ComputePipeline,
    weigh_residual: ComputePipeline,
    /// The same for the first time in a frame, where a body moved and where it stands still since.
    weigh_moved: ComputePipeline,
    weigh_anew: ComputePipeline,
    advance: ComputePipeline,
    give_up: ComputePipeline,
}

/// Of the bindings of each module.
struct Layouts {
    group: wgpu::BindGroupLayout,
    sites: wgpu::BindGroupLayout,
    source: wgpu::BindGroupLayout,
    merge: wgpu::BindGroupLayout,
    potential: wgpu::BindGroupLayout,
    returning: wgpu::BindGroupLayout,
    krylov: wgpu::BindGroupLayout,
    layer: wgpu::BindGroupLayout,
    picture: wgpu::BindGroupLayout,
    near: wgpu::BindGroupLayout,
    smooth: wgpu::BindGroupLayout,
}

/// What directions of former frames are worth, and how rough those of this one may be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Since {
    /// It came to be: there are none.
    #[default]
    Ever,
    /// It moved on, and will.
    Moved,
    /// It moved until then: what they say is not quite so.
    Rested,
    /// It stood still, too.
    Stood,
}

/// What of the light's way a frame does anew.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Steps {
    /// Tries; none where nothing but the eye moved.
    pub tries: u32,
    /// What the body did since the last frame.
    pub since: Since,
    /// Whether light is gathered towards an eye.
    pub seen: bool,
}

impl TransportStage {
    pub fn new(device: &wgpu::Device) -> Self {
        let layout = |label, types: &[wgpu::BindingType]| {
            gpu::layout(device, label, wgpu::ShaderStages::COMPUTE, types)
        };
        let layouts = Layouts {
            group: layout("group", &[UNIFORM, READ, READ, READ, READ, WRITE, WRITE, WRITE]),
            sites: layout("sites", &[UNIFORM_ARRAY, READ, READ, WRITE, WRITE, WRITE, UNIFORM]),
            source: layout("source", &[UNIFORM, UNIFORM, READ, READ, READ, READ, WRITE, WRITE, WRITE, READ]),
            merge: layout("merge", &[UNIFORM_ARRAY, UNIFORM, WRITE, WRITE, WRITE]),
            potential: layout(
                "potential",
                &[UNIFORM_ARRAY, READ, READ, WRITE, WRITE, WRITE, WRITE, UNIFORM, READ, READ],
            ),
            returning: layout(
                "returning",
                &[UNIFORM_ARRAY, UNIFORM, READ, READ, READ, READ, WRITE, WRITE, READ, READ],
            ),
            krylov: layout("krylov", &[UNIFORM, READ, READ, READ, WRITE, WRITE, WRITE, WRITE, WRITE]),
            layer: layout("layer", &[UNIFORM, READ, READ, READ, READ, READ, WRITE, WRITE]),
            picture: layout("picture", &[UNIFORM, UNIFORM, READ, READ, READ, READ, WRITE, READ, READ, READ]),
            near: layout("near", &[UNIFORM, READ, READ, READ, WRITE]),
            smooth: layout("smooth", &[UNIFORM, READ, READ, READ, READ, READ, READ, READ, WRITE]),
        };
        let module = |shader| gpu::module(device, shader);
        let pipeline =
            |layout, module: &wgpu::ShaderModule, entry| gpu::compute_pipeline(device, layout, module, entry);
        let sites = module(translume_shaders::SITES);
        let merge = module(translume_shaders::MERGE);
        let potential = module(translume_shaders::POTENTIAL);
        let returning = module(translume_shaders::RETURNING);
        let krylov = module(translume_shaders::KRYLOV);
        let layer = module(translume_shaders::LAYER);
        let weigh = |stale| {
            let constants = [("STALE", stale)];
            gpu::specialised_pipeline(device, &layouts.krylov, &krylov, "weigh_residual", &constants)
        };
        let sum = |light: bool, below: bool| {
            let constants = [("LIGHT", light), ("BELOW", below)];
            let constants = constants.map(|(name, on)| (name, f64::from(u8::from(on))));
            ["inner", "leaf"].map(|entry| {
                gpu::specialised_pipeline(device, &layouts.potential, &potential, entry, &constants)
            })
        };
        Self {
            group: pipeline(&layouts.group, &module(translume_shaders::GROUP), "group"),
            sites: ["from_discs", "from_clusters"].map(|entry| pipeline(&layouts.sites, &sites, entry)),
            enter: pipeline(&layouts.source, &module(translume_shaders::SOURCE), "enter"),
            light_of_sites: pipeline(&layouts.merge, &merge, "light_of_sites"),
            merge_light: pipeline(&layouts.merge, &merge, "light"),
            merge_surface: pipeline(&layouts.merge, &merge, "surface"),
            begin: pipeline(&layouts.potential, &potential, "start"),
            light: sum(true, false),
            surface: sum(false, false),
            lit_below: sum(true, true),
            sent_below: sum(false, true),
            leave: pipeline(&layouts.returning, &returning, "leave"),
            merge_leaving: pipeline(&layouts.returning, &returning, "merge"),
            come_in: pipeline(&layouts.returning, &returning, "come_in"),
            charge: pipeline(&layouts.returning, &returning, "charge"),
            charge_found: pipeline(&layouts.returning, &returning, "charge_found"),
            krylov: Krylov {
                measure: pipeline(&layouts.krylov, &krylov, "measure"),
                settle_mean: pipeline(&layouts.krylov, &krylov, "settle_mean"),
                start: pipeline(&layouts.krylov, &krylov, "start"),
                adopt: pipeline(&layouts.krylov, &krylov, "adopt"),
                take: pipeline(&layouts.krylov, &krylov, "take"),
                project_direction: pipeline(&layouts.krylov, &krylov, "project_direction"),
                weigh_direction: pipeline(&layouts.krylov, &krylov, "weigh_direction"),
                part: pipeline(&layouts.krylov, &krylov, "part"),
                turn: pipeline(&layouts.krylov, &krylov, "turn"),
                project_residual: pipeline(&layouts.krylov, &krylov, "project_residual"),
                weigh_residual: pipeline(&layouts.krylov, &krylov, "weigh_residual"),
                weigh_moved: weigh(f64::from(STALE * STALE)),
                weigh_anew: weigh(-1.0),
                advance: pipeline(&layouts.krylov, &krylov, "advance"),
                give_up: pipeline(&layouts.krylov, &krylov, "give_up"),
            },
            diffuse: pipeline(&layouts.layer, &layer, "diffuse"),
            parabola: pipeline(&layouts.layer, &layer, "parabola"),
            gathered: pipeline(&layouts.picture, &module(translume_shaders::PICTURE), "gathered"),
            near: pipeline(&layouts.near, &module(translume_shaders::NEAR), "near"),
            strangers: pipeline(&layouts.smooth, &module(translume_shaders::STRANGERS), "strangers"),
            smooth: pipeline(&layouts.smooth, &module(translume_shaders::SMOOTH), "smooth_out"),
            layouts,
        }
    }

    /// Tries of a frame.
    pub fn tries(is_first: bool) -> u32 {
        if is_first { COLD } else { WARM }
    }

    pub fn encode(&self, pass: &mut Pass<'_>, memory: &TransportMemory, steps: Steps) {
        let frame = Recorder { stage: self, memory, tree: &memory.sites.tree };
        if steps.tries > 0 {
            frame.each(pass, &self.group, &memory.group);
            frame.up(pass, &memory.discs, |level| &self.sites[usize::from(level > 1)]);
            frame.each(pass, &self.near, &memory.near);
            frame.each(pass, &self.enter, &memory.source);
            frame.each_of(pass, &self.light_of_sites, &memory.merge);
            frame.up(pass, &memory.merge, |_| &self.merge_light);
            frame.sum(pass, &self.light, &memory.given, Angle::Narrow);
            let krylov = &self.krylov;
            frame.groups(pass, &krylov.measure);
            frame.one(pass, &krylov.settle_mean);
            frame.each(pass, &krylov.start, &memory.krylov);
            frame.apply(pass, 1, Angle::Narrow);
            frame.each(pass, &krylov.adopt, &memory.krylov);
            frame.minimise(
                pass,
                match steps.since {
                    Since::Moved => &krylov.weigh_moved,
                    Since::Rested => &krylov.weigh_anew,
                    Since::Ever | Since::Stood => &krylov.weigh_residual,
                },
            );
            // Where a body moves a direction may be roughly what it is, and one of two without what it makes come in again: the next frame finds out what the
            // equation makes of the solution.
            let angle = if steps.since == Since::Moved { Angle::Wide } else { Angle::Narrow };
            for index in 0..steps.tries {
                let returns = match index {
                    _ if steps.tries > WARM => RETURNS,
                    1.. if steps.since == Since::Moved => 0,
                    _ => 1,
                };
                frame.apply(pass, returns, angle);
                frame.each(pass, &krylov.take, &memory.krylov);
                frame.groups(pass, &krylov.project_direction);
                frame.one(pass, &krylov.weigh_direction);
                frame.each(pass, &krylov.part, &memory.krylov);
                frame.one(pass, &krylov.turn);
                frame.minimise(pass, &krylov.weigh_residual);
            }
            if steps.seen {
                frame.send(pass, &self.charge_found);
                frame.sum(pass, &self.lit_below, &memory.lit_below, Angle::Narrow);
                frame.sum(pass, &self.sent_below, &memory.sent_below, Angle::Narrow);
                frame.each(pass, &self.parabola, &memory.layer);
            }
        }
        // Who is turned away from the eye, and who is not seen from one at all.
        frame.each(pass, &self.diffuse, &memory.layer);
        if steps.seen {
            frame.each(pass, &self.gathered, &memory.picture);
        }
        frame.each_texel(pass, &self.smooth, &memory.smooth);
        if memory.sites.level > 0 {
            frame.each_texel(pass, &self.strangers, &memory.strangers);
        }
    }
}

/// How large clusters of a sum may look: as the tolerance has it, or more so.
#[derive(Clone, Copy)]
enum Angle {
    Narrow,
    Wide,
}

struct Recorder<'a> {
    stage: &'a TransportStage,
    memory: &'a TransportMemory,
    tree: &'a Tree,
}

impl<'a> Recorder<'a> {
    /// Every level above the sites in turn.
    fn up(
        &self,
        pass: &mut Pass<'_>,
        group: &wgpu::BindGroup,
        pipeline: impl Fn(usize) -> &'a ComputePipeline,
    ) {
        for level in 1..self.tree.counts.len() {
            pass.set_pipeline(pipeline(level));
            pass.set_bind_group(group, &[(level - 1) as u32 * UNIFORM_STRIDE as u32]);
            pass.dispatch(self.tree.counts[level]);
        }
    }

    /// Every site.
    fn each(&self, pass: &mut Pass<'_>, pipeline: &ComputePipeline, group: &wgpu::BindGroup) {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(group, &[]);
        pass.dispatch(self.tree.counts[0]);
    }

    fn each_texel(&self, pass: &mut Pass<'_>, pipeline: &ComputePipeline, group: &wgpu::BindGroup) {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(group, &[]);
        pass.dispatch(self.memory.sites.texels);
    }

    /// The solver's sums over all sites.
    fn groups(&self, pass: &mut Pass<'_>, pipeline: &ComputePipeline) {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(&self.memory.krylov, &[]);
        pass.dispatch_workgroups(self.memory.groups, 1);
    }

    fn one(&self, pass: &mut Pass<'_>, pipeline: &ComputePipeline) {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(&self.memory.krylov, &[]);
        pass.dispatch_workgroups(1, 1);
    }

    /// What the equation makes of the trial, with light that leaves a concave body followed back into it so often.
    fn apply(&self, pass: &mut Pass<'_>, returns: u32, angle: Angle) {
        let (stage, group) = (self.stage, &self.memory.returning);
        for _ in 0..returns {
            self.each_of(pass, &stage.leave, group);
            self.up(pass, group, |_| &stage.merge_leaving);
            self.each_of(pass, &stage.come_in, group);
        }
        self.send(pass, &stage.charge);
        self.sum(pass, &stage.surface, &self.memory.sent, angle);
    }

    /// What the surface sends.
    fn send(&self, pass: &mut Pass<'_>, charge: &ComputePipeline) {
        self.each_of(pass, charge, &self.memory.returning);
        self.up(pass, &self.memory.merge, |_| &self.stage.merge_surface);
    }

    /// Every site, in a module that knows levels, too.
    fn each_of(&self, pass: &mut Pass<'_>, pipeline: &ComputePipeline, group: &wgpu::BindGroup) {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(group, &[0]);
        pass.dispatch(self.tree.counts[0]);
    }

    /// The least residual that the directions leave, and the next trial.
    fn minimise(&self, pass: &mut Pass<'_>, weigh: &ComputePipeline) {
        let krylov = &self.stage.krylov;
        self.groups(pass, &krylov.project_residual);
        self.one(pass, weigh);
        self.each(pass, &krylov.advance, &self.memory.krylov);
        self.one(pass, &krylov.give_up);
    }

    /// One traversal.
    fn sum(
        &self,
        pass: &mut Pass<'_>,
        [inner, leaf]: &[ComputePipeline; 2],
        group: &wgpu::BindGroup,
        angle: Angle,
    ) {
        pass.set_pipeline(&self.stage.begin);
        pass.set_bind_group(group, &[0]);
        pass.dispatch_workgroups(1, 1);
        let levels = self.memory.plan.start_level + 1;
        for level in (0..levels).rev() {
            pass.set_pipeline(if level > 0 { inner } else { leaf });
            let uniform = match angle {
                Angle::Narrow => level,
                Angle::Wide => levels + level,
            };
            pass.set_bind_group(group, &[uniform * UNIFORM_STRIDE as u32]);
            pass.dispatch(self.tree.counts[level as usize]);
        }
    }
}
