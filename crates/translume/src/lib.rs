//! Real-time translucency for deforming meshes on wgpu: lights in, an exitance texture out.
//!
//! Nothing is baked: whatever a deformation changes is computed again, whatever it leaves is kept. The host lends its device,
//! translume records into the host's encoder, and the host samples one texture in its own material (or lets [`Composite`] draw).
//!
//! ```no_run
//! # fn example(device: &wgpu::Device, queue: &wgpu::Queue, mesh: &translume_mesh::Mesh, atlas: &translume_mesh::Atlas)
//! #     -> Result<(), translume::Error> {
//! use translume::{BodyDescriptor, Frame, Light, Lighting, Medium, PointLight, Translume};
//!
//! // once
//! let translume = Translume::new(device)?;
//! let mut body = translume.create_body(device, &BodyDescriptor {
//!     medium: Medium::JADE,
//!     ..BodyDescriptor::new(mesh, atlas)
//! })?;
//!
//! // each frame
//! let lamp = Light::Point(PointLight { position: [0.0, 0.2, -0.3], intensity: [0.3; 3], ..Default::default() });
//! body.prepare(device, queue, &Frame { lighting: Lighting::Lights(&[lamp]), ..Default::default() })?;
//! let mut encoder = device.create_command_encoder(&Default::default());
//! body.encode(&mut encoder);
//! // sample body.exitance_view() in your material, or draw with translume.composite(…)
//! queue.submit([encoder.finish()]);
//! # Ok(()) }
//! ```
//!
//! # Units
//! Positions are in the host's world units; a body says how many millimetres one is ([`BodyDescriptor::mm_per_unit`]), because media
//! are measured in 1/mm. Light keeps the host's unit of power. Colour is linear RGB.

pub use wgpu;

mod area_light;
mod body;
mod boundary;
mod bounds;
mod buffers;
mod camera;
mod descriptor;
mod environment;
mod error;
mod evaluate;
mod frame;
mod fresnel;
mod gpu;
mod kernel_table;
mod kernel_texture;
mod layout;
mod light;
mod light_points;
mod lighting;
mod medium;
mod pose;
mod profile;
mod quadrature;
pub mod readback;
mod shadow_options;
mod shadow_view;
mod stages;
mod standing;
mod timings;
mod variation;

pub use area_light::{RectangleLight, SphereLight};
pub use body::Body;
pub use buffers::Outputs;
pub use camera::{Camera, LookAt};
pub use descriptor::BodyDescriptor;
pub use environment::{EnvironmentLight, EnvironmentMap};
pub use error::Error;
pub use evaluate::{Evaluate, View};
pub use frame::{Casters, Deformation, Frame, Lighting};
pub use gpu::Work;
pub use layout::Cluster;
pub use light::{AmbientLight, DirectionalLight, Light, PointLight, Region, SpotLight};
pub use medium::Medium;
pub use profile::{BurleyFit, BurleyShape, Diffusion, Entry, Layer, Layers, Profile, Reflectance, Table};
pub use shadow_options::ShadowOptions;
pub use stages::composite::{Composite, CompositeTarget, CompositeView, Gloss};
pub use stages::scatter::Method;
pub use stages::shadow::ShadowView;
pub use stages::{Stage, StageSet};
pub use timings::{Clock, FrameTimings};
pub use variation::Variation;

use std::sync::Arc;

/// The pipelines, shared by all bodies of a device.
pub struct Translume {
    stages: Arc<stages::Stages>,
}

impl Translume {
    /// Compiles every pipeline.
    ///
    /// # Errors
    /// [`Error::Limit`] names the limit of the device that is too low. WebGPU's default limits are enough.
    pub fn new(device: &wgpu::Device) -> Result<Self, Error> {
        check_limits(&device.limits())?;
        Ok(Self { stages: Arc::new(stages::Stages::new(device)) })
    }

    /// Uploads a mesh and its atlas.
    ///
    /// # Errors
    /// [`Error::Body`] names the element that cannot be; [`Error::Limit`] the limit that is too low; [`Error::Medium`] the coefficient.
    pub fn create_body(&self, device: &wgpu::Device, descriptor: &BodyDescriptor<'_>) -> Result<Body, Error> {
        Body::new(device, Arc::clone(&self.stages), descriptor)
    }

    /// Pipelines that draw bodies into this kind of target.
    #[must_use]
    pub fn composite(&self, device: &wgpu::Device, target: CompositeTarget) -> Composite {
        Composite::new(device, &self.stages.scatter.dual.points, target)
    }
}

/// The largest atlas whose texture a device with these limits can surely address, in texels. How many texels a surface fills also counts:
/// [`Translume::create_body`] has the last word.
#[must_use]
pub fn largest_atlas(limits: &wgpu::Limits) -> u32 {
    let pixels = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size) / 4;
    limits.max_texture_dimension_2d.min(pixels.isqrt() as u32)
}

fn check_limits(limits: &wgpu::Limits) -> Result<(), Error> {
    let needs = [
        ("max_storage_buffers_per_shader_stage", 8, limits.max_storage_buffers_per_shader_stage),
        (
            "max_uniform_buffer_binding_size",
            size_of::<layout::GatherLayout>() as u32,
            limits.max_uniform_buffer_binding_size as u32,
        ),
        ("max_compute_invocations_per_workgroup", 64, limits.max_compute_invocations_per_workgroup),
        ("max_compute_workgroups_per_dimension", 65_535, limits.max_compute_workgroups_per_dimension),
        ("max_storage_textures_per_shader_stage", 1, limits.max_storage_textures_per_shader_stage),
    ];
    for (limit, required, actual) in needs {
        if actual < required {
            return Err(Error::Limit {
                what: "translume".to_owned(),
                limit,
                required: required.into(),
                actual: actual.into(),
                remedy: "create the device with at least WebGPU's default limits",
            });
        }
    }
    Ok(())
}
