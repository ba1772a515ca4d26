//! Scatter: irradiance → radiant exitance per texel, B_i = Σ_j E_j·A_j·K̄(|p_i − p_j|, s_j).
//!
//! reads  bounds and lamps of the tree, kernel table      writes  exitance per texel, linear RGB
//! twin   `translume_reference::scatter`                  WGSL    `scatter.wgsl`

pub(crate) mod dual;
pub(crate) mod pattern;
pub(crate) mod points;

use crate::Error;
use crate::buffers::Buffers;
use crate::gpu::{
    self, FLOAT_TEXTURE, MediumKind, Pass, PerMedium, READ, UNIFORM_ARRAY, UNIFORM_STRIDE, WRITE,
};
use crate::kernel_table::KernelTableLayout;
use crate::layout::{ScatterLayout, TermLayout};
use crate::stages::cluster::Tree;
use std::sync::OnceLock;

/// How the sum over sources is evaluated.
///
/// ```
/// use translume::Method;
///
/// // Half a percent of the mean.
/// let method = Method::Within { tolerance: 0.005 };
/// assert!(matches!(method.resolved(), Method::Dual { theta } if theta < 0.65));
/// ```
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
    /// source as soon as its radius and 1.9 times that of the receivers, their squares added, are below `theta`·√(distance² + z_r²); or
    /// for a single texel as soon as the source's radius is below 0.6 of that.
    Dual {
        /// Opening angle, 0.05..=2. The error falls with its fourth to fifth power; [`Within`](Self::Within) 1 % is 0.65.
        theta: f32,
    },
    /// Dual, at the opening angle that keeps the error within a target.
    Within {
        /// Root mean square error of exitance over its mean, 0.0001..=0.1.
        tolerance: f32,
    },
    /// For comparison, the way of Gong et al. 2008: 49 samples in a square of the atlas around the texel and eight far ones around that,
    /// whatever lies there. Each stands for the area of its part of the pattern as if all texels had the same area, that of the
    /// rest pose before the model matrix. What is near on the surface but elsewhere in the atlas is lost, and so is light
    /// through thin parts: it is tens of percent off.
    Pattern,
}

impl Default for Method {
    /// Within 1 %.
    fn default() -> Self {
        Self::Within { tolerance: 0.01 }
    }
}

impl Method {
    /// The same with an opening angle in place of a tolerance.
    #[must_use]
    pub fn resolved(self) -> Self {
        match self {
            Self::Within { tolerance } => Self::Dual { theta: opening_angle(tolerance) },
            other => other,
        }
    }

    /// Checks the opening angle or the tolerance.
    pub(crate) fn validate(self) -> Result<(), Error> {
        match self {
            Self::Within { tolerance } if !(0.0001..=0.1).contains(&tolerance) => Err(Error::Frame {
                problem: format!("tolerance {tolerance}"),
                remedy: "give a relative error between 0.0001 and 0.1, or use all pairs",
            }),
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

/// The error falls with the 4.5th power of θ; at 0.65 it is 0.7 % in the worst of the bodies, media and atlases measured (test
/// `a_tolerance_is_kept`, docs/accuracy.md).
fn opening_angle(tolerance: f32) -> f32 {
    0.65 * (tolerance / 0.01).powf(0.23)
}

/// Sources of one dispatch of all pairs: short enough for a driver's watchdog, and far below the 65,535 loop iterations after
/// which some software rasterisers silently stop an invocation.
pub(crate) const SOURCES_PER_DISPATCH: u32 = 8192;

pub(crate) struct Scatter {
    layout: wgpu::BindGroupLayout,
    all_pairs: PerMedium,
    tree: PerMedium,
    pub dual: dual::Dual,
    pub pattern: OnceLock<pattern::Pattern>,
}

impl Scatter {
    pub fn new(device: &wgpu::Device) -> Self {
        let types = [UNIFORM_ARRAY, READ, READ, WRITE, FLOAT_TEXTURE];
        let layout = gpu::layout(device, "scatter", wgpu::ShaderStages::COMPUTE, &types);
        let shaders = [translume_shaders::SCATTER, translume_shaders::SCATTER_ORIENTED];
        let pipelines = gpu::pipeline_layout(device, "scatter", &[&layout]);
        Self {
            all_pairs: PerMedium::new(device, &pipelines, shaders, "all_pairs"),
            tree: PerMedium::new(device, &pipelines, shaders, "tree"),
            dual: dual::Dual::new(device),
            pattern: OnceLock::new(),
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
            buffers.bounds.as_entire_binding(),
            buffers.lamps.as_entire_binding(),
            buffers.exitance.as_entire_binding(),
            wgpu::BindingResource::TextureView(kernel_table),
        ];
        gpu::bind(device, "scatter", &self.layout, &resources)
    }

    /// What the shader needs to know of a body of this medium.
    pub fn layout(
        table: KernelTableLayout,
        smooth_length: f32,
        terms: [TermLayout; 2],
        tree: &Tree,
        method: Method,
    ) -> ScatterLayout {
        let theta = match method.resolved() {
            Method::Tree { theta } | Method::Dual { theta } => theta,
            _ => 0.0,
        };
        ScatterLayout {
            table,
            texel_count: tree.counts[0],
            first_source: 0,
            source_count: 0,
            top_level: tree.top_level(),
            theta_squared: theta * theta,
            z_r_squared: smooth_length * smooth_length,
            padding: [0; 2],
            sources: Tree::packed(&tree.source_offsets),
            terms,
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

    /// Makes the pipeline of a method that walks alone, so that no frame has to.
    pub fn compile(&self, method: Method, kind: MediumKind) {
        match method {
            Method::AllPairs => _ = self.all_pairs.get(kind),
            Method::Tree { .. } => _ = self.tree.get(kind),
            // These have their own.
            Method::Dual { .. } | Method::Within { .. } | Method::Pattern => (),
        }
    }

    pub fn encode(
        &self,
        pass: &mut Pass<'_>,
        group: &wgpu::BindGroup,
        (method, kind): (Method, MediumKind),
        texels: u32,
    ) {
        match method {
            Method::AllPairs => {
                pass.set_pipeline(self.all_pairs.get(kind));
                for k in 0..texels.div_ceil(SOURCES_PER_DISPATCH) {
                    pass.set_bind_group(group, &[k * UNIFORM_STRIDE as u32]);
                    pass.dispatch(texels);
                }
            }
            // `dual` and `pattern` have their own.
            _ => {
                pass.set_pipeline(self.tree.get(kind));
                pass.set_bind_group(group, &[0]);
                pass.dispatch(texels);
            }
        }
    }
}
