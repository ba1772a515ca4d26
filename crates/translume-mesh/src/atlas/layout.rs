//! From texture coordinates to an atlas.

use glam::{DVec2, DVec3};

use super::raster::Fragments;
use super::texels::Charted;
use super::{Atlas, AtlasError, AtlasVertex, figures, gutter, order};
use crate::mesh::Mesh;
use crate::progress::Stopwatch;
use crate::weld::weld;

/// How far gutters reach around charts that come from the caller, texels.
const GUTTER: u32 = 4;

/// A mesh laid out in UV space.
pub(super) struct Layout {
    pub size: u32,
    pub vertices: Vec<AtlasVertex>,
    pub triangles: Vec<[u32; 3]>,
    /// How far gutters reach, texels.
    pub gutter: u32,
    /// Number of charts, where the unwrapper says so.
    pub chart_count: Option<usize>,
}

impl Atlas {
    /// Builds an atlas from texture coordinates that the caller already has.
    ///
    /// `triangles` are those of the mesh, in their order and winding, over `vertices`; charts are the connected
    /// pieces. Charts should not overlap and be at least two texels apart; [`AtlasReport`](super::AtlasReport) tells
    /// where they overlap. Gutters of four texels are filled.
    ///
    /// # Errors
    /// [`AtlasError::Size`]; [`AtlasError::Layout`] for a UV outside [0, 1] and for vertices or triangles that are not
    /// those of the mesh; [`AtlasError::Unwrap`] for a mesh that is not clean; [`AtlasError::Empty`].
    pub fn from_uvs(
        mesh: &Mesh,
        size: u32,
        vertices: Vec<AtlasVertex>,
        triangles: Vec<[u32; 3]>,
    ) -> Result<Self, AtlasError> {
        check_size(size)?;
        check_mesh(mesh)?;
        let start = Stopwatch::start();
        let mut atlas = Layout { size, vertices, triangles, gutter: GUTTER, chart_count: None }
            .assemble(mesh, &|_| true)?;
        atlas.report.seconds = start.seconds();
        Ok(atlas)
    }
}

impl Layout {
    /// Rasterises, orders and measures. `proceed` hears of each stage and may end the work by returning `false`.
    pub fn assemble(self, mesh: &Mesh, proceed: &dyn Fn(&'static str) -> bool) -> Result<Atlas, AtlasError> {
        self.check(mesh)?;
        let stage = |name| {
            proceed(name).then_some(()).ok_or_else(|| AtlasError::Cancelled { mesh: mesh.name.clone() })
        };
        let corners = self.corners();
        let areas: Vec<f64> = (0..mesh.triangles.len()).map(|t| area(mesh, t)).collect();
        if areas.iter().sum::<f64>() <= 0.0 {
            return Err(AtlasError::Empty { mesh: mesh.name.clone() });
        }
        let (charts, connected) = self.charts();

        stage("rasterising")?;
        let fragments = Fragments::new(&corners, self.size);
        let charted = Charted { size: self.size, corners: &corners, areas: &areas, charts: &charts };
        let unordered = charted.texels(&fragments);

        stage("ordering")?;
        let rest: Vec<[f32; 3]> =
            unordered.iter().map(|t| t.interpolate(mesh.corners(t.triangle as usize))).collect();
        let texels: Vec<_> = order::kd_order(&rest).into_iter().map(|k| unordered[k as usize]).collect();
        let pixels = gutter::fill(&texels, self.size, self.gutter);

        let mut report = figures::measure(mesh, &charted, &fragments);
        report.charts = self.chart_count.unwrap_or(connected);
        Ok(Atlas {
            size: self.size,
            vertices: self.vertices,
            triangles: self.triangles,
            texels,
            pixels,
            report,
        })
    }

    /// Corners of the triangles, texel units.
    pub fn corners(&self) -> Vec<[DVec2; 3]> {
        let scale = f64::from(self.size);
        let uv = |v: u32| DVec2::from(self.vertices[v as usize].uv.map(f64::from)) * scale;
        self.triangles.iter().map(|t| t.map(uv)).collect()
    }

    /// The chart of each triangle, and how many there are. Triangles that meet at a point of the texture are of one chart.
    pub fn charts(&self) -> (Vec<u32>, usize) {
        let places: Vec<_> = self.vertices.iter().map(|v| [v.uv[0], v.uv[1], 0.0]).collect();
        let welded = weld(&places);
        let triangles: Vec<_> = self.triangles.iter().map(|t| t.map(|v| welded[v as usize])).collect();
        connected_charts(self.vertices.len(), &triangles)
    }

    fn check(&self, mesh: &Mesh) -> Result<(), AtlasError> {
        let wrong = |element: String, reason: String| {
            Err(AtlasError::Layout { mesh: mesh.name.clone(), element, reason })
        };
        if self.triangles.len() != mesh.triangles.len() {
            let [atlas, own] = [self.triangles.len(), mesh.triangles.len()];
            return wrong("triangles".into(), format!("there are {atlas}, but the mesh has {own}"));
        }
        for (v, vertex) in self.vertices.iter().enumerate() {
            if !vertex.uv.iter().all(|x| (0.0..=1.0).contains(x)) {
                return wrong(
                    format!("atlas vertex {v}"),
                    format!("its UV {:?} is outside [0, 1]", vertex.uv),
                );
            }
        }
        for (t, (corners, own)) in self.triangles.iter().zip(&mesh.triangles).enumerate() {
            let xref = corners.map(|v| self.vertices.get(v as usize).map(|vertex| vertex.xref));
            if xref != own.map(Some) {
                let reason = format!("its corners are copies of {xref:?}, but the mesh has {own:?}");
                return wrong(format!("triangle {t}"), reason);
            }
        }
        Ok(())
    }
}

pub(super) fn check_size(size: u32) -> Result<(), AtlasError> {
    if (Atlas::MIN_SIZE..=Atlas::MAX_SIZE).contains(&size) { Ok(()) } else { Err(AtlasError::Size { size }) }
}

/// The parts of cleanliness that everything after relies on.
pub(super) fn check_mesh(mesh: &Mesh) -> Result<(), AtlasError> {
    if mesh.triangles.is_empty() {
        return Err(AtlasError::Empty { mesh: mesh.name.clone() });
    }
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        for &v in triangle {
            let position = mesh.positions.get(v as usize);
            if !position.is_some_and(|p| p.iter().all(|x| x.is_finite())) {
                return Err(AtlasError::Unwrap {
                    mesh: mesh.name.clone(),
                    reason: format!("triangle {t} uses vertex {v}, which is {position:?}"),
                });
            }
        }
    }
    Ok(())
}

/// Rest area of a triangle, squared model units.
pub(super) fn area(mesh: &Mesh, triangle: usize) -> f64 {
    let [a, b, c] = mesh.corners(triangle).map(|p| DVec3::from(p.map(f64::from)));
    (b - a).cross(c - a).length() / 2.0
}

/// The connected piece of each triangle, named by one of its vertices, and the number of pieces (union-find with path
/// halving, Tarjan and van Leeuwen 1984).
pub(super) fn connected_charts(vertices: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, usize) {
    fn root(parents: &mut [u32], mut v: u32) -> u32 {
        while parents[v as usize] != v {
            parents[v as usize] = parents[parents[v as usize] as usize];
            v = parents[v as usize];
        }
        v
    }
    let mut parents: Vec<u32> = (0..vertices as u32).collect();
    for &[a, b, c] in triangles {
        for other in [b, c] {
            let [x, y] = [a, other].map(|v| root(&mut parents, v));
            parents[x.max(y) as usize] = x.min(y);
        }
    }
    let charts: Vec<u32> = triangles.iter().map(|t| root(&mut parents, t[0])).collect();
    let mut names = charts.clone();
    names.sort_unstable();
    names.dedup();
    (charts, names.len())
}
