//! Charts and packing by `uvunwrap`.

use uvunwrap::{Density, Error, MeshInput, Options, Stage};

use super::layout::{Layout, check_mesh, check_size, connected_charts};
use super::{Atlas, AtlasError, AtlasVertex};
use crate::mesh::Mesh;
use crate::progress::{Progress, Stopwatch};
use crate::weld::weld;

/// What an atlas shall be like.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AtlasOptions {
    /// Width and height in texels, [`Atlas::MIN_SIZE`] to [`Atlas::MAX_SIZE`].
    pub size: u32,
    /// Empty texels around each chart, so that charts are twice as far apart. Below 2 the rims of neighbouring charts
    /// compete for the same texels, and bilinear filtering may bleed.
    pub padding: u32,
}

impl Default for AtlasOptions {
    fn default() -> Self {
        Self { size: 256, padding: 2 }
    }
}

impl Atlas {
    /// Unwraps a clean mesh into one square texture and rasterises it. Deterministic on one machine: the unwrapper's linear
    /// algebra may differ in the last bits between processor families.
    ///
    /// `progress` may run on worker threads, never twice at once; when it returns `false` the build ends with
    /// [`AtlasError::Cancelled`].
    ///
    /// # Errors
    /// [`AtlasError::Size`] and [`AtlasError::Padding`] for options out of range, [`AtlasError::DoesNotFit`],
    /// [`AtlasError::Empty`], [`AtlasError::Unwrap`] for a mesh that is not clean, [`AtlasError::Cancelled`].
    pub fn build(
        mesh: &Mesh,
        options: &AtlasOptions,
        progress: impl Fn(Progress) -> bool + Sync,
    ) -> Result<Self, AtlasError> {
        check_size(options.size)?;
        if options.padding.saturating_mul(2) >= options.size {
            return Err(AtlasError::Padding { padding: options.padding, size: options.size });
        }
        check_mesh(mesh)?;
        let start = Stopwatch::start();
        let layout = unwrap(mesh, options, &progress)?;
        let mut atlas = layout.assemble(mesh, &|stage| progress(Progress { stage, done: 0, total: None }))?;
        atlas.report.seconds = start.seconds();
        Ok(atlas)
    }
}

fn unwrap(
    mesh: &Mesh,
    options: &AtlasOptions,
    progress: &(impl Fn(Progress) -> bool + Sync),
) -> Result<Layout, AtlasError> {
    let indices = mesh.triangles.as_flattened();
    let unwrapped = uvunwrap::generate_with_progress(
        &[MeshInput::new(&mesh.positions, indices)],
        &Options {
            density: Density::Auto { page_size: options.size },
            padding: options.padding,
            ..Options::default()
        },
        |p| progress(Progress { stage: stage_name(p.stage), done: p.done, total: p.total }),
    )
    .map_err(|error| refusal(mesh, options.size, &error))?;
    if unwrapped.page_count > 1 {
        return Err(AtlasError::DoesNotFit {
            mesh: mesh.name.clone(),
            charts: unwrapped.chart_count as usize,
            size: options.size,
        });
    }
    // The page is cropped to what is used; ours is the whole square.
    let used = [unwrapped.width, unwrapped.height].map(|extent| extent as f32 / options.size as f32);
    let output = &unwrapped.meshes[0];
    Ok(Layout {
        size: options.size,
        vertices: output
            .vertices
            .iter()
            .map(|v| AtlasVertex { xref: v.xref, uv: [v.uv[0] * used[0], v.uv[1] * used[1]] })
            .collect(),
        triangles: output.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        gutter: options.padding + 2,
        charts: Some(unwrapped.chart_count as usize),
    })
}

fn stage_name(stage: Stage) -> &'static str {
    match stage {
        Stage::Segmenting => "segmenting",
        Stage::Parameterizing => "flattening",
        Stage::Packing => "packing",
        _ => "splitting",
    }
}

fn refusal(mesh: &Mesh, size: u32, error: &Error) -> AtlasError {
    let name = mesh.name.clone();
    match error {
        Error::Cancelled => AtlasError::Cancelled { mesh: name },
        Error::ChartTooLarge { .. } | Error::AtlasTooLarge { .. } => {
            // There is at least one chart for each connected piece.
            let welded = weld(&mesh.positions);
            let triangles: Vec<_> = mesh.triangles.iter().map(|t| t.map(|v| welded[v as usize])).collect();
            let charts = connected_charts(mesh.positions.len(), &triangles).1;
            AtlasError::DoesNotFit { mesh: name, charts, size }
        }
        other => AtlasError::Unwrap { mesh: name, reason: other.to_string() },
    }
}
