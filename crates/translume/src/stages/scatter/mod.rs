//! Scatter: irradiance → radiant exitance per texel, B_i = Σ_j E_j·A_j·K̄(|p_i − p_j|, s_j).
//!
//! reads  texel positions, normals, irradiance, clusters, kernel table      writes  exitance per texel, linear RGB
//! twin   `translume_reference::scatter`                                    WGSL    `scatter.wgsl`

pub(crate) mod dual;
pub(crate) mod pattern;

use crate::Error;
use crate::buffers::Buffers;
use crate::gpu::{self, FLOAT_TEXTURE, Pass, READ, UNIFORM_ARRAY, UNIFORM_STRIDE, WRITE};
use crate::kernel_table::KernelTableLayout;
use crate::layout::ScatterLayout;
use crate::profile::Dipole;
use crate::stages::cluster::Tree;

/// How the sum over sources is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Method {
    /// Every texel collects from every other: exact, and quadratic in the number of texels. What everything else is compared with.
    AllPairs,
    /// Every texel walks the tree of clusters and takes a cluster as one source as soon as its radius is below
    /// `theta`·√(distance² + z_r²).
    Tree {
        /// Opening angle, 0.05..=2. Smaller is more accurate: the error falls roughly with its square.
        theta: f32,
    },
    /// Groups of texels at both ends: far light is worked out once for all texels of a group and spread over them to second order. Takes a
    /// source as soon as its radius and twice the receivers' are together below `theta`·√(distance² + z_r²), or for a single
    /// texel as soon as the source's radius is below 0.4 of that.
    Dual {
        /// Opening angle, 0.05..=2; 0.75 is about as accurate as the tree at 0.4. The error falls roughly with its fourth power. Below
        /// 0.65 give the lists more room ([`BodyDescriptor::list_entries`](crate::BodyDescriptor::list_entries)).
        theta: f32,
    },
    /// For comparison, the way of Gong et al. 2008: 49 samples in a square of the atlas around the texel and eight far ones around that,
    /// whatever lies there. Each stands for the area of its part of the pattern as if all texels had the same area, that of the
    /// rest pose before the model matrix. What is near on the surface but elsewhere in the atlas is lost, and so is light
    /// through thin parts: it is tens of percent off.
    Pattern,
}

impl Default for Method {
    /// Dual at θ = 0.75: as accurate as the tree at 0.4, and six to eight times as fast from 40,000 texels on.
    fn default() -> Self {
        Self::Dual { theta: 0.75 }
    }
}

impl Method {
    /// Checks the opening angle.
    pub(crate) fn validate(self) -> Result<(), Error> {
        match self {
            Self::Tree { theta } | Self::Dual { theta } if !(0.05..=2.0).contains(&theta) => {
                Err(Error::Frame {
                    problem: format!("opening angle {theta}"),
                    remedy: "give θ between 0.05 and 2, or use all pairs",
                })
            }
            _ => Ok(()),
        }
    }
}

/// Sources of one dispatch of all pairs: short enough for a driver's watchdog, and far below the 65,535 loop iterations after
/// which some software rasterisers silently stop an invocation.
pub(crate) const SOURCES_PER_DISPATCH: u32 = 8192;

pub(crate) struct Scatter {
    layout: wgpu::BindGroupLayout,
    all_pairs: wgpu::ComputePipeline,
    tree: wgpu::ComputePipeline,
    pub dual: dual::Dual,
}

impl Scatter {
    pub fn new(device: &wgpu::Device) -> Self {
        let types = [UNIFORM_ARRAY, READ, READ, READ, READ, WRITE, FLOAT_TEXTURE];
        let layout = gpu::layout(device, "scatter", wgpu::ShaderStages::COMPUTE, &types);
        let module = gpu::module(device, translume_shaders::SCATTER);
        Self {
            all_pairs: gpu::compute_pipeline(device, &layout, &module, "all_pairs"),
            tree: gpu::compute_pipeline(device, &layout, &module, "tree"),
            dual: dual::Dual::new(device),
            layout,
        }
    }

    pub fn bind(
        &self,
        device: &wgpu::Device,
        buffers: &Buffers,
        kernel_table: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        let resources = [
            gpu::uniform_slot::<ScatterLayout>(&buffers.scatter_uniforms),
            buffers.texel_positions.as_entire_binding(),
            buffers.texel_normals.as_entire_binding(),
            buffers.irradiance.as_entire_binding(),
            buffers.clusters.as_entire_binding(),
            buffers.exitance.as_entire_binding(),
            wgpu::BindingResource::TextureView(kernel_table),
        ];
        gpu::bind(device, "scatter", &self.layout, &resources)
    }

    /// What the shader needs to know of a body of this medium.
    pub fn layout(
        table: KernelTableLayout,
        channels: &[Dipole; 3],
        tree: &Tree,
        method: Method,
    ) -> ScatterLayout {
        let theta = match method {
            Method::Tree { theta } | Method::Dual { theta } => theta,
            Method::AllPairs | Method::Pattern => 0.0,
        };
        let scattering = channels.iter().filter(|dipole| dipole.total() > 0.0);
        let z_r = scattering.map(|dipole| dipole.z_r as f32).fold(1e15, f32::min);
        let mut offsets = [[0; 4]; 4];
        for (level, offset) in tree.offsets.iter().enumerate() {
            offsets[level / 4][level % 4] = *offset;
        }
        ScatterLayout {
            table,
            texel_count: tree.counts[0],
            first_source: 0,
            source_count: 0,
            top_level: tree.top_level(),
            theta_squared: theta * theta,
            z_r_squared: z_r * z_r,
            padding: [0; 2],
            offsets,
        }
    }

    /// One uniform per dispatch of all pairs, ready for dynamic offsets; the tree uses the first.
    pub fn uniforms(layout: ScatterLayout) -> Vec<u8> {
        let stride = UNIFORM_STRIDE as usize;
        let dispatches = layout.texel_count.div_ceil(SOURCES_PER_DISPATCH).max(1);
        let mut bytes = vec![0; stride * dispatches as usize];
        for (k, slot) in (0..dispatches).zip(bytes.chunks_mut(stride)) {
            let first_source = k * SOURCES_PER_DISPATCH;
            let source_count = SOURCES_PER_DISPATCH.min(layout.texel_count - first_source);
            let uniform = ScatterLayout { first_source, source_count, ..layout };
            slot[..size_of::<ScatterLayout>()].copy_from_slice(bytemuck::bytes_of(&uniform));
        }
        bytes
    }

    pub fn encode(&self, pass: &mut Pass<'_>, group: &wgpu::BindGroup, method: Method, texels: u32) {
        match method {
            Method::AllPairs => {
                pass.set_pipeline(&self.all_pairs);
                for k in 0..texels.div_ceil(SOURCES_PER_DISPATCH) {
                    pass.set_bind_group(group, &[k * UNIFORM_STRIDE as u32]);
                    pass.dispatch(texels);
                }
            }
            // `dual` and `pattern` have their own; `dual` comes here for a body of a single texel.
            Method::Tree { .. } | Method::Dual { .. } | Method::Pattern => {
                pass.set_pipeline(&self.tree);
                pass.set_bind_group(group, &[0]);
                pass.dispatch(texels);
            }
        }
    }
}
