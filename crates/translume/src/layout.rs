//! What WGSL reads, byte for byte. A test holds every struct here against naga's own offsets.

use crate::kernel_table::KernelTableLayout;
use bytemuck::{Pod, Zeroable};

/// Most lights of one frame that are not ambient.
pub(crate) const MAX_LIGHTS: usize = 64;
/// Most depth maps of one frame; a point light near its body takes six, an area light some for each of its points.
pub(crate) const MAX_VIEWS: usize = 256;
/// Most points of all area lights of one frame.
pub(crate) const MAX_EMITTERS: usize = 256;
/// Most directions towards the sky.
pub(crate) const MAX_DIRECTIONS: usize = crate::ShadowOptions::MAX_DIRECTIONS as usize;
/// Most ambient lights of one frame.
pub(crate) const MAX_AMBIENTS: usize = 8;
/// Marks a light without a depth map.
pub(crate) const NO_SHADOW: u32 = u32::MAX;

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct WarpLayout {
    pub foot: [f32; 3],
    pub inflate: f32,
    pub height: f32,
    pub per_height: f32,
    pub twist: f32,
    pub bend: f32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct DeformLayout {
    pub model: [[f32; 4]; 4],
    pub normal: [[f32; 4]; 4],
    pub warp: WarpLayout,
    pub vertex_count: u32,
    pub target_count: u32,
    pub influences_per_vertex: u32,
    pub winding: f32,
}

/// Where the host's vertices lie, in words from where its buffers are bound; a stride of 0 for none.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct AdoptLayout {
    pub first_position: u32,
    pub position_stride: u32,
    pub first_normal: u32,
    pub normal_stride: u32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct InfluenceLayout {
    pub joint: u32,
    pub weight: f32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct LightLayout {
    pub vector: [f32; 3],
    pub kind: u32,
    pub colour: [f32; 3],
    pub first_view: u32,
    pub region_low: [f32; 3],
    pub view_count: u32,
    pub region_high: [f32; 3],
    pub cone_scale: f32,
    pub axis: [f32; 3],
    pub cone_offset: f32,
    pub half_right: [f32; 3],
    pub first_emitter: u32,
    pub half_up: [f32; 3],
    pub emitter_count: u32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct AmbientLayout {
    pub radiance: [f32; 3],
    pub cone_cosine: f32,
    pub axis: [f32; 3],
    pub shadow: u32,
    pub table: [[f32; 4]; 33],
    pub first_view: u32,
    pub first_emitter: u32,
    pub emitter_count: u32,
    pub padding: u32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct ShadowViewLayout {
    pub matrix: [[f32; 4]; 4],
    pub tile: [f32; 3],
    pub layer: u32,
    pub texel: f32,
    pub perspective: f32,
    pub padding0: f32,
    pub padding1: f32,
}

/// Eight directions of the visibility stage.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct DirectionsLayout {
    pub word: u32,
    pub padding: [u32; 3],
    pub eight: [DirectionLayout; 8],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct DirectionLayout {
    pub column: [f32; 4],
    pub row: [f32; 4],
    pub depth: [f32; 4],
    pub to_sky: [f32; 3],
    pub texel: f32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct SkyLayout {
    pub direction: [f32; 3],
    pub padding0: u32,
    pub radiance: [f32; 3],
    pub padding1: u32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GatherLayout {
    pub texel_count: u32,
    pub light_count: u32,
    pub ambient_count: u32,
    pub flat_normals: u32,
    pub eta: f32,
    pub winding: f32,
    pub filter_side: u32,
    pub direction_count: u32,
    pub slant: [f32; 3],
    pub on_surface: u32,
    pub open_sky: [[f32; 4]; 9],
    pub shadowed_sky: [[f32; 4]; 9],
    pub lights: [LightLayout; MAX_LIGHTS],
    pub ambients: [AmbientLayout; MAX_AMBIENTS],
    pub emitters: [[f32; 4]; MAX_EMITTERS],
    pub views: [ShadowViewLayout; MAX_VIEWS],
    pub sky: [SkyLayout; MAX_DIRECTIONS],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct TexelLayout {
    pub triangle: u32,
    pub barycentric_1: f32,
    pub barycentric_2: f32,
    pub area_ratio: f32,
    pub points: [LightPointLayout; 4],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct LightPointLayout {
    pub triangle: u32,
    /// Weights of the second and third corner in 65,535ths, the second in the lower half.
    pub weights: u32,
}

/// A source off the surface.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct TermLayout {
    pub depth: [f32; 3],
    pub padding_0: u32,
    pub weight: [f32; 3],
    pub padding_1: u32,
}

/// Which texels are needed as receivers.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct NeedLayout {
    pub view_projection: [[f32; 4]; 4],
    pub eye: [f32; 3],
    pub kind: u32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct LevelLayout {
    pub child_count: u32,
    pub node_count: u32,
    pub child_offset: u32,
    pub node_offset: u32,
    pub source_offset: u32,
    pub receiver_offset: u32,
    pub child_sources: u32,
    pub padding: u32,
}

/// A texel or a group of them seen as a source whose place is known.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct LampLayout {
    pub power: [f32; 3],
    pub spread: f32,
    pub normal: [f32; 3],
    pub marks: u32,
    pub moments: [u32; 3],
    pub padding: u32,
}

/// A group of texels seen as one receiver.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct ReceiverLayout {
    pub centre: [f32; 3],
    pub spread: f32,
    pub radius: f32,
    pub texels: u32,
    pub padding: [u32; 2],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct DualLayout {
    pub table: KernelTableLayout,
    pub texel_count: u32,
    pub level: u32,
    pub start_level: u32,
    pub top_level: u32,
    pub theta_squared: f32,
    pub leaf_theta_squared: f32,
    pub z_r_squared: f32,
    pub capacity: u32,
    pub first_receiver: u32,
    pub first_expansion: u32,
    pub padding: [u32; 2],
    pub terms: [TermLayout; 2],
    pub offsets: [[u32; 4]; 4],
    pub sources: [[u32; 4]; 4],
}

/// A group of texels seen as one source. Lengths in mm. Mirrors `Cluster` in `shared/cluster.wgsl`.
///
/// ```no_run
/// # fn example(device: &translume::wgpu::Device, queue: &translume::wgpu::Queue, body: &mut translume::Body) -> Result<(), translume::Error> {
/// use translume::{Cluster, readback};
///
/// let clusters: Vec<Cluster> = readback::buffer(device, queue, body.outputs().clusters)?;
/// // The last one is the whole body.
/// println!("{:?} leaves through {} mm²", clusters[clusters.len() - 1].power, clusters[clusters.len() - 1].area);
/// # Ok(()) }
/// ```
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Cluster {
    /// Power-weighted centroid, mm.
    pub centroid: [f32; 3],
    /// Power-weighted rms radius, the members' own discs included, mm.
    pub spread: f32,
    /// Sum of irradiance times area, RGB.
    pub power: [f32; 3],
    /// No member's centre is further from the centroid, mm.
    pub radius: f32,
    /// Power-weighted mean normal, unit length, or zero where it cancels.
    pub normal: [f32; 3],
    /// Sum of live areas, mm².
    pub area: f32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct ScatterLayout {
    pub table: KernelTableLayout,
    pub texel_count: u32,
    pub first_source: u32,
    pub source_count: u32,
    pub top_level: u32,
    pub theta_squared: f32,
    pub z_r_squared: f32,
    pub padding: [u32; 2],
    pub sources: [[u32; 4]; 4],
    pub terms: [TermLayout; 2],
}

/// Media and tree as the boundary solver reads them.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct TransportLayout {
    pub extinction: [f32; 4],
    pub albedo: [f32; 4],
    pub diffusion: [f32; 4],
    pub decay: [f32; 4],
    pub robin: [f32; 4],
    pub shortfall: [f32; 4],
    pub site_count: u32,
    pub top_level: u32,
    pub eta: f32,
    pub source_count: u32,
    pub groups: u32,
    pub reach_squared: f32,
    pub texel_count: u32,
    pub texels_per_site: u32,
    pub hopf: [f32; 3],
    pub open: f32,
    pub bend: f32,
    pub along: f32,
    pub lean: f32,
    pub anisotropy: f32,
    pub eye: [f32; 3],
    pub light_bounds: u32,
    pub offsets: [[u32; 4]; 4],
    pub sources: [[u32; 4]; 4],
    pub spread: [[f32; 4]; 64],
}

/// The sites around one.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct SurroundingsLayout {
    pub count: u32,
    pub reach: f32,
    pub sites: [u32; 30],
}

/// What falls on a site.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct SiteLightLayout {
    pub irradiance: [f32; 4],
    pub tint: [f32; 4],
}

/// A source's extent.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct ShapeLayout {
    pub normal: [f32; 3],
    pub spread: f32,
    pub moments: [u32; 3],
    pub area: f32,
    pub turns: [u32; 3],
    pub size: f32,
}

/// A group of texels that bounds rays and receives.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct NodeLayout {
    pub centre: [f32; 3],
    pub radius: f32,
    pub axis: [f32; 3],
    pub thickness: f32,
    pub middle: [f32; 3],
    pub reach: f32,
    pub scatter: f32,
    pub sites: f32,
    pub padding: [f32; 2],
}

/// What a source sends.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct ChargeLayout {
    pub power: [f32; 4],
    pub x: [f32; 4],
    pub y: [f32; 4],
    pub z: [f32; 4],
}

/// Where light that entered scatters first.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct StrataLayout {
    pub direction: [f32; 3],
    pub cosine: f32,
    pub ways: [[f32; 4]; 4],
    pub rises: [[f32; 4]; 4],
    pub mean: [f32; 4],
    pub rise: [f32; 4],
    pub square: [f32; 4],
}

/// φ under a texel.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct ParabolaLayout {
    pub surface: [f32; 3],
    pub thickness: f32,
    pub slope: [f32; 3],
    pub cosine: f32,
    pub curve: [f32; 3],
    pub around: f32,
    pub open: [f32; 3],
    pub bulge: f32,
    pub light: [f32; 3],
    pub padding: f32,
}

/// Where the solver is.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct StateLayout {
    pub mean: [f32; 4],
    pub weights: [[f32; 4]; StateLayout::DIRECTIONS],
    pub scale: [f32; 4],
    pub residual: [f32; 4],
    pub next: u32,
    pub count: u32,
    pub failed: u32,
    pub failures: u32,
}

impl StateLayout {
    /// That the solver keeps.
    pub const DIRECTIONS: usize = 6;
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct PatternLayout {
    pub table: KernelTableLayout,
    pub texel_count: u32,
    pub size: u32,
    pub near_step: f32,
    pub far_step: f32,
    pub near_area: f32,
    pub far_area: f32,
    pub padding: [u32; 2],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct CompositeLayout {
    pub view_projection: [[f32; 4]; 4],
    pub eye: [f32; 3],
    pub eta: f32,
    pub exit_scale: f32,
    pub roughness: f32,
    pub padding: [u32; 2],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct AtlasVertexLayout {
    pub xref: u32,
    pub uv: [f32; 2],
}

#[cfg(test)]
mod tests;
