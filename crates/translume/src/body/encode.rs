//! Recording the stages of a frame.

use super::Body;
use crate::gpu::Pass;
use crate::stages::Stage;
use crate::stages::deform::Source;
use crate::stages::shadow::ShadowView;
use crate::timings::{FrameTimings, Recording};
use crate::{Method, Transport, Work};
use glam::{Mat4, Vec3};

impl Body {
    /// The views of depth maps that the next [`encode`](Self::encode) draws, for a host that adds casters to them.
    pub fn shadow_views(&self) -> impl Iterator<Item = ShadowView> {
        let to_mm = Mat4::from_scale(Vec3::splat(self.mm_per_unit));
        let sky = if self.pending.contains(Stage::Visibility) { self.sky.views.as_slice() } else { &[] };
        let lights = if self.pending.contains(Stage::Shadow) { self.views.as_slice() } else { &[] };
        let sky = sky.iter().map(|view| (view, None));
        let lights = lights.iter().zip(&self.owners).map(|(view, light)| (view, Some(*light)));
        sky.chain(lights).enumerate().map(move |(index, (view, light))| ShadowView {
            view_projection: (view.matrix * to_mm).to_cols_array_2d(),
            index,
            light,
        })
    }

    /// Records the stages whose inputs changed since the last call. Never submits, blocks or allocates.
    pub fn encode(&mut self, encoder: &mut wgpu::CommandEncoder) -> Work {
        self.record(encoder, Stage::Resolve, &mut |_, _| ())
    }

    /// Records those of the pending stages that come before or are `last`; the others stay pending. A body that shares scratch memory never
    /// stops between shadow and gather.
    pub fn encode_through(&mut self, encoder: &mut wgpu::CommandEncoder, last: Stage) -> Work {
        self.record(encoder, last, &mut |_, _| ())
    }

    /// As [`encode`](Self::encode), and lets the host draw its casters into every depth map: `casters` gets the pass, whose viewport is the
    /// map's, and the [`ShadowView::index`]. The pass has a `Depth32Float` attachment of one sample and no colour; nearer is greater. Say in
    /// [`Frame::casters`](crate::Frame::casters) where they are.
    pub fn encode_with(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        mut casters: impl FnMut(&mut wgpu::RenderPass<'_>, usize),
    ) -> Work {
        self.record(encoder, Stage::Resolve, &mut casters)
    }

    /// Turns timings on or off; off by default. Takes effect at the next [`prepare`](Self::prepare).
    ///
    /// Each stage is timed where the device has [`wgpu::Features::TIMESTAMP_QUERY`], else the frame as a whole by the wall clock
    /// ([`Clock`](crate::Clock)).
    pub fn set_timings(&mut self, on: bool) {
        self.is_timed = on;
        if !on {
            self.timer = None;
        }
    }

    /// How long the newest frame took of those that have ended; never blocks. `None` before the first, and while timings are off.
    ///
    /// Times arrive while the host polls the device or submits, some frames late. A frame that records nothing has none, so that this
    /// stays what it was: see [`FrameTimings::frame`]. Nor has a frame while four before it are in flight or in encoders that were not
    /// submitted, nor where the driver returns no timestamps although it has the feature.
    #[must_use]
    pub fn timings(&self) -> Option<FrameTimings> {
        self.timer.as_ref()?.newest()
    }

    fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        last: Stage,
        casters: &mut dyn FnMut(&mut wgpu::RenderPass<'_>, usize),
    ) -> Work {
        // Other bodies may draw into shared depth maps before those of this one are read.
        let last = if self.shares_scratch && last == Stage::Shadow { Stage::Gather } else { last };
        let pending = self.pending.take_through(last);
        let at_points = self.points().is_some();
        let (mut recording, stages) = (Recording::begin(self.timer.as_mut()), &self.stages);
        let (texels, indices) = (self.extent.texels, self.extent.triangles * 3);
        if pending.contains(Stage::Deform) {
            let source = match self.host.group().filter(|_| self.pose.adopted.is_some()) {
                Some(group) => Source::Host(group),
                None if self.extent.influences_per_vertex > 0 => Source::Skin,
                None => Source::Rest,
            };
            stages.deform.encode(
                &mut Pass::begin(encoder, Stage::Deform, &mut recording),
                &self.deform_groups,
                (self.extent.vertices, self.extent.corners),
                &source,
                self.pose.deforms(),
            );
        }
        let mut first_view = 0;
        if pending.contains(Stage::Visibility) {
            first_view = self.sky.views.len();
            let (sky, extent) = (&mut self.sky, (texels, indices));
            stages.visibility.encode(
                encoder,
                &stages.shadow,
                sky,
                &self.buffers,
                extent,
                (&mut recording, casters),
            );
        }
        if pending.contains(Stage::Shadow) {
            let mut casters = |pass: &mut wgpu::RenderPass<'_>, slot| casters(pass, first_view + slot);
            let (maps, views) = (&self.depth_maps, (0, self.views.as_slice()));
            let (recording, body) = ((Stage::Shadow, &mut recording), (&self.buffers, indices));
            stages.shadow.encode(encoder, recording, maps, views, body, &mut casters);
        }
        if pending.contains(Stage::Gather) {
            stages.gather.encode(
                &mut Pass::begin(encoder, Stage::Gather, &mut recording),
                &self.gather_group,
                self.kinds,
                texels,
            );
        }
        if pending.contains(Stage::Cluster) {
            if let Some(irradiance) = &self.host_irradiance {
                let size = 16 * u64::from(texels);
                encoder.copy_buffer_to_buffer(irradiance, 0, &self.buffers.irradiance, 0, size);
            }
            if self.solver.runs == Transport::Classic {
                stages.cluster.encode(
                    &mut Pass::begin(encoder, Stage::Cluster, &mut recording),
                    &self.cluster_group,
                    &self.tree,
                );
            }
        }
        let solver = if pending.contains(Stage::Scatter) { self.solver.take() } else { None };
        if let Some(solver) = solver {
            solver.encode(encoder, stages, &mut recording);
        } else if pending.contains(Stage::Scatter) {
            let mut pass = Pass::begin(encoder, Stage::Scatter, &mut recording);
            let pattern = self.pattern.as_ref().zip(stages.scatter.pattern.get());
            match (&self.dual, pattern, self.method.resolved()) {
                (Some(memory), _, Method::Dual { .. }) => {
                    stages.scatter.dual.encode(&mut pass, memory, &self.tree, self.extent.vertices);
                }
                (_, Some((memory, stage)), Method::Pattern) => stage.encode(&mut pass, memory, texels),
                _ => stages.scatter.encode(&mut pass, &self.scatter_group, (self.method, self.kind), texels),
            }
        }
        if pending.contains(Stage::Resolve) && !at_points {
            stages.resolve.encode(
                &mut Pass::begin(encoder, Stage::Resolve, &mut recording),
                &self.resolve_group,
                self.extent.atlas_size,
            );
        }
        recording.end(encoder)
    }
}
