//! A body: one mesh that light goes through.

use crate::bounds::PoseBounds;
use crate::buffers::{Buffers, Extent, Outputs};
use crate::descriptor::BodyDescriptor;
use crate::frame::{self, Frame, GatherBody, Lighting};
use crate::kernel_texture::KernelTexture;
use crate::pose::Pose;
use crate::profile::Dipole;
use crate::stages::cluster::Tree;
use crate::stages::deform::DeformGroups;
use crate::stages::scatter::{Method, Scatter};
use crate::stages::shadow::DepthMaps;
use crate::stages::{Stage, StageSet, Stages};
use crate::{Error, Light, Medium, Profile};
use glam::{Mat4, Vec3};
use std::sync::Arc;

/// A mesh that light goes through: its buffers, and which stages its next frame needs.
///
/// Each frame: [`prepare`](Self::prepare) takes the inputs, [`encode`](Self::encode) records the stages whose inputs changed.
pub struct Body {
    stages: Arc<Stages>,
    pub(crate) buffers: Buffers,
    pub(crate) extent: Extent,
    pub(crate) flat_normals: bool,
    pub(crate) mm_per_unit: f32,
    tree: Tree,
    bounds: PoseBounds,
    kernel: KernelTexture,
    shadow_resolution: u32,

    medium: Medium,
    profile: Profile,
    method: Method,
    model: Mat4,
    /// [`Profile::exit_scale`] of profile and medium: an integral too long for every picture.
    pub(crate) exit_scale: f32,
    pose: Pose,
    /// Where the next frame's pose is made, so that a refused one leaves no trace and none allocates.
    next_pose: Pose,
    lights: Vec<Light>,
    view_count: u32,
    pending: StageSet,
    /// Whether the kernel table no longer fits the medium, or the scatter uniforms the method.
    scatter_stale: bool,
    /// Whether light now enters the surface differently.
    surface_stale: bool,
    never_prepared: bool,

    exitance: wgpu::Texture,
    exitance_view: wgpu::TextureView,
    pub(crate) depth_maps: DepthMaps,
    deform_groups: DeformGroups,
    gather_group: wgpu::BindGroup,
    cluster_group: wgpu::BindGroup,
    scatter_group: wgpu::BindGroup,
    resolve_group: wgpu::BindGroup,
}

impl Body {
    pub(crate) fn new(
        device: &wgpu::Device,
        stages: Arc<Stages>,
        descriptor: &BodyDescriptor<'_>,
    ) -> Result<Self, Error> {
        let BodyDescriptor { mesh, atlas, medium, profile, method, mm_per_unit, .. } = *descriptor;
        descriptor.validate(device.limits().max_texture_dimension_2d)?;
        let extent = Extent::new(mesh, atlas);
        extent.check(&device.limits())?;

        let tree = Tree::new(extent.texels);
        let buffers = Buffers::new(device, mesh, atlas, &tree);
        let exitance = stages.resolve.texture(device, atlas.size);
        let exitance_view = exitance.create_view(&wgpu::TextureViewDescriptor::default());
        let kernel = KernelTexture::new(device, mesh, atlas);
        let depth_maps = stages.shadow.depth_maps(device, descriptor.shadow_resolution, 1);
        Ok(Self {
            deform_groups: stages.deform.bind(device, &buffers),
            gather_group: stages.gather.bind(device, &buffers, &depth_maps),
            cluster_group: stages.cluster.bind(device, &buffers),
            scatter_group: stages.scatter.bind(device, &buffers, &kernel.view),
            resolve_group: stages.resolve.bind(device, &buffers.exitance, &buffers.pixels, &exitance_view),
            stages,
            buffers,
            extent,
            flat_normals: descriptor.flat_normals,
            mm_per_unit,
            tree,
            bounds: PoseBounds::new(mesh),
            kernel,
            shadow_resolution: descriptor.shadow_resolution,
            medium,
            profile,
            method,
            model: Mat4::IDENTITY,
            exit_scale: profile.exit_scale(medium.ior),
            pose: Pose::rest(&extent),
            next_pose: Pose::rest(&extent),
            lights: Vec::new(),
            view_count: 0,
            pending: StageSet::default(),
            scatter_stale: true,
            surface_stale: true,
            never_prepared: true,
            exitance,
            exitance_view,
            depth_maps,
        })
    }

    /// Takes over the inputs of the next frame and uploads what changed. Finds out which stages the frame needs.
    ///
    /// # Errors
    /// [`Error::Frame`] names the light, weight, matrix or warp that cannot be; the body then keeps its last frame.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        frame: &Frame<'_>,
    ) -> Result<(), Error> {
        let model = Mat4::from_cols_array_2d(&frame.model);
        frame::validate_model(model)?;
        self.next_pose.set(frame.deformation, frame.warp)?;
        let Lighting::Lights(lights) = frame.lighting;
        frame::validate_lights(lights)?;

        let moved = self.never_prepared || model != self.model || self.next_pose != self.pose;
        let relit = moved || self.surface_stale || lights != self.lights;
        let to_mm = Mat4::from_scale(Vec3::splat(self.mm_per_unit)) * model;
        let winding = to_mm.determinant().signum();
        let corners =
            self.bounds.posed(&self.next_pose).corners().map(|corner| to_mm.transform_point3(corner));
        frame::validate_corners(&corners)?;
        if relit {
            let body = GatherBody {
                texels: self.extent.texels,
                flat_normals: self.flat_normals,
                eta: self.medium.ior,
                winding,
                mm_per_unit: self.mm_per_unit,
                corners: &corners,
                shadow_resolution: self.shadow_resolution,
            };
            let (layout, views) = frame::gather_layout(lights, &body)?;
            self.make_room_for_views(device, views.len() as u32);
            self.depth_maps.write_views(queue, &views);
            self.view_count = views.len() as u32;
            queue.write_buffer(&self.buffers.gather_uniform, 0, bytemuck::bytes_of(&*layout));
            self.pending.insert(StageSet::from_stage_on(Stage::Shadow));
        }
        if moved {
            std::mem::swap(&mut self.pose, &mut self.next_pose);
            self.upload_pose(queue, to_mm);
            self.pending.insert(StageSet::from_stage_on(Stage::Deform));
        }
        self.model = model;
        self.lights.clear();
        self.lights.extend_from_slice(lights);
        self.never_prepared = false;
        self.surface_stale = false;
        self.refresh_kernel(queue, frame::diagonal(&corners));
        Ok(())
    }

    /// The stages that the next [`encode`](Self::encode) records.
    #[must_use]
    pub fn pending(&self) -> StageSet {
        self.pending
    }

    /// Records the stages whose inputs changed since the last call. Never submits, blocks or allocates.
    pub fn encode(&mut self, encoder: &mut wgpu::CommandEncoder) {
        let pending = std::mem::take(&mut self.pending);
        let stages = &self.stages;
        if pending.contains(Stage::Deform) {
            let mut pass = begin(encoder, "deform");
            stages.deform.encode(
                &mut pass,
                &self.deform_groups,
                self.extent.vertices,
                self.extent.influences_per_vertex > 0,
                self.pose.deforms(),
            );
        }
        if pending.contains(Stage::Shadow) {
            let indices = self.extent.triangles * 3;
            stages.shadow.encode(encoder, &self.depth_maps, &self.buffers, self.view_count, indices);
        }
        if pending.contains(Stage::Gather) {
            stages.gather.encode(&mut begin(encoder, "gather"), &self.gather_group, self.extent.texels);
        }
        if pending.contains(Stage::Cluster) {
            stages.cluster.encode(&mut begin(encoder, "cluster"), &self.cluster_group, &self.tree);
        }
        if pending.contains(Stage::Scatter) {
            let mut pass = begin(encoder, "scatter");
            stages.scatter.encode(&mut pass, &self.scatter_group, self.method, self.extent.texels);
        }
        if pending.contains(Stage::Resolve) {
            stages.resolve.encode(
                &mut begin(encoder, "resolve"),
                &self.resolve_group,
                self.extent.atlas_size,
            );
        }
    }

    /// Changes the medium; the next frame scatters anew, and gathers too if the index of refraction changed.
    ///
    /// # Errors
    /// [`Error::Medium`] names the coefficient that cannot be.
    pub fn set_medium(&mut self, medium: Medium) -> Result<(), Error> {
        medium.validate()?;
        self.scatter_stale |= medium != self.medium;
        self.surface_stale |= medium.ior != self.medium.ior;
        self.medium = medium;
        self.exit_scale = self.profile.exit_scale(medium.ior);
        Ok(())
    }

    /// Changes the profile. Today's profiles differ in how light leaves towards the eye, so no stage has to run again.
    pub fn set_profile(&mut self, profile: Profile) {
        self.profile = profile;
        self.exit_scale = profile.exit_scale(self.medium.ior);
    }

    /// Changes how the scatter sum is evaluated; the next frame scatters anew.
    ///
    /// # Errors
    /// [`Error::Frame`] for an opening angle outside its range.
    pub fn set_method(&mut self, method: Method) -> Result<(), Error> {
        method.validate()?;
        self.scatter_stale |= method != self.method;
        self.method = method;
        Ok(())
    }

    /// The medium.
    #[must_use]
    pub fn medium(&self) -> &Medium {
        &self.medium
    }

    /// The profile.
    #[must_use]
    pub fn profile(&self) -> Profile {
        self.profile
    }

    /// Radiant exitance B over the atlas, `Rgba32Float`: linear RGB, alpha 1 where a texel or gutter is. Sample it with
    /// [`translume_shaders::MATERIAL`].
    #[must_use]
    pub fn exitance_view(&self) -> &wgpu::TextureView {
        &self.exitance_view
    }

    /// The texture behind [`exitance_view`](Self::exitance_view); it can be copied from.
    #[must_use]
    pub fn exitance_texture(&self) -> &wgpu::Texture {
        &self.exitance
    }

    /// What the stages wrote, for copies and read-back.
    #[must_use]
    pub fn outputs(&self) -> Outputs<'_> {
        self.buffers.outputs(&self.depth_maps)
    }

    fn upload_pose(&self, queue: &wgpu::Queue, to_mm: Mat4) {
        let uniform = self.pose.layout(&self.extent, self.bounds.axis(), to_mm);
        queue.write_buffer(&self.buffers.deform_uniform, 0, bytemuck::bytes_of(&uniform));
        queue.write_buffer(&self.buffers.weights, 0, bytemuck::cast_slice(&self.pose.weights));
        queue.write_buffer(&self.buffers.joints, 0, bytemuck::cast_slice(&self.pose.joints));
    }

    fn make_room_for_views(&mut self, device: &wgpu::Device, views: u32) {
        if views > self.depth_maps.layers() {
            self.depth_maps = self.stages.shadow.depth_maps(device, self.shadow_resolution, views);
            self.gather_group = self.stages.gather.bind(device, &self.buffers, &self.depth_maps);
        }
    }

    /// Makes the kernel table anew where the medium changed or the body outgrew it.
    fn refresh_kernel(&mut self, queue: &wgpu::Queue, diagonal: f32) {
        if !self.scatter_stale && self.kernel.fits(diagonal) {
            return;
        }
        let channels = [0, 1, 2].map(|channel| Dipole::new(&self.medium, channel));
        let table = self.kernel.write(queue, &channels, diagonal);
        let uniforms = Scatter::uniforms(Scatter::layout(table, &channels, &self.tree, self.method));
        queue.write_buffer(&self.buffers.scatter_uniforms, 0, &uniforms);
        self.pending.insert(StageSet::from_stage_on(Stage::Scatter));
        self.scatter_stale = false;
    }
}

fn begin<'a>(encoder: &'a mut wgpu::CommandEncoder, label: &str) -> wgpu::ComputePass<'a> {
    encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(label), timestamp_writes: None })
}
