//! Where a frame's exitance is evaluated, and which texels it needs.

use super::Body;
use crate::Frame;
use crate::bounds::Bounds;
use crate::evaluate::{Candidates, Evaluate, View};
use crate::layout::NeedLayout;
use crate::stages::scatter::points::PointMemory;
use crate::stages::{Stage, StageSet};
use glam::{Mat4, Vec3};

/// As in `cluster.wgsl`.
const IN_VIEW: u32 = 1;
const FACING: u32 = 2;
const UNDER_VERTICES: u32 = 4;
const POINTS: u32 = 8;

impl Body {
    /// `corners` of the box around the body, mm.
    pub(super) fn place_evaluation(&mut self, queue: &wgpu::Queue, frame: &Frame<'_>, corners: &[Vec3; 8]) {
        let evaluate = self.choose(frame.view.as_ref(), corners);
        self.method_stale |= evaluate != self.evaluated;
        self.evaluated = evaluate;
        let need = self.need(frame.view.as_ref(), corners);
        if need != self.need {
            queue.write_buffer(&self.buffers.need, 0, bytemuck::bytes_of(&need));
            self.pending.insert(StageSet::from_stage_on(Stage::Cluster));
            self.need = need;
        }
    }

    pub(super) fn choose(&self, view: Option<&View>, corners: &[Vec3; 8]) -> Evaluate {
        if self.dual_theta().is_none() || self.profile.is_oriented() {
            return Evaluate::PerTexel;
        }
        if self.evaluate != Evaluate::Auto {
            return self.evaluate;
        }
        let scale = self.scale();
        Candidates {
            texels: self.extent.texels,
            vertices: self.extent.vertices,
            edge: scale * self.shape.edge,
            texel: scale * self.shape.texel,
            path: self.smooth_length / self.greatest_scale,
            last: self.evaluated,
            view,
            corners: corners.map(|corner| corner / self.mm_per_unit),
        }
        .choose()
    }

    /// Millimetres that a unit of the mesh is at most.
    pub(super) fn scale(&self) -> f32 {
        self.scale_of(self.model)
    }

    /// The same of a model matrix.
    pub(super) fn scale_of(&self, model: Mat4) -> f32 {
        let [x, y, z] = [model.x_axis, model.y_axis, model.z_axis].map(|axis| axis.truncate().length());
        self.mm_per_unit * x.max(y).max(z)
    }

    fn need(&self, view: Option<&View>, corners: &[Vec3; 8]) -> NeedLayout {
        if self.evaluated == Evaluate::PerVertex {
            return NeedLayout { kind: UNDER_VERTICES | POINTS, ..NeedLayout::default() };
        }
        let points = if self.evaluated == Evaluate::PerFragment { POINTS } else { 0 };
        let Some(View { camera, .. }) = view.filter(|_| self.dual_theta().is_some()) else {
            return NeedLayout { kind: points, ..NeedLayout::default() };
        };
        let (view_projection, eye) = camera.in_mm(self.mm_per_unit);
        // From inside of it a closed body is seen from behind.
        let is_outside = !Bounds::around(corners.iter().copied()).contains(eye.into());
        let facing = if self.shape.closed && is_outside { FACING } else { 0 };
        NeedLayout { view_projection, eye, kind: points | IN_VIEW | facing }
    }

    /// What a picture of the frame needs of exitance at points.
    pub(crate) fn points(&self) -> Option<&PointMemory> {
        self.dual.as_ref().filter(|_| self.dual_theta().is_some()).and_then(|memory| memory.points.as_ref())
    }
}
