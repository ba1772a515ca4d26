//! The atlas: charts of the surface laid out in a square texture, and the dense list of texels that carry light.
//!
//! The mesh is rasterised into the atlas once, at rest. Each texel remembers its triangle, its barycentric coordinates and
//! its exact area, so that a deformed texel is three vertex fetches and no raster.

#[cfg(feature = "unwrap")]
mod boundary;
mod figures;
mod gutter;
mod layout;
mod order;
#[cfg(feature = "unwrap")]
mod own;
mod raster;
#[cfg(feature = "unwrap")]
mod relax;
mod texels;
#[cfg(feature = "unwrap")]
mod thin;
#[cfg(feature = "unwrap")]
mod unwrap;

#[cfg(feature = "unwrap")]
pub use crate::progress::Progress;
#[cfg(feature = "unwrap")]
pub use unwrap::{AtlasOptions, ChartSource};

/// A mesh laid out in a square texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Atlas {
    /// Width and height of the texture in texels.
    pub size: u32,
    /// The mesh's vertices, duplicated where a chart ends.
    pub vertices: Vec<AtlasVertex>,
    /// The mesh's triangles in their order and winding, indexing [`vertices`](Self::vertices).
    pub triangles: Vec<[u32; 3]>,
    /// Every texel that light needs, in kd order of the rest pose: any aligned run of 4^l texels is a compact cluster.
    pub texels: Vec<Texel>,
    /// `size`² entries, row by row: which entry of [`texels`](Self::texels) fills this pixel of the texture. Pixels of the gutter
    /// repeat the nearest texel; [`Atlas::EMPTY`] is a pixel that nothing fills.
    pub pixels: Vec<u32>,
    /// Figures of merit.
    pub report: AtlasReport,
}

/// A vertex of the atlas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtlasVertex {
    /// The mesh vertex it is a copy of.
    pub xref: u32,
    /// Texture coordinate in [0, 1]²; (0, 0) is the corner of the pixel in row 0, column 0, and v grows with the row.
    pub uv: [f32; 2],
}

/// A texel that receives light, and gives it where its area is not zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texel {
    /// Column and row in the texture.
    pub pixel: [u16; 2],
    /// The triangle that stands for this texel: the one under its centre, or the nearest of its chart.
    pub triangle: u32,
    /// Weights of the triangle's second and third corner at the texel's centre. They leave [0, 1] where the centre lies beyond the
    /// edge of its chart; bilinear filtering up to that edge is then as accurate as inside. The negative weights never add up to
    /// less than −[`Atlas::MAX_EXTRAPOLATION`]: beyond that (slivers) the point moves towards the triangle.
    pub barycentric: [f32; 2],
    /// Rest area of the surface inside the texel's square, squared model units. Zero on the rim: texels that touch a chart
    /// only through bilinear filtering. The areas of all texels add up to that of the mesh.
    pub area: f32,
}

/// Figures of merit of an atlas.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AtlasReport {
    /// Number of charts.
    pub charts: usize,
    /// Texels with surface in them.
    pub covered_texels: usize,
    /// Surface in texel squares over squares of the texture, 0..1.
    pub utilisation: f64,
    /// Coefficient of variation of surface area per texel-square of UV area, weighted by surface area: 0 is equiareal.
    pub area_cv: f64,
    /// 99th percentile, by surface area, of max(ratio, 1/ratio), where ratio is UV area per surface area over its mean.
    pub area_ratio_p99: f64,
    /// Angle distortion ½(σ₁/σ₂ + σ₂/σ₁) of the map from surface to UV, with its singular values σ: mean over the surface
    /// (Hormann and Greiner 2000). 1 is conformal.
    pub angle_distortion: f64,
    /// Length of all edges where charts were cut apart, model units; the surface's own border does not count.
    pub seam_length: f64,
    /// Triangles wound against the rest of their chart.
    pub flipped: usize,
    /// Texels covered by more than their own square of triangles.
    pub overlapping_texels: usize,
    /// Wall time of the build.
    pub seconds: f64,
}

/// Why an atlas could not be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AtlasError {
    /// The size is zero or above [`Atlas::MAX_SIZE`].
    #[error("atlas size {size} is outside {min}..={max} texels; choose a size in between", min = Atlas::MIN_SIZE, max = Atlas::MAX_SIZE)]
    Size {
        /// The requested size.
        size: u32,
    },
    /// The mesh has no triangle with an area.
    #[error("{mesh}: no triangle has an area, so there is nothing to light; check the file or its scale")]
    Empty {
        /// The mesh's name.
        mesh: String,
    },
    /// The charts do not fit.
    #[error("{mesh}: {charts} charts do not fit one {size}² atlas; use a larger atlas")]
    DoesNotFit {
        /// The mesh's name.
        mesh: String,
        /// Number of charts.
        charts: usize,
        /// The requested size.
        size: u32,
    },
    /// The progress callback returned `false`.
    #[error("{mesh}: unwrapping was cancelled")]
    Cancelled {
        /// The mesh's name.
        mesh: String,
    },
    /// The gutters leave no room for charts.
    #[error(
        "padding of {padding} texels leaves no room in an atlas of {size}²; use less padding or a larger atlas"
    )]
    Padding {
        /// The requested padding.
        padding: u32,
        /// The requested size.
        size: u32,
    },
    /// A thickness that nothing has.
    #[error("texels cannot be finer below a thickness of {below}; give one that is finite and above 0")]
    FinerBelow {
        /// The thickness that was asked for.
        below: f32,
    },
    /// The file's own texture coordinates are not fit for light.
    #[error("{mesh}: its texture coordinates are not fit for light: {reason}; unwrap it instead")]
    OwnUvs {
        /// The mesh's name.
        mesh: String,
        /// What is wrong with them.
        reason: String,
    },
    /// Texture coordinates handed in do not belong to the mesh.
    #[error("{mesh}: {element}: {reason}; unwrap this mesh again")]
    Layout {
        /// The mesh's name.
        mesh: String,
        /// The vertex or triangle, from 0.
        element: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The unwrapper refused the mesh.
    #[error("{mesh}: cannot be unwrapped: {reason}; repair the mesh first")]
    Unwrap {
        /// The mesh's name.
        mesh: String,
        /// What the unwrapper said.
        reason: String,
    },
}

impl Atlas {
    /// Value of [`pixels`](Self::pixels) where nothing is.
    pub const EMPTY: u32 = u32::MAX;
    /// Smallest accepted size.
    pub const MIN_SIZE: u32 = 16;
    /// Largest accepted size: texel coordinates and cluster sums are meant for no more.
    pub const MAX_SIZE: u32 = 8192;
    /// How far barycentric weights of a texel may reach beyond its triangle: bound on the sum of the negative ones.
    pub const MAX_EXTRAPOLATION: f32 = 4.0;
}

impl Texel {
    /// Interpolates a vertex attribute (position, normal, colour) at the texel's centre from its triangle's corners.
    #[must_use]
    pub fn interpolate<const N: usize>(&self, corners: [[f32; N]; 3]) -> [f32; N] {
        let [second, third] = self.barycentric;
        let first = 1.0 - second - third;
        std::array::from_fn(|k| first * corners[0][k] + second * corners[1][k] + third * corners[2][k])
    }
}
