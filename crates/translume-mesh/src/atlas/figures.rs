//! Figures of merit of a layout.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::AtlasReport;
use super::raster::{Fragment, Fragments, signed_area};
use super::texels::Charted;
use crate::mesh::Mesh;
use crate::weld::weld;

/// Share of a texel by which overlaps may exceed it through rounding of UVs to f32.
const OVERLAP_TOLERANCE: f64 = 1e-4;

/// Measures a layout; `charts` and `seconds` are the caller's.
pub(super) fn measure(mesh: &Mesh, charted: &Charted<'_>, fragments: &Fragments) -> AtlasReport {
    let Charted { size, corners, areas, charts } = *charted;
    let signed: Vec<f64> = corners.iter().map(signed_area).collect();
    let uv_areas: Vec<f64> = signed.iter().map(|a| a.abs()).collect();
    let mut report = AtlasReport {
        flipped: flipped(&signed, charts),
        area_cv: area_cv(&uv_areas, areas),
        area_ratio_p99: area_ratio_p99(&uv_areas, areas),
        angle_distortion: angle_distortion(mesh, corners, &uv_areas, areas),
        seam_length: seam_length(mesh, corners),
        ..AtlasReport::default()
    };
    let mut covered = 0.0;
    for pixel in 0..(size * size) as usize {
        let found = fragments.at(pixel);
        report.covered_texels += usize::from(!found.is_empty());
        report.overlapping_texels += usize::from(overlaps(found));
        covered += overlap(found).min(1.0);
    }
    report.utilisation = covered / f64::from(size).powi(2);
    report
}

fn overlap(found: &[Fragment]) -> f64 {
    found.iter().map(|f| f64::from(f.overlap)).sum()
}

/// Whether more lies in a texel than fits.
pub(super) fn overlaps(found: &[Fragment]) -> bool {
    overlap(found) > 1.0 + OVERLAP_TOLERANCE
}

/// Triangles wound against the rest of their chart. A chart may be mirrored as a whole.
pub(super) fn flipped(signed: &[f64], charts: &[u32]) -> usize {
    let mut totals: HashMap<u32, f64> = HashMap::new();
    signed.iter().zip(charts).for_each(|(area, chart)| *totals.entry(*chart).or_default() += area);
    signed.iter().zip(charts).filter(|(area, chart)| **area * totals[*chart] < 0.0).count()
}

fn angle_distortion(mesh: &Mesh, corners: &[[DVec2; 3]], uv_areas: &[f64], areas: &[f64]) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    for (t, uv) in corners.iter().enumerate().filter(|(t, _)| uv_areas[*t] > 0.0 && areas[*t] > 0.0) {
        let p = mesh.corners(t).map(|p| DVec3::from(p.map(f64::from)));
        // Dirichlet energy by cotangents (Pinkall and Polthier 1993), over the UV area.
        let energy = (0..3).map(|k| {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            let cotangent = (p[a] - p[k]).dot(p[b] - p[k]) / (2.0 * areas[t]);
            0.25 * cotangent * uv[a].distance_squared(uv[b])
        });
        sum += areas[t] * energy.sum::<f64>() / uv_areas[t];
        total += areas[t];
    }
    if total > 0.0 { sum / total } else { 1.0 }
}

fn seam_length(mesh: &Mesh, corners: &[[DVec2; 3]]) -> f64 {
    let welded = weld(&mesh.positions);
    // Where the first triangle of each edge has it in UV; `None` once it is known to be cut.
    let mut edges: HashMap<[u32; 2], Option<[DVec2; 2]>> = HashMap::with_capacity(corners.len() * 2);
    let mut length = 0.0;
    for (triangle, uv) in mesh.triangles.iter().zip(corners) {
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            let (mut ends, mut place) =
                ([triangle[a], triangle[b]].map(|v| welded[v as usize]), [uv[a], uv[b]]);
            if ends[0] > ends[1] {
                (ends, place) = ([ends[1], ends[0]], [place[1], place[0]]);
            }
            let first = edges.entry(ends).or_insert(Some(place));
            if first.is_some_and(|first| first != place) {
                *first = None;
                let [p, q] = ends.map(|v| DVec3::from(mesh.positions[v as usize].map(f64::from)));
                length += p.distance(q);
            }
        }
    }
    length
}

/// Standard deviation over mean of surface per UV area, weighted by surface. Triangles without UV area are left out.
fn area_cv(uv_areas: &[f64], areas: &[f64]) -> f64 {
    let spread = || uv_areas.iter().zip(areas).filter(|(uv, _)| **uv > 0.0);
    let moment = |power: i32| spread().map(|(uv, area)| area * (area / uv).powi(power)).sum::<f64>();
    let total = moment(0);
    let mean = moment(1) / total;
    let variance = spread().map(|(uv, area)| area * (area / uv - mean).powi(2)).sum::<f64>() / total;
    if mean > 0.0 { variance.sqrt() / mean } else { 0.0 }
}

fn area_ratio_p99(uv_areas: &[f64], areas: &[f64]) -> f64 {
    let total: f64 = areas.iter().sum();
    let mean = uv_areas.iter().sum::<f64>() / total;
    let mut ratios: Vec<(f64, f64)> = uv_areas
        .iter()
        .zip(areas)
        .filter(|(_, area)| **area > 0.0)
        .map(|(uv, area)| {
            let ratio = uv / area / mean;
            (ratio.max(1.0 / ratio), *area)
        })
        .collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut below = 0.0;
    ratios
        .into_iter()
        .find(|(_, area)| {
            below += area;
            below >= 0.99 * total
        })
        .map_or(1.0, |(ratio, _)| ratio)
}
