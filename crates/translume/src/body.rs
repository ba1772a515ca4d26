//! A body: one mesh that light goes through.

mod encode;
mod evaluation;
mod kernel;
mod memory;
mod settings;
mod solver;

use self::kernel::{check_kernel, check_method};
use self::solver::{Solver, check_transport};
use crate::boundary::Boundary;
use crate::bounds::PoseBounds;
use crate::buffers::{Buffers, Extent};
use crate::descriptor::BodyDescriptor;
use crate::evaluate::{Evaluate, Shape};
use crate::frame::{self, Casters, Frame, Lighting};
use crate::gpu::{self, MediumKind};
use crate::host_vertices::HostNumbers;
use crate::kernel_table::KernelTableLayout;
use crate::kernel_texture::KernelTexture;
use crate::layout::{MAX_VIEWS, NeedLayout};
use crate::lighting::{self, GatherBody};
use crate::memory::{Account, Ledger};
use crate::pose::Pose;
use crate::shadow_view::{Subject, View};
use crate::stages::cluster::Tree;
use crate::stages::deform::DeformGroups;
use crate::stages::gather::Kinds;
use crate::stages::scatter::Method;
use crate::stages::scatter::dual::DualMemory;
use crate::stages::scatter::pattern::{PatternMemory, Plan};
use crate::stages::shadow::{DepthLayers, DepthMaps};
use crate::stages::visibility::SkyMemory;
use crate::stages::{Stage, StageSet, Stages};
use crate::standing::Standing;
use crate::timings::Timer;
use crate::{Error, Light, Medium, Profile, ShadowOptions, Transport};
use glam::{Mat4, Vec3};
use std::sync::Arc;

/// A mesh that light goes through: its buffers, and which stages its next frame needs.
///
/// Each frame: [`prepare`](Self::prepare) takes the inputs, [`encode`](Self::encode) records the stages whose inputs changed.
///
/// ```no_run
/// # fn example(device: &translume::wgpu::Device, queue: &translume::wgpu::Queue, body: &mut translume::Body) -> Result<(), translume::Error> {
/// use translume::{Deformation, Frame, Light, Lighting, Medium, PointLight};
///
/// body.set_medium(Medium::JADE)?;
/// let lamp = Light::Point(PointLight { position: [0.0, 0.2, -0.3], intensity: [0.3; 3], ..Default::default() });
/// for frame in 0..100 {
///     let weight = frame as f32 / 100.0;
///     body.prepare(device, queue, &Frame {
///         deformation: Deformation::Morph(&[weight]),
///         lighting: Lighting::Lights(&[lamp]),
///         ..Default::default()
///     })?;
///     let mut encoder = device.create_command_encoder(&Default::default());
///     body.encode(&mut encoder);
///     queue.submit([encoder.finish()]);
/// }
/// # Ok(()) }
/// ```
pub struct Body {
    stages: Arc<Stages>,
    pub(crate) buffers: Buffers,
    pub(crate) extent: Extent,
    pub(crate) flat_normals: bool,
    pub(crate) mm_per_unit: f32,
    tree: Tree,
    bounds: PoseBounds,
    kernel: KernelTexture,
    table: KernelTableLayout,
    shadows: ShadowOptions,
    /// The narrowest limit of the device that shadows run into.
    limits: wgpu::Limits,

    medium: Medium,
    profile: Profile,
    method: Method,
    list_entries: u32,
    /// Made for the first frame whose method needs it.
    dual: Option<DualMemory>,
    shape: Shape,
    evaluate: Evaluate,
    /// Where the last frame evaluated.
    evaluated: Evaluate,
    need: NeedLayout,
    /// Below which length the profile is smooth in every channel, mm.
    smooth_length: f32,
    pub(crate) kind: MediumKind,
    /// Which texels have a vertex, among marks of a medium without variation.
    marks: Vec<u32>,
    /// Of [`Variation::scale`].
    greatest_scale: f32,
    plan: Plan,
    pattern: Option<PatternMemory>,
    solver: Solver,
    model: Mat4,
    /// [`Profile::exit_scale`] of profile and medium: an integral too long for every picture.
    pub(crate) exit_scale: f32,
    boundary: Boundary,
    pose: Pose,
    /// Where the next frame's pose is made, so that a refused one leaves no trace and none allocates.
    next_pose: Pose,
    host: HostNumbers,
    lights: Vec<Light>,
    kinds: Kinds,
    casters: Option<Casters>,
    /// Irradiance that the host supplies in place of lights.
    host_irradiance: Option<wgpu::Buffer>,
    /// Views of the lights, and which light each belongs to.
    views: Vec<View>,
    owners: Vec<usize>,
    sky: SkyMemory,
    shares_scratch: bool,
    account: Account,
    pending: StageSet,
    /// Whether the kernel table no longer fits medium and profile.
    scatter_stale: bool,
    /// Whether the scatter uniforms no longer fit the method.
    method_stale: bool,
    /// Whether light now enters the surface differently.
    surface_stale: bool,
    shadows_stale: bool,
    never_prepared: bool,
    is_timed: bool,
    /// Made by the first frame that is timed.
    timer: Option<Timer>,

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
        ledger: &Arc<Ledger>,
        descriptor: &BodyDescriptor<'_>,
    ) -> Result<Self, Error> {
        let BodyDescriptor { mesh, atlas, medium, ref profile, method, mm_per_unit, .. } = *descriptor;
        descriptor.validate(device.limits().max_texture_dimension_2d)?;
        let extent = Extent::new(mesh, atlas);
        extent.check(&device.limits())?;

        let tree = Tree::new(extent.texels);
        check_method(&tree, method, descriptor.evaluate, &device.limits())?;
        check_transport(tree.counts[0], descriptor.transport, method, descriptor.evaluate, &device.limits())?;
        check_kernel(profile, method, descriptor.evaluate)?;
        let standing = Standing::new(mesh, atlas);
        let buffers = Buffers::new(device, mesh, atlas, &tree, &standing);
        let exitance = stages.resolve.texture(device, atlas.size);
        let exitance_view = exitance.create_view(&wgpu::TextureViewDescriptor::default());
        let kernel = KernelTexture::new(device, mesh, atlas);
        let shadows = descriptor.shadows;
        let layers = if descriptor.shares_scratch {
            Arc::clone(&stages.scratch.blank)
        } else {
            Arc::new(DepthLayers::new(device, shadows.resolution, 1))
        };
        let depth_maps = stages.shadow.depth_maps(device, layers, MAX_VIEWS as u64);
        let mut body = Self {
            deform_groups: stages.deform.bind(device, &buffers),
            gather_group: stages.gather.bind(device, &buffers, &depth_maps, None),
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
            table: KernelTableLayout::default(),
            shadows,
            limits: device.limits(),
            medium,
            profile: profile.clone(),
            method,
            list_entries: descriptor.list_entries,
            dual: None,
            shape: Shape::new(mesh, atlas),
            evaluate: descriptor.evaluate,
            evaluated: Evaluate::PerTexel,
            need: NeedLayout::default(),
            smooth_length: 0.0,
            kind: MediumKind::default(),
            marks: standing.marks,
            greatest_scale: 1.0,
            plan: Plan::new(atlas, mm_per_unit),
            pattern: None,
            solver: Solver::new(descriptor.transport),
            model: Mat4::IDENTITY,
            exit_scale: 1.0,
            boundary: Boundary::new(profile, &medium, Transport::Classic),
            pose: Pose::rest(&extent),
            next_pose: Pose::rest(&extent),
            host: HostNumbers::new(descriptor.host_vertices, extent.vertices),
            lights: Vec::new(),
            kinds: Kinds::default(),
            casters: None,
            host_irradiance: None,
            views: Vec::new(),
            owners: Vec::new(),
            sky: SkyMemory::new(&shadows),
            shares_scratch: descriptor.shares_scratch,
            account: Account::new(ledger),
            pending: StageSet::default(),
            scatter_stale: true,
            method_stale: true,
            surface_stale: true,
            shadows_stale: false,
            never_prepared: true,
            is_timed: false,
            timer: None,
            exitance,
            exitance_view,
            depth_maps,
        };
        body.renew_surface();
        body.account.check(body.memory().total())?;
        body.note_memory();
        Ok(body)
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
        let before = self.solver.runs;
        self.use_transport(self.transport_for(model));
        let taken = self.take_over(device, queue, frame, model);
        if taken.is_err() {
            self.use_transport(before);
        }
        taken
    }

    fn take_over(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        frame: &Frame<'_>,
        model: Mat4,
    ) -> Result<(), Error> {
        self.next_pose.set(frame.deformation, frame.warp)?;
        if let Some(adopted) = &self.next_pose.adopted {
            self.host.check(adopted, &self.limits)?;
        }
        let (lights, host_irradiance): (&[Light], _) = match frame.lighting {
            Lighting::Lights(lights) => (lights, None),
            Lighting::Irradiance(buffer) => (&[], Some(buffer)),
        };
        frame::validate_lights(lights)?;
        frame.view.map_or(Ok(()), |view| view.validate())?;
        if let Some(buffer) = host_irradiance {
            frame::validate_irradiance(buffer, self.extent.texels)?;
        }
        let casters = frame.casters.map(|c| frame::caster_corners(&c, self.mm_per_unit)).transpose()?;
        let has_sky = lighting::has_shadowed_sky(lights, &self.shadows);
        if has_sky {
            self.check_sky()?;
        }

        let moved = self.never_prepared || model != self.model || self.next_pose != self.pose;
        let shaded = moved || frame.casters != self.casters || self.shadows_stale;
        let relit =
            shaded || lights != self.lights || self.host_irradiance.is_some() && host_irradiance.is_none();
        let to_mm = Mat4::from_scale(Vec3::splat(self.mm_per_unit)) * model;
        let winding = to_mm.determinant().signum();
        let corners =
            self.bounds.posed(&self.next_pose).corners().map(|corner| to_mm.transform_point3(corner));
        frame::validate_corners(&corners)?;
        let subject = Subject { corners: &corners, casters: casters.as_ref() };
        let gathering = if relit || self.surface_stale {
            let body = GatherBody {
                texels: self.extent.texels,
                flat_normals: self.flat_normals,
                boundary: self.boundary,
                winding,
                mm_per_unit: self.mm_per_unit,
                subject: &subject,
                shadows: &self.shadows,
                directions: &self.sky.directions,
            };
            Some(lighting::gather(lights, &body)?)
        } else {
            None
        };
        let layers = gathering.as_ref().map_or(0, |gathering| gathering.layers);
        self.check_growth(layers, has_sky, self.choose(frame.view.as_ref(), &corners))?;
        if let Some(gathering) = gathering {
            self.make_room_for_views(device, gathering.layers);
            self.depth_maps.write_views(queue, &gathering.views);
            queue.write_buffer(&self.buffers.gather_uniform, 0, bytemuck::bytes_of(&*gathering.layout));
            (self.views, self.owners) = (gathering.views, gathering.owners);
            let first = if relit { Stage::Shadow } else { Stage::Gather };
            self.pending.insert(StageSet::from_stage_on(first));
        }
        if moved {
            std::mem::swap(&mut self.pose, &mut self.next_pose);
            self.upload_pose(device, queue, to_mm);
            self.pending.insert(StageSet::from_stage_on(Stage::Deform));
        }
        if shaded {
            self.sky.forget(has_sky);
        }
        let renews_sky = has_sky && self.prepare_sky(device, queue, &subject);
        self.pending.set(Stage::Visibility, renews_sky);
        if renews_sky {
            self.pending.insert(StageSet::from_stage_on(Stage::Gather));
        }
        if host_irradiance.is_some() {
            self.pending.insert(StageSet::from_stage_on(Stage::Cluster));
        }
        self.host_irradiance = host_irradiance.cloned();
        self.casters = frame.casters;
        self.kinds = lighting::kinds(lights, &self.shadows);
        self.model = model;
        self.lights.clear();
        self.lights.extend_from_slice(lights);
        self.never_prepared = false;
        self.surface_stale = false;
        self.shadows_stale = false;
        if self.solver.runs == Transport::Classic {
            self.refresh_table(queue, frame::diagonal(&corners));
        }
        self.place_evaluation(queue, frame, &corners);
        self.refresh_method(device, queue);
        self.refresh_solver(device, queue, frame);
        self.note_memory();
        self.draw_shared_depth();
        if self.is_timed {
            self.timer.get_or_insert_with(|| Timer::new(device, queue)).next_frame();
        }
        Ok(())
    }

    /// The stages that the next [`encode`](Self::encode) records.
    #[must_use]
    pub fn pending(&self) -> StageSet {
        self.pending
    }

    fn upload_pose(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, to_mm: Mat4) {
        let uniform = self.pose.layout(&self.extent, self.bounds.axis(), to_mm);
        queue.write_buffer(&self.buffers.deform_uniform, 0, bytemuck::bytes_of(&uniform));
        queue.write_buffer(&self.buffers.weights, 0, bytemuck::cast_slice(&self.pose.weights));
        queue.write_buffer(&self.buffers.joints, 0, bytemuck::cast_slice(&self.pose.joints));
        if let Some(adopted) = &self.pose.adopted {
            let stage = (&self.stages.deform, &self.buffers);
            self.host.prepare((device, queue), stage, adopted, &self.limits);
        }
    }

    fn bind_gather(&mut self, device: &wgpu::Device) {
        self.gather_group =
            self.stages.gather.bind(device, &self.buffers, &self.depth_maps, self.sky.visible());
    }

    /// Whether the device can remember what every texel sees of the sky.
    fn check_sky(&self) -> Result<(), Error> {
        let required = SkyMemory::size(&self.shadows, self.extent.texels);
        let actual = gpu::binding_limit(&self.limits);
        if required <= actual {
            return Ok(());
        }
        Err(Error::Limit {
            what: format!("the sky in {} directions", self.shadows.directions),
            limit: "max_storage_buffer_binding_size",
            required,
            actual,
            remedy: "take fewer directions or a smaller atlas, or create the device with higher limits",
        })
    }

    /// Says whether the next frame looks at the sky.
    fn prepare_sky(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, subject: &Subject<'_>) -> bool {
        let stages = Arc::clone(&self.stages);
        let depth = self.depth_layers(device, self.sky.depth(), SkyMemory::width(&self.shadows), 1);
        if self.sky.depth().is_some() {
            self.sky.take_turns(device, &stages.visibility, &self.buffers, depth);
        } else {
            let options = (&self.shadows, self.extent.texels);
            self.sky.allocate(device, (&stages.visibility, &stages.shadow), &self.buffers, options, depth);
            self.bind_gather(device);
        }
        self.sky.prepare(queue, subject, &self.shadows)
    }
}
