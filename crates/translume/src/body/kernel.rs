//! What the scatter of a body is made of: kernel table, uniforms, memory.

use super::Body;
use crate::evaluate::Evaluate;
use crate::profile::{Profile, smooth_length};
use crate::stages::cluster::Tree;
use crate::stages::scatter::dual::{self, Demand, DualMemory, ListSizes, Lists};
use crate::stages::scatter::pattern::{Pattern, PatternMemory};
use crate::stages::scatter::{Method, Scatter};
use crate::stages::{Stage, StageSet};
use crate::{Error, Transport};
use std::sync::Arc;

impl Body {
    /// Makes the kernel table anew where medium or profile changed or the body outgrew it.
    pub(super) fn refresh_table(&mut self, queue: &wgpu::Queue, diagonal: f32) {
        if !self.scatter_stale && self.kernel.fits(diagonal) {
            return;
        }
        let (channels, known) = (self.profile.channels(&self.medium), &self.stages.kernel_tables);
        self.table = self.kernel.write(queue, known, (&self.profile, &self.medium, &channels), diagonal);
        self.kind.monochrome = channels[1..].iter().all(|channel| Arc::ptr_eq(channel, &channels[0]));
        self.kind.oriented = self.profile.is_oriented();
        self.smooth_length = smooth_length(&channels);
        self.scatter_stale = false;
        self.method_stale = true;
    }

    /// Makes anew what depends on the method, or on the table.
    pub(super) fn refresh_method(&mut self, device: &wgpu::Device, queue: &wgpu::Queue) {
        self.method_stale |= self.scratch_grew(device);
        if !self.method_stale {
            return;
        }
        let smooth_length = self.smooth_length / self.greatest_scale;
        let terms = self.profile.terms(&self.medium);
        let layout = Scatter::layout(self.table, smooth_length, terms, &self.tree, self.method);
        if let Some(theta) = self.dual_theta() {
            let (stage, tree) = (&self.stages.scatter.dual, &self.tree);
            let demand = Demand { list_entries: self.list_entries, theta, evaluate: self.evaluated };
            let sizes = ListSizes::new(tree, demand, &self.limits);
            let shared = self.shares_lists(demand.evaluate).then(|| self.stages.scratch.lists(device, sizes));
            let is_here =
                |lists: &Arc<Lists>| shared.as_ref().is_none_or(|shared| Arc::ptr_eq(shared, lists));
            let serves = |m: &mut DualMemory| m.serves(demand, tree, &self.limits) && is_here(&m.lists);
            self.dual = self.dual.take_if(serves);
            let memory = self.dual.get_or_insert_with(|| {
                let lists = shared.unwrap_or_else(|| Arc::new(Lists::new(device, sizes)));
                stage.memory(device, (&self.buffers, &self.kernel.view), (tree, demand), lists)
            });
            memory.kind = self.kind;
            memory.write(queue, &layout, tree, theta);
            stage.compile(memory);
        } else {
            self.dual = None;
            self.stages.scatter.compile(self.method, self.kind);
        }
        if self.method == Method::Pattern {
            let (buffers, view, plan) = (&self.buffers, &self.kernel.view, &self.plan);
            let stage = self.stages.scatter.pattern.get_or_init(|| Pattern::new(device));
            let memory =
                self.pattern.get_or_insert_with(|| PatternMemory::new(device, stage, buffers, view, plan));
            memory.write(queue, plan, self.table, &self.medium);
        }
        let uniforms = Scatter::uniforms(layout);
        queue.write_buffer(&self.buffers.scatter_uniforms, 0, &uniforms);
        self.pending.insert(StageSet::from_stage_on(Stage::Scatter));
        self.method_stale = false;
    }

    /// Opening angle of the dual scatter, where that is the method.
    pub(super) fn dual_theta(&self) -> Option<f32> {
        let narrowing = match self.method {
            Method::Within { .. } if self.profile.is_oriented() => FLUX_NARROWING,
            _ => 1.0,
        };
        match self.method.resolved() {
            Method::Dual { theta } if self.solver.runs == Transport::Classic => Some(narrowing * theta),
            _ => None,
        }
    }
}

/// The gradient of a second-order expansion is of first order: the same tolerance takes a narrower angle. Measured: 1.1 to 3.7 % at 0.65
/// become 0.3 to 0.9 %.
const FLUX_NARROWING: f32 = 0.65;

/// Whether exitance can be evaluated there, and the device can hold what the method remembers.
pub(super) fn check_method(
    tree: &Tree,
    method: Method,
    evaluate: Evaluate,
    limits: &wgpu::Limits,
) -> Result<(), Error> {
    if matches!(method.resolved(), Method::Dual { .. }) {
        return dual::check(tree, evaluate, limits);
    }
    match evaluate {
        Evaluate::PerTexel | Evaluate::Auto => Ok(()),
        Evaluate::PerVertex | Evaluate::PerFragment => Err(Error::Frame {
            problem: format!("{method:?} evaluated {evaluate:?}"),
            remedy: "use the dual scatter, or evaluate per texel",
        }),
    }
}

/// Sources off the surface are seen from texels alone, and not by the pattern.
pub(super) fn check_kernel(profile: &Profile, method: Method, evaluate: Evaluate) -> Result<(), Error> {
    if !profile.is_oriented() {
        return Ok(());
    }
    let at_points = matches!(evaluate, Evaluate::PerVertex | Evaluate::PerFragment);
    if method == Method::Pattern || at_points {
        let problem = format!("sources off the surface, {method:?}, evaluated {evaluate:?}");
        let remedy = "evaluate per texel by any other method, or take a radial profile";
        return Err(Error::Frame { problem, remedy });
    }
    Ok(())
}
