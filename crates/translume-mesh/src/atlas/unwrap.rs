//! Charts and packing by `uvunwrap`.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Mutex, PoisonError};

use glam::DVec2;
use rayon::prelude::*;
use uvunwrap::{Density, Error, MeshInput, Options, Packing, Stage};

use super::layout::{Layout, area, check_mesh, check_size, connected_charts};
use super::raster::signed_area;
use super::relax::Chart;
use super::{Atlas, AtlasError, AtlasVertex, own, thin};
use crate::mesh::Mesh;
use crate::progress::{Progress, Stopwatch};
use crate::weld::weld;

/// Width of the page on which charts lie while they are evened out, texels. Any will do.
const DRAFT_PAGE: u32 = 1024;

/// What an atlas shall be like.
#[derive(Clone, Debug, PartialEq)]
pub struct AtlasOptions {
    /// Width and height in texels, [`Atlas::MIN_SIZE`] to [`Atlas::MAX_SIZE`].
    pub size: u32,
    /// Empty texels around each chart, so that charts are twice as far apart. Below 2 the rims of neighbouring charts
    /// compete for the same texels, and bilinear filtering may bleed.
    pub padding: u32,
    /// Where charts come from.
    pub charts: ChartSource,
    /// Whether unwrapped charts are relaxed until every texel holds about the same area of the surface. Off by default: a body
    /// measures the area of every texel, and its error is the same either way (docs/accuracy.md). For schemes that take
    /// texels to be equal.
    pub equiareal: bool,
    /// Thickness below which unwrapped charts are given finer texels, in units of the mesh, above 0: light that crosses a thin part
    /// shows what it is like, so six mean free paths serve. A texel's area goes with the thickness, down to a sixth. `None`, as if nothing
    /// is said, gives all the same. It is the mesh at rest that is measured.
    pub finer_below: Option<f32>,
}

/// Where charts come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ChartSource {
    /// The surface is cut and flattened anew: even texels, short seams.
    #[default]
    Unwrap,
    /// The file's own texture coordinates, where they are fit for light: inside [0, 1]², no two triangles on one place, no
    /// triangle turned over within its chart, two empty texels between charts.
    Own,
    /// The file's own texture coordinates where they are fit, else unwrapped.
    OwnOrUnwrap,
}

impl Default for AtlasOptions {
    fn default() -> Self {
        Self { size: 256, padding: 2, charts: ChartSource::Unwrap, equiareal: false, finer_below: None }
    }
}

impl Atlas {
    /// Lays a clean mesh out in one square texture and rasterises it. Deterministic on one machine: the unwrapper's linear
    /// algebra may differ in the last bits between processor families.
    ///
    /// `progress` may run on worker threads, never twice at once; when it returns `false` the build ends with
    /// [`AtlasError::Cancelled`].
    ///
    /// # Errors
    /// [`AtlasError::Size`], [`AtlasError::Padding`] and [`AtlasError::FinerBelow`] for options out of range, [`AtlasError::DoesNotFit`],
    /// [`AtlasError::OwnUvs`] where the file's texture coordinates are asked for and not fit, [`AtlasError::Empty`],
    /// [`AtlasError::Unwrap`] for a mesh that is not clean, [`AtlasError::Cancelled`].
    pub fn build(
        mesh: &Mesh,
        options: &AtlasOptions,
        progress: impl Fn(Progress) -> bool + Sync,
    ) -> Result<Self, AtlasError> {
        check_size(options.size)?;
        if options.padding.saturating_mul(2) >= options.size {
            return Err(AtlasError::Padding { padding: options.padding, size: options.size });
        }
        if let Some(below) = options.finer_below.filter(|below| !(*below > 0.0 && below.is_finite())) {
            return Err(AtlasError::FinerBelow { below });
        }
        check_mesh(mesh)?;
        let start = Stopwatch::start();
        let layout = match options.charts {
            ChartSource::Unwrap => unwrap(mesh, options, &progress)?,
            ChartSource::Own => own::layout(mesh, options)?,
            ChartSource::OwnOrUnwrap => match own::layout(mesh, options) {
                Ok(layout) => layout,
                Err(AtlasError::OwnUvs { .. }) => unwrap(mesh, options, &progress)?,
                Err(other) => return Err(other),
            },
        };
        let mut atlas = layout.assemble(mesh, &|stage| progress(Progress { stage, done: 0, total: None }))?;
        atlas.report.seconds = start.seconds();
        Ok(atlas)
    }
}

/// Charts by `uvunwrap`, evened out where the options say so, and packed.
fn unwrap(
    mesh: &Mesh,
    options: &AtlasOptions,
    progress: &(impl Fn(Progress) -> bool + Sync),
) -> Result<Layout, AtlasError> {
    if !options.equiareal && options.finer_below.is_none() {
        let whole = MeshInput::new(&mesh.positions, mesh.triangles.as_flattened());
        return pack(mesh, &[whole], options, |p| progress(told(p, stage_name(p.stage))));
    }
    let draft = Draft::new(mesh, options, progress)?;
    let areas = draft.wanted(mesh, options);
    let uvs = draft.evened_out(mesh, &areas, progress)?;
    let positions: Vec<_> = draft.xrefs.iter().map(|&v| mesh.positions[v as usize]).collect();
    // The packer gives a mesh as many texels as its scale says.
    let parts = draft.parts(mesh, &areas);
    let charts: Vec<MeshInput<'_>> = parts
        .iter()
        .map(|part| MeshInput {
            existing_uvs: Some(&uvs),
            scale: part.scale,
            ..MeshInput::new(&positions, part.corners.as_flattened())
        })
        .collect();
    let mut layout = pack(mesh, &charts, options, |p| match p.stage {
        Stage::Segmenting | Stage::Parameterizing => progress(in_between()),
        _ => progress(told(p, stage_name(p.stage))),
    })?;
    layout.vertices.iter_mut().for_each(|v| v.xref = draft.xrefs[v.xref as usize]);
    let order = parts.iter().flat_map(|part| &part.triangles);
    let mut triangles = layout.triangles.clone();
    order.zip(&layout.triangles).for_each(|(&t, corners)| triangles[t as usize] = *corners);
    layout.triangles = triangles;
    Ok(layout)
}

/// Packs charts into one page, cutting and flattening first where there are none yet. Triangles are those of one part after the other.
fn pack(
    mesh: &Mesh,
    parts: &[MeshInput<'_>],
    options: &AtlasOptions,
    progress: impl Fn(uvunwrap::Progress) -> bool + Sync,
) -> Result<Layout, AtlasError> {
    let packing = Options {
        density: Density::Auto { page_size: options.size },
        padding: options.padding,
        ..Options::default()
    };
    let unwrapped = uvunwrap::generate_with_progress(parts, &packing, progress)
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
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for part in &unwrapped.meshes {
        let first = vertices.len() as u32;
        triangles.extend(part.indices.as_chunks().0.iter().map(|t: &[u32; 3]| t.map(|v| first + v)));
        let placed = |v: &uvunwrap::OutputVertex| AtlasVertex {
            xref: v.xref,
            uv: [v.uv[0] * used[0], v.uv[1] * used[1]],
        };
        vertices.extend(part.vertices.iter().map(placed));
    }
    Ok(Layout {
        size: options.size,
        vertices,
        triangles,
        gutter: options.padding + 2,
        chart_count: Some(unwrapped.chart_count as usize),
    })
}

/// Charts that are flat and not yet where they will stay.
struct Draft {
    /// Mesh vertex of each point.
    xrefs: Vec<u32>,
    points: Vec<DVec2>,
    /// For every point the first at the same place: copies within a chart have to stay together.
    welded: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

impl Draft {
    fn new(
        mesh: &Mesh,
        options: &AtlasOptions,
        progress: &(impl Fn(Progress) -> bool + Sync),
    ) -> Result<Self, AtlasError> {
        let flat = uvunwrap::generate_with_progress(
            &[MeshInput::new(&mesh.positions, mesh.triangles.as_flattened())],
            &Options {
                density: Density::Auto { page_size: DRAFT_PAGE },
                packing: Packing::Fast,
                ..Options::default()
            },
            |p| match p.stage {
                Stage::Segmenting | Stage::Parameterizing => progress(told(p, stage_name(p.stage))),
                _ => progress(in_between()),
            },
        )
        .map_err(|error| refusal(mesh, options.size, &error))?;
        let page = DVec2::new(flat.width.into(), flat.height.into());
        let output = &flat.meshes[0];
        // Pages side by side.
        let shift = |page: Option<u32>| DVec2::new(f64::from(page.unwrap_or(0)), 0.0);
        let place = |v: &uvunwrap::OutputVertex| (DVec2::from(v.uv.map(f64::from)) + shift(v.page)) * page;
        let key = |v: &uvunwrap::OutputVertex| [v.uv[0], v.uv[1], v.page.unwrap_or(0) as f32];
        Ok(Self {
            xrefs: output.vertices.iter().map(|v| v.xref).collect(),
            points: output.vertices.iter().map(place).collect(),
            welded: weld(&output.vertices.iter().map(key).collect::<Vec<_>>()),
            triangles: output.indices.as_chunks().0.to_vec(),
        })
    }

    /// How much of the texture each triangle shall have, in any unit.
    fn wanted(&self, mesh: &Mesh, options: &AtlasOptions) -> Vec<f64> {
        let areas = (0..mesh.triangles.len()).map(|t| area(mesh, t));
        match options.finer_below {
            Some(below) => {
                areas.zip(thin::weights(mesh, below)).map(|(area, weight)| weight * area).collect()
            }
            None => areas.collect(),
        }
    }

    /// Where each point goes once charts hold that.
    fn evened_out(
        &self,
        mesh: &Mesh,
        areas: &[f64],
        progress: &(impl Fn(Progress) -> bool + Sync),
    ) -> Result<Vec<[f32; 2]>, AtlasError> {
        let mut charts = self.charts(areas);
        // The largest first, so that no thread is left alone with it.
        charts.sort_by_key(|(_, chart)| std::cmp::Reverse(chart.triangles.len()));
        let total = Some(charts.len());
        let done = Mutex::new(0);
        charts.par_iter_mut().try_for_each(|(_, chart)| {
            chart.relax();
            let mut done = done.lock().unwrap_or_else(PoisonError::into_inner);
            *done += 1;
            let go_on = progress(Progress { stage: "evening out", done: *done, total });
            go_on.then_some(()).ok_or_else(|| AtlasError::Cancelled { mesh: mesh.name.clone() })
        })?;
        let mut moved = self.points.clone();
        for (ids, chart) in &charts {
            for (&id, &point) in ids.iter().zip(&chart.points) {
                moved[id as usize] = point;
            }
        }
        Ok(self.welded.iter().map(|&v| moved[v as usize].as_vec2().into()).collect())
    }

    /// The charts, each with the numbers of its points; triangles without an area in UV or in space belong to none.
    fn charts(&self, areas: &[f64]) -> Vec<(Vec<u32>, Chart)> {
        let (triangles, names) = self.named();
        let mut charts: Vec<(Vec<u32>, Chart)> = Vec::new();
        let mut numbers = HashMap::new();
        let mut places = vec![u32::MAX; self.points.len()];
        for (t, triangle) in triangles.iter().enumerate() {
            let surface = areas[t];
            if signed_area(&triangle.map(|v| self.points[v as usize])) <= 0.0 || surface <= 0.0 {
                continue;
            }
            let number = *numbers.entry(names[t]).or_insert(charts.len());
            if number == charts.len() {
                charts.push(Default::default());
            }
            let (ids, chart) = &mut charts[number];
            chart.triangles.push(triangle.map(|v| {
                let place = &mut places[v as usize];
                if *place == u32::MAX {
                    *place = ids.len() as u32;
                    ids.push(v);
                    chart.points.push(self.points[v as usize]);
                }
                *place
            }));
            chart.areas.push(surface);
        }
        charts
    }

    /// Triangles over points of which there is one at each place, and the name of the chart of each.
    fn named(&self) -> (Vec<[u32; 3]>, Vec<u32>) {
        let triangles: Vec<_> = self.triangles.iter().map(|t| t.map(|v| self.welded[v as usize])).collect();
        let names = connected_charts(self.points.len(), &triangles).0;
        (triangles, names)
    }

    /// What is packed at one scale: charts whose triangles want as much for their surface, within a few per cent.
    fn parts(&self, mesh: &Mesh, areas: &[f64]) -> Vec<Part> {
        const STEPS: f64 = 16.0;
        let names = self.named().1;
        let mut sums: HashMap<u32, [f64; 2]> = HashMap::new();
        for (t, name) in names.iter().enumerate() {
            let [wanted, surface] = sums.entry(*name).or_default();
            *wanted += areas[t];
            *surface += area(mesh, t);
        }
        let mut parts: BTreeMap<i32, Part> = BTreeMap::new();
        for (t, name) in names.iter().enumerate() {
            let [wanted, surface] = sums[name];
            let step = if surface > 0.0 { (STEPS * (wanted / surface).log2()).round() } else { 0.0 };
            let part = parts.entry(step as i32).or_insert_with(|| Part {
                scale: (0.5 * step / STEPS).exp2() as f32,
                triangles: Vec::new(),
                corners: Vec::new(),
            });
            part.triangles.push(t as u32);
            part.corners.push(self.triangles[t]);
        }
        parts.into_values().collect()
    }
}

/// Charts that are packed at one scale.
struct Part {
    scale: f32,
    /// Of the mesh.
    triangles: Vec<u32>,
    /// Points of each.
    corners: Vec<[u32; 3]>,
}

fn told(p: uvunwrap::Progress, stage: &'static str) -> Progress {
    Progress { stage, done: p.done, total: p.total }
}

/// Chores before and after charts are evened out.
fn in_between() -> Progress {
    Progress { stage: "evening out", done: 0, total: None }
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
