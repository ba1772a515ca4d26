//! A body: one mesh that light goes through.

use crate::buffers::{self, Extent};
use crate::frame::{self, Frame, GatherBody, PoseBounds};
use crate::kernel_table::{self, KernelRange, KernelTableLayout};
use crate::layout::{DeformLayout, ScatterLayout};
use crate::profile::Dipole;
use crate::stages::cluster::Tree;
use crate::stages::scatter::{Method, Scatter};
use crate::stages::shadow::DepthMaps;
use crate::stages::{Stage, StageSet, Stages, resolve::Resolve};
use crate::{Deformation, Error, Light, Lighting, Medium, Profile};
use glam::{Mat4, Vec3};
use std::sync::Arc;
use translume_mesh::{Atlas, Mesh};

pub(crate) use crate::buffers::Buffers;

/// What a body is made of and how it is computed.
#[derive(Clone, Copy, Debug)]
pub struct BodyDescriptor<'a> {
    /// The mesh, clean (see [`translume_mesh::repair`]).
    pub mesh: &'a Mesh,
    /// Its atlas.
    pub atlas: &'a Atlas,
    /// The medium.
    pub medium: Medium,
    /// The profile.
    pub profile: Profile,
    /// How the scatter sum is evaluated.
    pub method: Method,
    /// Millimetres per world unit: 1000 for an engine that counts in metres. Finite, > 0.
    pub mm_per_unit: f32,
    /// Whether each triangle keeps its own normal instead of the smooth vertex normals.
    pub flat_normals: bool,
    /// Width of a depth map in texels, from 16 to the device's `max_texture_dimension_2d`.
    pub shadow_resolution: u32,
}

impl<'a> BodyDescriptor<'a> {
    /// Defaults for everything but the shape: marble, normalised dipole, tree, metres, smooth normals, depth maps of 1024².
    #[must_use]
    pub fn new(mesh: &'a Mesh, atlas: &'a Atlas) -> Self {
        Self {
            mesh,
            atlas,
            medium: Medium::default(),
            profile: Profile::default(),
            method: Method::default(),
            mm_per_unit: 1000.0,
            flat_normals: false,
            shadow_resolution: 1024,
        }
    }
}

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
    /// Rms radius of a typical texel over the diagonal of the rest pose.
    relative_spread: f32,
    shadow_resolution: u32,

    medium: Medium,
    profile: Profile,
    method: Method,
    model: Mat4,
    winding: f32,
    weights: Vec<f32>,
    lights: Vec<Light>,
    corners: [Vec3; 8],
    view_count: u32,
    table_diagonal: f32,
    table: KernelTableLayout,
    pending: StageSet,
    /// Whether the kernel table no longer fits the medium, or the scatter uniforms the method.
    scatter_stale: bool,
    /// Whether light now enters the surface differently.
    surface_stale: bool,
    never_prepared: bool,

    exitance: wgpu::Texture,
    exitance_view: wgpu::TextureView,
    kernel_table: wgpu::Texture,
    pub(crate) depth_maps: DepthMaps,
    deform_group: wgpu::BindGroup,
    gather_group: wgpu::BindGroup,
    cluster_group: wgpu::BindGroup,
    scatter_group: wgpu::BindGroup,
    resolve_group: wgpu::BindGroup,
}

/// How much longer than the body's diagonal the kernel table reaches, and how much shorter the diagonal may get before the table is
/// made anew.
const TABLE_REACH: f32 = 4.0;
/// Texels this much narrower than a typical one still find themselves in the kernel table.
const NARROW_TEXELS: f32 = 16.0;

impl Body {
    pub(crate) fn new(
        device: &wgpu::Device,
        stages: Arc<Stages>,
        descriptor: &BodyDescriptor<'_>,
    ) -> Result<Self, Error> {
        let BodyDescriptor { mesh, atlas, medium, profile, method, mm_per_unit, .. } = *descriptor;
        buffers::validate(mesh, atlas)?;
        validate_options(descriptor, device.limits().max_texture_dimension_2d)?;
        let extent = Extent::new(mesh, atlas);
        extent.check(&device.limits())?;

        let tree = Tree::new(extent.texels);
        let buffers = Buffers::new(device, mesh, atlas, &tree);
        let covered = atlas.texels.iter().filter(|texel| texel.area > 0.0).count().max(1);
        let area: f32 = atlas.texels.iter().map(|texel| texel.area).sum();
        let spread = (area / covered as f32 / std::f32::consts::TAU).sqrt();

        let size = wgpu::Extent3d { width: atlas.size, height: atlas.size, depth_or_array_layers: 1 };
        let usage = wgpu::TextureUsages::STORAGE_BINDING
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC;
        let exitance = texture(device, "exitance", size, usage);
        let exitance_view = exitance.create_view(&wgpu::TextureViewDescriptor::default());
        let bounds = PoseBounds::new(mesh);
        let rest_diagonal = frame::diagonal(&bounds.corners(&vec![0.0; mesh.targets.len()], Mat4::IDENTITY));
        let relative_spread = spread / rest_diagonal.max(f32::MIN_POSITIVE);
        let table = KernelTableLayout::new(table_range(1.0, relative_spread));
        let kernel_table = kernel_table_texture(device, table);
        let depth_maps = stages.shadow.depth_maps(device, descriptor.shadow_resolution, 1);
        let table_view = kernel_table.create_view(&wgpu::TextureViewDescriptor::default());
        Ok(Self {
            deform_group: stages.deform.bind(device, &buffers),
            gather_group: stages.gather.bind(device, &buffers, &depth_maps),
            cluster_group: stages.cluster.bind(device, &buffers),
            scatter_group: stages.scatter.bind(device, &buffers, &table_view),
            resolve_group: stages.resolve.bind(device, &buffers.exitance, &buffers.pixels, &exitance_view),
            stages,
            buffers,
            extent,
            flat_normals: descriptor.flat_normals,
            mm_per_unit,
            tree,
            bounds,
            relative_spread,
            shadow_resolution: descriptor.shadow_resolution,
            medium,
            profile,
            method,
            model: Mat4::IDENTITY,
            winding: 1.0,
            weights: vec![0.0; mesh.targets.len()],
            lights: Vec::new(),
            corners: [Vec3::ZERO; 8],
            view_count: 0,
            table_diagonal: 0.0,
            table,
            pending: StageSet::default(),
            scatter_stale: true,
            surface_stale: true,
            never_prepared: true,
            exitance,
            exitance_view,
            kernel_table,
            depth_maps,
        })
    }

    /// Takes over the inputs of the next frame and uploads what changed. Finds out which stages the frame needs.
    ///
    /// # Errors
    /// [`Error::Frame`] names the light, weight or matrix that cannot be; the body then keeps its last frame.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        frame: &Frame<'_>,
    ) -> Result<(), Error> {
        let model = Mat4::from_cols_array_2d(&frame.model);
        frame::validate_model(model)?;
        let weights = self.weights_of(frame.deformation)?;
        let Lighting::Lights(lights) = frame.lighting;
        frame::validate_lights(lights)?;

        let moved = self.never_prepared || model != self.model || weights != self.weights;
        let relit = moved || self.surface_stale || lights != self.lights;
        let to_mm = Mat4::from_scale(Vec3::splat(self.mm_per_unit)) * model;
        let winding = to_mm.determinant().signum();
        let corners = self.bounds.corners(&weights, to_mm);
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
            let uniform = DeformLayout {
                model: to_mm.to_cols_array_2d(),
                normal: to_mm.inverse().transpose().to_cols_array_2d(),
                vertex_count: self.extent.vertices,
                target_count: self.extent.targets,
                winding,
                padding: 0,
            };
            queue.write_buffer(&self.buffers.deform_uniform, 0, bytemuck::bytes_of(&uniform));
            queue.write_buffer(&self.buffers.weights, 0, bytemuck::cast_slice(&weights));
            self.pending.insert(StageSet::from_stage_on(Stage::Deform));
        }
        (self.model, self.winding, self.corners) = (model, winding, corners);
        self.weights = weights;
        self.lights.clear();
        self.lights.extend_from_slice(lights);
        self.never_prepared = false;
        self.surface_stale = false;
        self.refresh_medium(queue);
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
                &self.deform_group,
                self.extent.vertices,
                self.extent.targets > 0,
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
        Ok(())
    }

    /// Changes the profile. Today's profiles differ in how light leaves towards the eye, so no stage has to run again.
    pub fn set_profile(&mut self, profile: Profile) {
        self.profile = profile;
    }

    /// Changes how the scatter sum is evaluated; the next frame scatters anew.
    ///
    /// # Errors
    /// [`Error::Frame`] for an opening angle outside its range.
    pub fn set_method(&mut self, method: Method) -> Result<(), Error> {
        validate_method(method)?;
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
        let buffers = &self.buffers;
        Outputs {
            positions: &buffers.positions,
            normals: &buffers.normals,
            depth_maps: &self.depth_maps.texture,
            texel_positions: &buffers.texel_positions,
            texel_normals: &buffers.texel_normals,
            irradiance: &buffers.irradiance,
            clusters: &buffers.clusters,
            exitance: &buffers.exitance,
        }
    }

    fn weights_of(&self, deformation: Deformation<'_>) -> Result<Vec<f32>, Error> {
        let targets = self.extent.targets as usize;
        let weights = match deformation {
            Deformation::Rest => return Ok(vec![0.0; targets]),
            Deformation::Morph(weights) => weights,
        };
        if weights.len() != targets {
            let problem = format!("{} morph weights for {targets} targets", weights.len());
            return Err(Error::Frame { problem, remedy: "give one weight per target" });
        }
        if let Some(k) = weights.iter().position(|weight| !weight.is_finite()) {
            let problem = format!("morph weight {k} is {}", weights[k]);
            return Err(Error::Frame { problem, remedy: "give finite weights" });
        }
        Ok(weights.to_vec())
    }

    fn make_room_for_views(&mut self, device: &wgpu::Device, views: u32) {
        if views > self.depth_maps.layers() {
            self.depth_maps = self.stages.shadow.depth_maps(device, self.shadow_resolution, views);
            self.gather_group = self.stages.gather.bind(device, &self.buffers, &self.depth_maps);
        }
    }

    /// Makes the kernel table anew where the medium changed or the body outgrew it.
    fn refresh_medium(&mut self, queue: &wgpu::Queue) {
        let diagonal = frame::diagonal(&self.corners).max(f32::MIN_POSITIVE);
        let outgrown = !(0.25..=1.0).contains(&(diagonal / self.table_diagonal));
        if !self.scatter_stale && !outgrown {
            return;
        }
        let channels = [0, 1, 2].map(|channel| Dipole::new(&self.medium, channel));
        // The range keeps its proportions, so that the texture's size stays; the margin spares the next growth a new table.
        self.table_diagonal = if outgrown { 1.25 * diagonal } else { self.table_diagonal };
        let mut table = KernelTableLayout::new(table_range(self.table_diagonal, self.relative_spread));
        (table.columns, table.rows) = (self.table.columns, self.table.rows);
        self.table = table;
        let texels = kernel_table::build(table, &channels);
        queue.write_texture(
            self.kernel_table.as_image_copy(),
            bytemuck::cast_slice(&texels),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(16 * table.columns),
                rows_per_image: None,
            },
            self.kernel_table.size(),
        );
        queue.write_buffer(
            &self.buffers.scatter_uniforms,
            0,
            &Scatter::uniforms(self.scatter_layout(&channels)),
        );
        self.pending.insert(StageSet::from_stage_on(Stage::Scatter));
        self.scatter_stale = false;
    }

    fn scatter_layout(&self, channels: &[Dipole; 3]) -> ScatterLayout {
        let theta = match self.method {
            Method::Tree { theta } => theta,
            Method::AllPairs => 0.0,
        };
        let z_r = channels
            .iter()
            .filter(|dipole| dipole.total() > 0.0)
            .map(|dipole| dipole.z_r as f32)
            .fold(f32::MAX, f32::min);
        let mut offsets = [[0; 4]; 4];
        for (level, offset) in self.tree.offsets.iter().enumerate() {
            offsets[level / 4][level % 4] = *offset;
        }
        ScatterLayout {
            table: self.table,
            texel_count: self.extent.texels,
            first_source: 0,
            source_count: 0,
            top_level: self.tree.top_level(),
            top_count: 1,
            theta_squared: theta * theta,
            z_r_squared: z_r.min(1e15) * z_r.min(1e15),
            padding: 0,
            offsets,
        }
    }
}

/// What the stages wrote, as buffers in the order of the atlas' texels or the mesh's vertices. Every entry is four floats but the
/// clusters' ([`Cluster`](crate::Cluster)).
#[derive(Clone, Copy, Debug)]
pub struct Outputs<'a> {
    /// Deformed positions of the mesh's vertices, mm, w = 1.
    pub positions: &'a wgpu::Buffer,
    /// Unit normals of the mesh's vertices.
    pub normals: &'a wgpu::Buffer,
    /// `Depth32Float`, a layer per view.
    pub depth_maps: &'a wgpu::Texture,
    /// Position of each texel, mm, and its live area, mm².
    pub texel_positions: &'a wgpu::Buffer,
    /// Unit shading normal of each texel.
    pub texel_normals: &'a wgpu::Buffer,
    /// Irradiance E of each texel, RGB.
    pub irradiance: &'a wgpu::Buffer,
    /// Clusters of every level above the texels.
    pub clusters: &'a wgpu::Buffer,
    /// Radiant exitance B of each texel, RGB.
    pub exitance: &'a wgpu::Buffer,
}

fn begin<'a>(encoder: &'a mut wgpu::CommandEncoder, label: &str) -> wgpu::ComputePass<'a> {
    encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(label), timestamp_writes: None })
}

fn texture(
    device: &wgpu::Device,
    label: &str,
    size: wgpu::Extent3d,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: Resolve::FORMAT,
        usage,
        view_formats: &[],
    })
}

fn table_range(diagonal: f32, relative_spread: f32) -> KernelRange {
    KernelRange { least_spread: diagonal * relative_spread / NARROW_TEXELS, longest: TABLE_REACH * diagonal }
}

fn kernel_table_texture(device: &wgpu::Device, table: KernelTableLayout) -> wgpu::Texture {
    // One cell to spare: the same proportions at another scale may round up.
    let size = wgpu::Extent3d { width: table.columns, height: 2 * table.rows, depth_or_array_layers: 1 };
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    texture(device, "kernel table", size, usage)
}

fn validate_options(descriptor: &BodyDescriptor<'_>, limit: u32) -> Result<(), Error> {
    descriptor.medium.validate()?;
    validate_method(descriptor.method)?;
    let fail =
        |problem: String, remedy| Err(Error::Body { mesh: descriptor.mesh.name.clone(), problem, remedy });
    if !(descriptor.mm_per_unit > 0.0 && descriptor.mm_per_unit.is_finite()) {
        let problem = format!("{} mm per unit", descriptor.mm_per_unit);
        return fail(problem, "give a finite scale above 0");
    }
    if !(16..=limit).contains(&descriptor.shadow_resolution) {
        let problem = format!("depth maps of {}²", descriptor.shadow_resolution);
        return fail(problem, "give a resolution between 16 and the device's max_texture_dimension_2d");
    }
    Ok(())
}

fn validate_method(method: Method) -> Result<(), Error> {
    match method {
        Method::Tree { theta } if !(0.05..=2.0).contains(&theta) => Err(Error::Frame {
            problem: format!("opening angle {theta}"),
            remedy: "give θ between 0.05 and 2, or use all pairs",
        }),
        _ => Ok(()),
    }
}
