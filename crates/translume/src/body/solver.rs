//! The boundary solver of a body: what it remembers, and what of it a frame does.

use super::Body;
use crate::evaluate::Evaluate;
use crate::gpu::Pass;
use crate::stages::scatter::Method;
use crate::stages::scatter::dual::{Demand, ListSizes, Lists};
use crate::stages::transport::{self as stage, Inputs, Since, Sites, Steps, TransportMemory, TransportStage};
use crate::stages::{Stage, StageSet, Stages};
use crate::timings::Recording;
use crate::{Error, Frame, Medium, Profile, Transport, phase, transport};
use glam::Mat4;
use std::sync::Arc;

/// Frames after the last change that still solve, by two tries each: after a jump through two thirds of its morph .06 % of the creature is left after two
/// of them, .01 % after three and .002 % after four.
const SETTLING: u32 = 3;

/// A tolerance is one of the mean, and a body lit from behind is a hundred times darker than that where it is seen. With this share of the opening angle that
/// serves exitance sums are within .7 % there, with .84 of it within 1.2 %.
const NARROWING: f32 = 0.72;

pub(super) struct Solver {
    /// As it was asked for.
    pub asked: Transport,
    /// What runs; never [`Transport::Auto`].
    pub runs: Transport,
    memory: Option<TransportMemory>,
    /// Whether the next frame has nothing to begin with.
    is_first: bool,
    /// Frames that still solve although nothing changed.
    unsettled: u32,
    steps: Steps,
    spread: phase::LastTable,
}

/// What of the solver a frame records.
pub(super) struct Recorded<'a> {
    memory: &'a TransportMemory,
    steps: Steps,
    is_first: bool,
}

impl Solver {
    /// Until a frame is prepared nobody knows how large the body is.
    pub fn new(asked: Transport) -> Self {
        let runs = if asked == Transport::Auto { Transport::Classic } else { asked };
        Self {
            asked,
            runs,
            memory: None,
            is_first: true,
            unsettled: 0,
            steps: Steps::default(),
            spread: phase::LastTable::default(),
        }
    }

    pub fn bytes(&self) -> u64 {
        self.memory.as_ref().map_or(0, |memory| memory.bytes() + memory.lists.sizes().bytes())
    }

    /// Gives back all memory.
    pub fn forget(&mut self) {
        *self = Self { runs: self.runs, ..Self::new(self.asked) };
    }

    /// What the frame that is recorded now does.
    pub fn take(&mut self) -> Option<Recorded<'_>> {
        let memory = self.memory.as_ref().filter(|_| self.runs != Transport::Classic)?;
        let steps = self.steps;
        self.steps.tries = 0;
        let is_first = self.is_first && steps.tries > 0;
        self.is_first &= !is_first;
        Some(Recorded { memory, steps, is_first })
    }

    pub fn is_settled(&self) -> bool {
        self.runs == Transport::Classic || self.unsettled == 0
    }

    pub fn state(&self) -> Option<&wgpu::Buffer> {
        self.memory.as_ref().map(TransportMemory::state)
    }
}

impl Recorded<'_> {
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, stages: &Stages, recording: &mut Recording<'_>) {
        if self.is_first {
            self.memory.forget(encoder);
        }
        if let Some(stage) = stages.transport.get() {
            let mut pass = Pass::begin(encoder, Stage::Scatter, recording);
            stage.encode(&mut pass, self.memory, self.steps);
        }
    }
}

impl Body {
    /// What the transport that was asked for is in a frame of this size.
    pub(super) fn transport_for(&self, model: Mat4) -> Transport {
        if self.solver.asked != Transport::Auto {
            return self.solver.asked;
        }
        let (layers, texels) = (Transport::BoundaryLayers, self.extent.texels);
        let texel = self.scale_of(model) * self.shape.texel;
        let is_possible = !self.kind.scaled
            && !self.shares_scratch
            && check_transport(texels, layers, self.method, self.evaluate, &self.limits).is_ok();
        let is_wanted = self.profile == Profile::default() && transport::pays(&self.medium, texels, texel);
        if is_possible && is_wanted && self.has_room(texel) { layers } else { Transport::Classic }
    }

    /// Whether there may be as much as the solver takes for texels of this width, mm.
    fn has_room(&self, texel: f32) -> bool {
        let Some(demand) = self.demand_of_a_solver() else { return false };
        let growth = self.growth(demand, &self.sites(texel));
        growth == 0 || self.account.check(self.memory().total() + growth).is_ok()
    }

    /// Lets light go through the body so.
    pub(super) fn use_transport(&mut self, transport: Transport) {
        if transport != self.solver.runs {
            // The solver has no use for clusters.
            self.pending.insert(StageSet::from_stage_on(Stage::Cluster));
            self.method_stale = true;
            self.solver.runs = transport;
            self.renew_surface();
        }
    }

    fn demand_of_a_solver(&self) -> Option<Demand> {
        let Method::Dual { theta } = self.method.resolved() else { return None };
        let theta = if matches!(self.method, Method::Within { .. }) { NARROWING * theta } else { theta };
        Some(Demand { list_entries: self.list_entries, theta, evaluate: Evaluate::PerTexel })
    }

    fn solver_demand(&self) -> Option<Demand> {
        self.demand_of_a_solver().filter(|_| self.solver.runs != Transport::Classic)
    }

    /// Width of a texel, mm.
    fn texel_width(&self) -> f32 {
        self.scale() * self.shape.texel
    }

    fn sites(&self, texel: f32) -> Sites {
        let is_hasty = self.solver.asked == Transport::Auto;
        let texels = self.extent.texels;
        let wanted = transport::site_level(&self.medium, texels, texel, is_hasty);
        Sites::new(texels, wanted.max(stage::finest(texels, transport::COARSEST_LEVEL, &self.limits)))
    }

    /// Bytes that a solver takes beyond what there is.
    fn growth(&self, demand: Demand, sites: &Sites) -> u64 {
        let serves = |memory: &TransportMemory| memory.serves(demand, sites.level, &self.limits);
        if self.solver.memory.as_ref().is_some_and(serves) {
            return 0;
        }
        let needed = stage::bytes(sites) + ListSizes::new(&sites.tree, demand, &self.limits).bytes();
        needed.saturating_sub(self.solver.bytes())
    }

    /// Bytes that the next frame's solver takes beyond what it has.
    pub(super) fn solver_growth(&self) -> u64 {
        self.solver_demand().map_or(0, |demand| self.growth(demand, &self.sites(self.texel_width())))
    }

    /// Makes the solver ready for the frame, and finds out what it has to do.
    pub(super) fn refresh_solver(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, frame: &Frame<'_>) {
        let Some(demand) = self.solver_demand() else {
            self.solver.forget();
            return;
        };
        let sites = self.sites(self.texel_width());
        let groups = TransportMemory::groups(&sites.tree);
        let gathers = self.solver.runs == Transport::BoundaryLayers && self.medium.ior >= 1.0;
        // What goes on straight has no part in a diffuse law.
        let medium = Medium { g: if gathers { self.medium.g } else { 0.0 }, ..self.medium };
        let texel = self.texel_width();
        let spread = self.solver.spread.table(medium.g);
        let layout = transport::layout((&medium, spread), &sites, groups, texel);
        let solver = &mut self.solver;
        solver.memory =
            solver.memory.take().filter(|memory| memory.serves(demand, sites.level, &self.limits));
        let mut changed = self.pending.contains(Stage::Scatter);
        if solver.memory.is_none() {
            solver.is_first = true;
            changed = true;
        }
        let stages = &self.stages;
        let memory = solver.memory.get_or_insert_with(|| {
            let stage = stages.transport.get_or_init(|| TransportStage::new(device));
            let lists = Arc::new(Lists::new(device, ListSizes::new(&sites.tree, demand, &self.limits)));
            TransportMemory::new(
                device,
                stage,
                Inputs { buffers: &self.buffers, sites },
                demand,
                lists,
                layout,
            )
        });
        if changed {
            memory.write(queue, layout, demand.theta);
        }
        let eye = frame.view.as_ref().map(|view| view.camera.in_mm(self.mm_per_unit).1);
        let seen = gathers && eye.is_some();
        let elsewhere = eye.is_some_and(|eye| seen && memory.look(queue, eye));
        let looked = elsewhere || seen != solver.steps.seen;
        // What lies under the surface is looked at for an eye alone.
        let is_new = changed || seen && !solver.steps.seen;
        let solves = is_new || solver.unsettled > 0;
        solver.unsettled = if is_new { SETTLING } else { solver.unsettled.saturating_sub(1) };
        solver.steps = Steps {
            tries: if solves { TransportStage::tries(solver.is_first) } else { solver.steps.tries },
            since: match solver.steps.since {
                _ if solver.is_first => Since::Ever,
                _ if is_new => Since::Moved,
                Since::Moved => Since::Rested,
                _ => Since::Stood,
            },
            seen,
        };
        if solves || looked {
            self.pending.insert(StageSet::from_stage_on(Stage::Scatter));
        }
    }
}

/// Whether the solver can run so.
pub(super) fn check_transport(
    texels: u32,
    transport: Transport,
    method: Method,
    evaluate: Evaluate,
    limits: &wgpu::Limits,
) -> Result<(), Error> {
    if matches!(transport, Transport::Classic | Transport::Auto) {
        return Ok(());
    }
    let at_texels = matches!(evaluate, Evaluate::PerTexel | Evaluate::Auto);
    if !at_texels || !matches!(method.resolved(), Method::Dual { .. }) {
        return Err(Error::Frame {
            problem: format!("{transport:?} by {method:?}, evaluated {evaluate:?}"),
            remedy: "use the dual scatter, evaluated per texel",
        });
    }
    // Sites are texels at worst.
    stage::check(&Sites::new(texels, transport::COARSEST_LEVEL), limits)
}
