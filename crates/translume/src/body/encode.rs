//! Recording the stages of a frame.

use super::Body;
use crate::gpu::Pass;
use crate::stages::Stage;
use crate::stages::shadow::ShadowView;
use crate::{Method, Work};
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

    /// Records those of the pending stages that come before or are `last`; the others stay pending.
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

    fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        last: Stage,
        casters: &mut dyn FnMut(&mut wgpu::RenderPass<'_>, usize),
    ) -> Work {
        let pending = self.pending.take_through(last);
        let (mut work, stages) = (Work::default(), &self.stages);
        let (texels, indices) = (self.extent.texels, self.extent.triangles * 3);
        if pending.contains(Stage::Deform) {
            stages.deform.encode(
                &mut Pass::begin(encoder, "deform", &mut work),
                &self.deform_groups,
                self.extent.vertices,
                self.extent.influences_per_vertex > 0,
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
                (&mut work, casters),
            );
        }
        if pending.contains(Stage::Shadow) {
            let mut casters = |pass: &mut wgpu::RenderPass<'_>, slot| casters(pass, first_view + slot);
            let views = (0, self.views.as_slice());
            stages.shadow.encode(encoder, &self.depth_maps, views, &self.buffers, indices, &mut casters);
            work.draws += self.views.len() as u32;
        }
        if pending.contains(Stage::Gather) {
            stages.gather.encode(
                &mut Pass::begin(encoder, "gather", &mut work),
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
            stages.cluster.encode(
                &mut Pass::begin(encoder, "cluster", &mut work),
                &self.cluster_group,
                &self.tree,
            );
        }
        if pending.contains(Stage::Scatter) {
            let mut pass = Pass::begin(encoder, "scatter", &mut work);
            match (&self.dual, &self.pattern, self.method) {
                (Some(memory), _, Method::Dual { .. }) => {
                    stages.scatter.dual.encode(&mut pass, memory, &self.tree);
                }
                (_, Some(memory), Method::Pattern) => memory.encode(&mut pass, texels),
                _ => stages.scatter.encode(&mut pass, &self.scatter_group, self.method, texels),
            }
        }
        if pending.contains(Stage::Resolve) {
            stages.resolve.encode(
                &mut Pass::begin(encoder, "resolve", &mut work),
                &self.resolve_group,
                self.extent.atlas_size,
            );
        }
        work
    }
}
