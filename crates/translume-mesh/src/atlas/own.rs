//! Charts from the file's own texture coordinates, where they are fit for light.

use std::collections::HashMap;

use super::layout::Layout;
use super::raster::Fragments;
use super::texels::neighbours;
use super::{AtlasError, AtlasOptions, AtlasVertex, figures};
use crate::mesh::Mesh;

/// The file's texture coordinates as a layout.
///
/// # Errors
/// [`AtlasError::OwnUvs`] says why they are not fit.
pub(super) fn layout(mesh: &Mesh, options: &AtlasOptions) -> Result<Layout, AtlasError> {
    let unfit = |reason: String| AtlasError::OwnUvs { mesh: mesh.name.clone(), reason };
    if mesh.uvs.len() != mesh.triangles.len() {
        return Err(unfit("it has none".into()));
    }
    if let Some(t) =
        mesh.uvs.iter().position(|corners| !corners.as_flattened().iter().all(|x| (0.0..=1.0).contains(x)))
    {
        return Err(unfit(format!("those of triangle {t} leave [0, 1]: {:?}", mesh.uvs[t])));
    }
    let mut vertices = Vec::new();
    let mut numbers = HashMap::new();
    let mut number = |xref: u32, uv: [f32; 2]| {
        *numbers.entry((xref, uv.map(f32::to_bits))).or_insert_with(|| {
            vertices.push(AtlasVertex { xref, uv });
            vertices.len() as u32 - 1
        })
    };
    let triangles = mesh.triangles.iter().zip(&mesh.uvs);
    let triangles = triangles.map(|(t, uvs)| std::array::from_fn(|k| number(t[k], uvs[k]))).collect();
    let layout =
        Layout { size: options.size, vertices, triangles, gutter: options.padding + 2, chart_count: None };
    fault(&layout).map_or(Ok(layout), |reason| Err(unfit(reason)))
}

/// Why light cannot be kept in a layout.
fn fault(layout: &Layout) -> Option<String> {
    let size = layout.size;
    let corners = layout.corners();
    let (charts, _) = layout.charts();
    let signed = corners.iter().map(super::raster::signed_area);
    let flipped = figures::flipped(&signed.collect::<Vec<_>>(), &charts);
    if flipped > 0 {
        return Some(format!("{flipped} triangles are turned over within their chart"));
    }
    let fragments = Fragments::new(&corners, size);
    let overlaps = (0..(size * size) as usize).filter(|&p| figures::overlaps(fragments.at(p))).count();
    if overlaps > 0 {
        return Some(format!("triangles lie on one another in {overlaps} texels of {size}²"));
    }
    let close = close_charts(&fragments, &charts, size);
    (close > 0).then(|| format!("charts come closer than two texels in {close} texels of {size}²"))
}

/// Texels that have two charts in or around them.
fn close_charts(fragments: &Fragments, charts: &[u32], size: u32) -> usize {
    let own = |pixel: usize| fragments.at(pixel).iter().map(|f| charts[f.triangle as usize]);
    let shared = |&pixel: &usize| {
        let mut near = own(pixel).chain(neighbours(pixel, size).flat_map(own));
        let first = near.next();
        near.any(|chart| Some(chart) != first)
    };
    (0..(size * size) as usize).filter(shared).count()
}
