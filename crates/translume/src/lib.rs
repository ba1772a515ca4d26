//! Real-time translucency for deforming meshes on wgpu: lights in, an exitance texture out.
//!
//! Nothing is baked: whatever a deformation changes is computed again, whatever it leaves is kept. The host lends its device,
//! translume records into the host's encoder, and the host samples one texture in its own material (or lets [`Composite`] draw).
//!
//! ```no_run
//! # fn example(device: &wgpu::Device, queue: &wgpu::Queue, mesh: &translume_mesh::Mesh, atlas: &translume_mesh::Atlas)
//! #     -> Result<(), translume::Error> {
//! use translume::{BodyDescriptor, Config, Frame, Light, Lighting, Medium, PointLight, Translume};
//!
//! // once
//! let translume = Translume::new(device, &Config::default())?;
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
mod device;
mod environment;
mod error;
mod evaluate;
mod frame;
mod fresnel;
mod geometry;
mod gpu;
mod host_vertices;
mod kernel_table;
mod kernel_texture;
mod layout;
mod levels;
mod light;
mod light_points;
mod lighting;
mod medium;
mod memory;
mod phase;
mod pose;
mod profile;
mod quadrature;
pub mod readback;
mod scratch;
mod shadow_options;
mod shadow_view;
mod stages;
mod standing;
mod timings;
mod transport;
mod variation;

pub use area_light::{RectangleLight, SphereLight};
pub use body::Body;
pub use buffers::Outputs;
pub use camera::{Camera, LookAt};
pub use descriptor::BodyDescriptor;
pub use device::{largest_atlas, required_limits};
pub use environment::{EnvironmentLight, EnvironmentMap};
pub use error::{Error, MissingLimit};
pub use evaluate::{Evaluate, View};
pub use frame::{Casters, Deformation, Frame, Lighting};
pub use geometry::Geometry;
pub use gpu::Work;
pub use host_vertices::{HostVertices, VertexVectors};
pub use layout::Cluster;
pub use levels::Levels;
pub use light::{AmbientLight, DirectionalLight, Light, PointLight, Region, SpotLight};
pub use medium::Medium;
pub use memory::MemoryUse;
pub use profile::{BurleyFit, BurleyShape, Diffusion, Entry, Layer, Layers, Profile, Reflectance, Table};
pub use shadow_options::ShadowOptions;
pub use stages::composite::{Composite, CompositeTarget, CompositeView, Gloss};
pub use stages::scatter::Method;
pub use stages::shadow::ShadowView;
pub use stages::{Stage, StageSet};
pub use timings::{Clock, FrameTimings};
pub use transport::Transport;
pub use variation::Variation;

use std::sync::Arc;

/// How the library treats a device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Config {
    /// Bytes of GPU memory that all bodies may take together, as [`Body::memory`] counts them. What would exceed them is refused with
    /// [`Error::Memory`]. `None` leaves it to the device.
    pub memory: Option<u64>,
}

/// The pipelines, shared by all bodies of a device, and the memory that bodies may share.
///
/// ```no_run
/// # fn example(device: &translume::wgpu::Device) -> Result<(), translume::Error> {
/// use translume::{Config, Translume};
///
/// let translume = Translume::new(device, &Config { memory: Some(256 << 20) })?;
/// # Ok(()) }
/// ```
pub struct Translume {
    stages: Arc<stages::Stages>,
    ledger: Arc<memory::Ledger>,
}

impl Translume {
    /// Compiles every pipeline that most bodies need.
    ///
    /// # Errors
    /// [`Error::Device`] names the limits of the device that are too low. WebGPU's default limits are enough.
    pub fn new(device: &wgpu::Device, config: &Config) -> Result<Self, Error> {
        device::check(&device.limits())?;
        let ledger = memory::Ledger::new(config.memory);
        Ok(Self { stages: Arc::new(stages::Stages::new(device, &ledger)), ledger })
    }

    /// Uploads a mesh and its atlas.
    ///
    /// # Errors
    /// [`Error::Body`] names the element that cannot be; [`Error::Limit`] the limit that is too low; [`Error::Medium`] the coefficient;
    /// [`Error::Memory`] how many bytes there are left.
    pub fn create_body(&self, device: &wgpu::Device, descriptor: &BodyDescriptor<'_>) -> Result<Body, Error> {
        Body::new(device, Arc::clone(&self.stages), &self.ledger, descriptor)
    }

    /// Pipelines that draw bodies into this kind of target.
    #[must_use]
    pub fn composite(&self, device: &wgpu::Device, target: CompositeTarget) -> Composite {
        Composite::new(device, &self.stages.scatter.dual.points, target)
    }

    /// Bytes of GPU memory that all bodies take, and what they share.
    #[must_use]
    pub fn memory(&self) -> u64 {
        self.ledger.used()
    }
}
